// SPDX-License-Identifier: MIT
// Reader of VTK's legacy polydata (.vtk), text and binary, of versions up to 5.1.
#include "formats/surface/surface_plain.hpp"
#include "formats/surface/surface_text.hpp"
#include "formats/surface/vtk_numbers.hpp"

#include <algorithm>

namespace palpate {
namespace {

using detail::same_word;

class LegacyReader {
public:
  LegacyReader(std::string_view bytes, const std::filesystem::path& file) : bytes_(bytes), file_(file) {}

  PolygonSoup read() {
    if (!line().starts_with("# vtk DataFile Version")) fail("not a VTK file: no '# vtk DataFile Version' line");
    soup_.frame = stated_frame(line());
    const std::string_view form = word();
    if (!same_word(form, "ASCII") && !same_word(form, "BINARY")) fail("neither ASCII nor BINARY");
    text_ = same_word(form, "ASCII");
    if (!same_word(word(), "DATASET")) fail("expected 'DATASET POLYDATA'");
    if (const auto kind = word(); !same_word(kind, "POLYDATA")) {
      fail("the dataset is " + std::string(kind.substr(0, 32)) + "; allowed: POLYDATA");
    }
    for (auto key = word(); !key.empty(); key = word()) {
      if (same_word(key, "POINTS")) {
        points();
      } else if (same_word(key, "POLYGONS") || same_word(key, "TRIANGLE_STRIPS")) {
        cells(same_word(key, "TRIANGLE_STRIPS"), true);
      } else if (same_word(key, "VERTICES") || same_word(key, "LINES")) {
        cells(false, false);
      } else if (same_word(key, "METADATA")) {
        line();
        while (at_ < bytes_.size() && line().find_first_not_of(" \r") != std::string_view::npos) continue;
      } else if (same_word(key, "FIELD")) {
        field();
      } else if (same_word(key, "CELL_DATA") || same_word(key, "POINT_DATA")) {
        break;
      } else {
        fail("unknown keyword '" + std::string(key.substr(0, 32)) + "'");
      }
    }
    finish();
    return std::move(soup_);
  }

private:
  [[noreturn]] void fail(const std::string& cause) const {
    const auto lines = std::count(bytes_.begin(), bytes_.begin() + std::ptrdiff_t(std::min(at_, bytes_.size())), '\n');
    throw Error(ExitCode::bad_input, file_.string() + (text_ ? ":" + std::to_string(lines + 1) : "") + ": " + cause);
  }

  std::string_view line() {
    const auto end = std::min(bytes_.find('\n', at_), bytes_.size());
    const auto found = bytes_.substr(at_, end - at_);
    at_ = std::min(end + 1, bytes_.size());
    return found;
  }

  std::string_view word() {
    at_ = std::min(bytes_.find_first_not_of(" \t\r\n", at_), bytes_.size());
    const auto end = std::min(bytes_.find_first_of(" \t\r\n", at_), bytes_.size());
    const auto found = bytes_.substr(at_, end - at_);
    at_ = end;
    return found;
  }

  std::size_t count(const char* what) {
    const auto token = word();
    std::uint64_t value = 0;
    const auto [end, code] = std::from_chars(token.data(), token.data() + token.size(), value);
    if (token.empty() || code != std::errc() || end != token.data() + token.size() || value > 0x7fffffff) {
      fail(std::string(what) + ": '" + std::string(token.substr(0, 32)) + "' is not a number from 0 to 2147483647");
    }
    return std::size_t(value);
  }

  std::vector<double> numbers(std::size_t total, std::string_view type, const char* what) {
    const auto kind = detail::vtk_type(type);
    if (!kind) fail(std::string(what) + ": unknown type '" + std::string(type.substr(0, 32)) + "'");
    std::vector<double> values;
    if (text_) {
      for (std::size_t k = 0; k < total; ++k) {
        const auto token = word();
        double value = 0;
        const auto [end, code] = std::from_chars(token.data(), token.data() + token.size(), value);
        if (token.empty()) fail(std::string("truncated in ") + what);
        if (end != token.data() + token.size() || code == std::errc::invalid_argument) {
          fail(std::string(what) + ": '" + std::string(token.substr(0, 32)) + "' is not a number");
        }
        if (same_word(what, "POINTS")) detail::count_decimals(soup_, token);
        values.push_back(value);
      }
      return values;
    }
    line();  // the rest of the keyword's line
    if (bytes_.size() - at_ < total * kind->size) fail(std::string("truncated in ") + what);
    values = detail::vtk_numbers(bytes_.substr(at_, total * kind->size), *kind, true);
    at_ += total * kind->size;
    return values;
  }

  void points() {
    const std::size_t n = count("POINTS");
    const std::string type(word());
    const auto values = numbers(3 * n, type, "POINTS");
    soup_.single = !text_ && type == "float";
    for (std::size_t k = 0; k < n; ++k)
      soup_.vertices.emplace_back(values[3 * k], values[3 * k + 1], values[3 * k + 2]);
  }

  void cells(bool strips, bool kept) {
    const std::size_t first = count("cells"), second = count("cells");
    const std::size_t before = at_;
    std::vector<double> offsets, connectivity;
    if (same_word(word(), "OFFSETS")) {
      offsets = numbers(first, std::string(word()), "OFFSETS");
      if (!same_word(word(), "CONNECTIVITY")) fail("expected 'CONNECTIVITY'");
      connectivity = numbers(second, std::string(word()), "CONNECTIVITY");
      if (!offsets.empty()) offsets.erase(offsets.begin());  // it begins with zero
    } else {
      at_ = before;
      const auto mixed = numbers(second, "int", "cells");
      for (std::size_t k = 0; k < mixed.size();) {
        const double corners = mixed[k++];
        if (!(corners >= 0 && corners <= double(mixed.size() - k))) fail("cells: a count of corners is out of range");
        for (double c = 0; c < corners; ++c) connectivity.push_back(mixed[k++]);
        offsets.push_back(double(connectivity.size()));
      }
    }
    if (kept) lists_.push_back({std::move(offsets), std::move(connectivity), strips});
  }

  void field() {
    word();  // its name
    const std::size_t arrays = count("FIELD");
    for (std::size_t k = 0; k < arrays; ++k) {
      auto name = word();
      while (same_word(name, "METADATA")) {
        line();
        while (at_ < bytes_.size() && line().find_first_not_of(" \r") != std::string_view::npos) continue;
        name = word();
      }
      const std::size_t parts = count("FIELD"), tuples = count("FIELD");
      const std::string type(word());
      if (type == "string") {
        line();
        for (std::size_t i = 0; i < parts * tuples && at_ < bytes_.size(); ++i) line();
      } else {
        if (parts * tuples > bytes_.size()) fail("truncated in FIELD");
        numbers(parts * tuples, type, "FIELD");
      }
    }
  }

  void finish() {
    for (const auto& list : lists_) {
      if (const auto cause = detail::add_vtk_cells(soup_, list, 0); !cause.empty()) fail(cause);
    }
    if (const auto cause = detail::vtk_points_fault(soup_); !cause.empty()) fail(cause);
  }

  std::string_view bytes_;
  const std::filesystem::path& file_;
  std::size_t at_ = 0;
  bool text_ = true;
  PolygonSoup soup_;
  std::vector<detail::VtkCells> lists_;
};

}  // namespace

namespace detail {

std::optional<VtkType> vtk_type(std::string_view name) {
  static const std::vector<std::pair<std::string_view, VtkType>> types{
      {"float", {'f', 4}},         {"double", {'f', 8}},         {"int", {'i', 4}},
      {"unsigned_int", {'u', 4}},  {"long", {'i', 8}},           {"unsigned_long", {'u', 8}},
      {"vtktypeint64", {'i', 8}},  {"vtkIdType", {'i', 8}},      {"vtktypeint32", {'i', 4}},
      {"short", {'i', 2}},         {"unsigned_short", {'u', 2}}, {"char", {'i', 1}},
      {"unsigned_char", {'u', 1}}, {"Float32", {'f', 4}},        {"Float64", {'f', 8}},
      {"Int8", {'i', 1}},          {"UInt8", {'u', 1}},          {"Int16", {'i', 2}},
      {"UInt16", {'u', 2}},        {"Int32", {'i', 4}},          {"UInt32", {'u', 4}},
      {"Int64", {'i', 8}},         {"UInt64", {'u', 8}}};
  for (const auto& [known, type] : types) {
    if (known == name) return type;
  }
  return std::nullopt;
}

std::vector<double> vtk_numbers(std::string_view bytes, const VtkType& type, bool big_endian) {
  std::vector<double> values(bytes.size() / type.size);
  for (std::size_t k = 0; k < values.size(); ++k) {
    std::uint64_t bits = 0;
    for (std::size_t b = 0; b < type.size; ++b) {
      const auto byte = static_cast<unsigned char>(bytes[k * type.size + (big_endian ? type.size - 1 - b : b)]);
      bits |= std::uint64_t(byte) << (8 * b);
    }
    if (type.kind == 'f') {
      values[k] = type.size == 4 ? double(std::bit_cast<float>(std::uint32_t(bits))) : std::bit_cast<double>(bits);
    } else if (type.kind == 'u') {
      values[k] = double(bits);
    } else {
      const int unused = 64 - 8 * int(type.size);
      values[k] = double(static_cast<std::int64_t>(bits << unused) >> unused);
    }
  }
  return values;
}

std::string add_vtk_cells(PolygonSoup& soup, const VtkCells& cells, std::size_t first_vertex) {
  const auto vertices = double(soup.vertices.size() - first_vertex);
  std::size_t begin = 0;
  for (std::size_t cell = 0; cell < cells.offsets.size(); ++cell) {
    const double end = cells.offsets[cell];
    if (!(end >= double(begin) && end <= double(cells.connectivity.size())) || end != std::floor(end)) {
      return "cell " + std::to_string(cell) + ": its end is outside 0.." + std::to_string(cells.connectivity.size());
    }
    std::vector<std::int32_t> corners;
    for (; begin < std::size_t(end); ++begin) {
      const double index = cells.connectivity[begin];
      if (!(index >= 0 && index < vertices) || index != std::floor(index)) {
        return "cell " + std::to_string(cell) + ": a point is outside 0.." + std::to_string(std::int64_t(vertices) - 1);
      }
      corners.push_back(std::int32_t(std::size_t(index) + first_vertex));
    }
    if (!cells.strips) {
      soup.corners.insert(soup.corners.end(), corners.begin(), corners.end());
      end_polygon(soup);
    }
    for (std::size_t k = 0; cells.strips && k + 2 < corners.size(); ++k) {
      const std::size_t odd = k % 2;
      for (const auto c : {corners[k], corners[k + 1 + odd], corners[k + 2 - odd]}) soup.corners.push_back(c);
      end_polygon(soup);
    }
  }
  return {};
}

std::string vtk_points_fault(const PolygonSoup& soup) {
  for (std::size_t v = 0; v < soup.vertices.size(); ++v) {
    if (soup.vertices[v].allFinite() && soup.vertices[v].cwiseAbs().maxCoeff() <= largest_coordinate) continue;
    return "point " + std::to_string(v) + ": a coordinate is not finite or beyond 1e15";
  }
  return {};
}

}  // namespace detail

PolygonSoup read_vtk(std::string_view bytes, const std::filesystem::path& file) {
  return LegacyReader(bytes, file).read();
}

}  // namespace palpate
