// SPDX-License-Identifier: MIT
// Reader of PLY files, text and binary in both byte orders, with elements and properties in any order.
#include "formats/surface/surface_plain.hpp"
#include "formats/surface/surface_text.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <map>

namespace palpate {
namespace {

using detail::TextScan;

struct Property {
  std::string name;
  char kind = 'f';       ///< i, u or f
  std::size_t size = 0;  ///< bytes
  char count_kind = 0;   ///< of a list's count; 0: a scalar
  std::size_t count_size = 0;
};

struct Element {
  std::string name;
  std::int64_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  enum class Form { text, little, big } form = Form::text;
  std::vector<Element> elements;
  std::size_t body = 0;   ///< offset of the first byte behind the header
  std::size_t lines = 0;  ///< of the header
  Frame frame = Frame::unstated;
};

std::pair<char, std::size_t> type_of(std::string_view name, const TextScan& scan) {
  static const std::map<std::string_view, std::pair<char, std::size_t>> types = {
      {"char", {'i', 1}},  {"int8", {'i', 1}},    {"uchar", {'u', 1}},  {"uint8", {'u', 1}},
      {"short", {'i', 2}}, {"int16", {'i', 2}},   {"ushort", {'u', 2}}, {"uint16", {'u', 2}},
      {"int", {'i', 4}},   {"int32", {'i', 4}},   {"uint", {'u', 4}},   {"uint32", {'u', 4}},
      {"float", {'f', 4}}, {"float32", {'f', 4}}, {"double", {'f', 8}}, {"float64", {'f', 8}}};
  const auto found = types.find(name);
  if (found == types.end()) scan.fail("unknown PLY type '" + std::string(name.substr(0, 32)) + "'");
  return found->second;
}

Header read_header(std::string_view bytes, const std::filesystem::path& file) {
  constexpr std::string_view mark = "end_header";
  TextScan scan(bytes, file);
  if (!scan.next_line() || scan.rest() != "ply") scan.fail("not a PLY file: it does not begin with 'ply'");
  Header header;
  bool formed = false;
  while (scan.next_line()) {
    const auto key = scan.word();
    if (key == mark) {
      if (!formed) scan.fail("PLY header without a format line");
      header.body = scan.offset();
      // Old line ends are one byte, and a line feed behind them belongs to binary data.
      const auto first_return = bytes.find('\r');
      const bool old_ends = first_return != std::string_view::npos && bytes.substr(first_return, 2) != "\r\n";
      if (old_ends && bytes.substr(header.body - 2, 2) == "\r\n") --header.body;
      header.lines = scan.line();
      return header;
    }
    if (key == "format") {
      const auto form = scan.word();
      if (form == "ascii") {
        header.form = Header::Form::text;
      } else if (form == "binary_little_endian") {
        header.form = Header::Form::little;
      } else if (form == "binary_big_endian") {
        header.form = Header::Form::big;
      } else {
        scan.fail("unknown PLY format '" + std::string(form.substr(0, 32)) + "'");
      }
      formed = true;
    } else if (key == "element") {
      Element element;
      element.name = scan.word();
      element.count = scan.integer(scan.word(), "element " + element.name);
      if (element.count < 0) scan.fail("negative count of element " + element.name);
      header.elements.push_back(std::move(element));
    } else if (key == "property") {
      if (header.elements.empty()) scan.fail("a property before any element");
      Property property;
      auto type = scan.word();
      if (type == "list") {
        std::tie(property.count_kind, property.count_size) = type_of(scan.word(), scan);
        if (property.count_kind == 'f') scan.fail("the count of a list must be an integer type");
        type = scan.word();
      }
      std::tie(property.kind, property.size) = type_of(type, scan);
      property.name = scan.word();
      header.elements.back().properties.push_back(std::move(property));
    } else if (key == "comment") {
      if (header.frame == Frame::unstated) header.frame = stated_frame(scan.rest());
    } else if (key != "obj_info" && !key.empty()) {
      scan.fail("unknown PLY header line '" + std::string(key.substr(0, 32)) + "'");
    }
  }
  scan.fail("truncated: no end_header line");
}

[[noreturn]] void refuse_layout(const std::filesystem::path& file, const std::string& cause) {
  throw Error(ExitCode::bad_input, file.string() + ": " + cause);
}

bool is_indices(const Property& p) {
  return p.count_kind != 0 && p.kind != 'f' && (p.name == "vertex_indices" || p.name == "vertex_index");
}

// Properties that a surface needs; further properties and further elements are passed over.
void check_layout(const Header& header, const std::filesystem::path& file) {
  const auto element = [&](std::string_view name) {
    const auto found =
        std::find_if(header.elements.begin(), header.elements.end(), [&](const Element& e) { return e.name == name; });
    return found == header.elements.end() ? nullptr : &*found;
  };
  const Element *vertex = element("vertex"), *face = element("face"), *strips = element("tristrips");
  if (vertex == nullptr || (face == nullptr && strips == nullptr)) {
    refuse_layout(file, "a PLY surface needs the elements vertex and face (or tristrips)");
  }
  for (const std::string axis : {"x", "y", "z"}) {
    const auto& all = vertex->properties;
    const auto found = std::find_if(all.begin(), all.end(), [&](const Property& p) { return p.name == axis; });
    if (found == all.end()) refuse_layout(file, "vertices have no property " + axis);
    if (found->count_kind) refuse_layout(file, "the property " + axis + " must be a number, not a list");
  }
  for (const Element* with : {face, strips}) {
    if (with == nullptr || std::any_of(with->properties.begin(), with->properties.end(), is_indices)) continue;
    refuse_layout(file, "the element " + with->name + " has no list vertex_indices of an integer type");
  }
}

// Values of the body one after the other, from text or from bytes.
class Values {
public:
  Values(std::string_view bytes, const Header& header, std::filesystem::path file)
      : text_(header.form == Header::Form::text),
        swap_(header.form == Header::Form::big),
        body_(bytes.substr(header.body)),
        scan_(body_, file),
        file_(std::move(file)),
        header_lines_(header.lines) {}

  [[noreturn]] void fail(const std::string& cause) const {
    const auto place = text_ ? ":" + std::to_string(header_lines_ + scan_.line()) : std::string();
    throw Error(ExitCode::bad_input, file_.string() + place + ": " + cause);
  }

  double next(char kind, std::size_t size, const std::string& what) {
    if (text_) return next_word(what);
    if (body_.size() - at_ < size) fail("truncated in " + what);
    unsigned char raw[8] = {};
    std::memcpy(raw, body_.data() + at_, size);
    if (swap_) std::reverse(raw, raw + size);
    at_ += size;
    if (kind == 'f') return size == 4 ? double(cast<float>(raw)) : cast<double>(raw);
    if (size == 1) return kind == 'i' ? double(cast<std::int8_t>(raw)) : double(cast<std::uint8_t>(raw));
    if (size == 2) return kind == 'i' ? double(cast<std::int16_t>(raw)) : double(cast<std::uint16_t>(raw));
    return kind == 'i' ? double(cast<std::int32_t>(raw)) : double(cast<std::uint32_t>(raw));
  }

  [[nodiscard]] std::string_view last() const { return last_; }  ///< of a text: the last value as it stands

private:
  template <class T>
  static T cast(const unsigned char* raw) {
    static_assert(std::endian::native == std::endian::little);
    T value;
    std::memcpy(&value, raw, sizeof value);
    return value;
  }

  double next_word(const std::string& what) {
    auto word = scan_.word();
    while (word.empty()) {
      if (!scan_.next_line()) fail("truncated in " + what);
      word = scan_.word();
    }
    last_ = word;
    if (word.front() == '+') word.remove_prefix(1);
    double value = 0;
    const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (end != word.data() + word.size() || code == std::errc::invalid_argument) {
      fail(what + ": '" + std::string(word.substr(0, 32)) + "' is not a number");
    }
    return code == std::errc() || word.find('-', 1) != std::string_view::npos ? value : INFINITY;
  }

  bool text_, swap_;
  std::string_view last_;
  std::string_view body_;
  std::size_t at_ = 0;
  TextScan scan_;
  std::filesystem::path file_;
  std::size_t header_lines_;
};

// Reads one element after the other.
class PlyReader {
public:
  PlyReader(std::string_view bytes, const Header& header, const std::filesystem::path& file)
      : header_(header), values_(bytes, header, file) {}

  PolygonSoup read() {
    soup_.frame = header_.frame;
    for (const Element& element : header_.elements) {
      if (element.name == "vertex") {
        vertices_ = double(element.count);
      }
    }
    for (const Element& element : header_.elements) {
      if (element.properties.empty()) continue;
      for (std::int64_t i = 0; i < element.count; ++i) {
        const auto what = element.name + " " + std::to_string(i);
        if (element.name == "vertex") {
          vertex(element, what);
        } else if (element.name == "face" || element.name == "tristrips") {
          polygons(element, what);
        } else {
          for (const Property& property : element.properties) skip(property, what);
        }
      }
    }
    return std::move(soup_);
  }

private:
  void skip(const Property& property, const std::string& what) {
    const double count = property.count_kind ? values_.next(property.count_kind, property.count_size, what) : 1;
    if (!(count >= 0 && count <= 1e9)) values_.fail(what + ": the length of a list is outside 0..1000000000");
    for (double k = 0; k < count; ++k) values_.next(property.kind, property.size, what);
  }

  void vertex(const Element& element, const std::string& what) {
    Eigen::Vector3d point(0, 0, 0);
    for (const Property& property : element.properties) {
      const auto axis = property.name.size() == 1 ? std::string_view("xyz").find(property.name[0]) : 3;
      if (axis > 2) {
        skip(property, what);
        continue;
      }
      const auto value = values_.next(property.kind, property.size, what);
      if (!std::isfinite(value) || std::abs(value) > largest_coordinate) {
        values_.fail(what + ": coordinate " + property.name + " is not finite or beyond 1e15");
      }
      point[static_cast<int>(axis)] = value;
      if (property.kind == 'f' && property.size == 4 && header_.form != Header::Form::text) soup_.single = true;
      if (header_.form == Header::Form::text) detail::count_decimals(soup_, values_.last());
    }
    soup_.vertices.push_back(point);
  }

  void polygons(const Element& element, const std::string& what) {
    for (const Property& property : element.properties) {
      if (!is_indices(property)) {
        skip(property, what);
        continue;
      }
      const bool strip = element.name == "tristrips";
      const auto count = values_.next(property.count_kind, property.count_size, what);
      if (!(count >= (strip ? 0 : 3) && count <= (strip ? 1e9 : 1e6))) {
        values_.fail(what + ": the number of corners is outside 3..1000000");
      }
      std::vector<std::int32_t> corners;
      for (double corner = 0; corner < count; ++corner) {
        const auto index = values_.next(property.kind, property.size, what);
        if (strip && index == -1) {
          end_strip(corners);
          continue;
        }
        if (!(index >= 0 && index < vertices_ && index <= 2147483646.0) || index != std::floor(index)) {
          values_.fail(what + ": a vertex index is outside 0.." +
                       std::to_string(static_cast<std::int64_t>(vertices_) - 1));
        }
        (strip ? corners : soup_.corners).push_back(static_cast<std::int32_t>(index));
      }
      strip ? end_strip(corners) : static_cast<void>(detail::end_polygon(soup_));
    }
  }

  // Every second triangle of a strip runs backwards; -1 begins a new strip.
  void end_strip(std::vector<std::int32_t>& corners) {
    for (std::size_t k = 0; k + 2 < corners.size(); ++k) {
      const std::size_t odd = k % 2;
      for (const auto c : {corners[k], corners[k + 1 + odd], corners[k + 2 - odd]}) soup_.corners.push_back(c);
      detail::end_polygon(soup_);
    }
    corners.clear();
  }

  const Header& header_;
  Values values_;
  PolygonSoup soup_;
  double vertices_ = 0;
};

}  // namespace

PolygonSoup read_ply(std::string_view bytes, const std::filesystem::path& file) {
  const auto header = read_header(bytes, file);
  check_layout(header, file);
  return PlyReader(bytes, header, file).read();
}

}  // namespace palpate
