// SPDX-License-Identifier: MIT
// Screen of PLY files, text and binary in both byte orders.
#include "formats/surface_screen.hpp"
#include "formats/surface_text.hpp"

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
      const auto end = bytes.find('\n', bytes.find(mark));
      header.body = end == std::string_view::npos ? bytes.size() : end + 1;
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
    } else if (key != "comment" && key != "obj_info" && !key.empty()) {
      scan.fail("unknown PLY header line '" + std::string(key.substr(0, 32)) + "'");
    }
  }
  scan.fail("truncated: no end_header line");
}

// What a triangle surface needs; further scalar properties and further elements are passed over.
void check_layout(const Header& header, const std::filesystem::path& file) {
  const auto fail = [&](const std::string& cause) { throw Error(ExitCode::bad_input, file.string() + ": " + cause); };
  const auto& elements = header.elements;
  if (elements.size() < 2 || elements[0].name != "vertex" || elements[1].name != "face") {
    fail("a PLY surface needs the elements vertex and face, in this order, before any other");
  }
  for (const std::string axis : {"x", "y", "z"}) {
    const auto& all = elements[0].properties;
    const auto found = std::find_if(all.begin(), all.end(), [&](const Property& p) { return p.name == axis; });
    if (found == all.end()) fail("vertices have no property " + axis);
    if (found->kind != 'f' || found->count_kind) fail("the property " + axis + " must be float or double");
  }
  for (const auto& property : elements[0].properties) {
    if (property.count_kind) fail("list properties of vertices (" + property.name + ") are not supported");
  }
  const auto& corners = elements[1].properties;
  if (corners.empty() || !corners[0].count_kind || corners[0].kind == 'f' ||
      (corners[0].name != "vertex_indices" && corners[0].name != "vertex_index")) {
    fail("the first property of faces must be the list vertex_indices, of an integer type");
  }
  if (std::any_of(corners.begin() + 1, corners.end(), [](const Property& p) { return p.count_kind != 0; })) {
    fail("faces with a second list property are not supported");
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
    if (word.front() == '+') word.remove_prefix(1);
    double value = 0;
    const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (end != word.data() + word.size() || code == std::errc::invalid_argument) {
      fail(what + ": '" + std::string(word.substr(0, 32)) + "' is not a number");
    }
    return code == std::errc() || word.find('-', 1) != std::string_view::npos ? value : INFINITY;
  }

  bool text_, swap_;
  std::string_view body_;
  std::size_t at_ = 0;
  TextScan scan_;
  std::filesystem::path file_;
  std::size_t header_lines_;
};

void append_number(std::string& text, double value, char behind) {
  char digits[32];
  text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
  text += behind;
}

}  // namespace

SurfaceCensus screen_ply(std::string_view bytes, const std::filesystem::path& file) {
  const auto header = read_header(bytes, file);
  check_layout(header, file);
  Values values(bytes, header, file);
  SurfaceCensus census;
  const auto& vertex = header.elements[0];
  const auto& face = header.elements[1];
  // OpenMesh's header reader waits for ever on some damaged headers: it is shown one of ours.
  census.plain = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(vertex.count) +
                 "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
                 std::to_string(face.count) + "\nproperty list int int vertex_indices\nend_header\n";
  for (std::int64_t i = 0; i < vertex.count; ++i) {
    Eigen::Vector3d point(0, 0, 0);
    const auto what = "vertex " + std::to_string(i);
    for (const auto& property : vertex.properties) {
      const auto value = values.next(property.kind, property.size, what);
      const auto axis = property.name.size() == 1 ? std::string_view("xyz").find(property.name[0]) : 3;
      if (axis > 2) continue;
      if (!std::isfinite(value) || std::abs(value) > largest_coordinate) {
        values.fail(what + ": coordinate " + property.name + " is not finite or beyond 1e15");
      }
      point[static_cast<int>(axis)] = value;
    }
    census.bounds.extend(point);
    ++census.vertices;
    append_number(census.plain, point.x(), ' ');
    append_number(census.plain, point.y(), ' ');
    append_number(census.plain, point.z(), '\n');
  }
  std::vector<std::int64_t> corners;
  for (std::int64_t i = 0; i < face.count; ++i) {
    const auto what = "face " + std::to_string(i);
    const auto& list = face.properties[0];
    const auto count = values.next(list.count_kind, list.count_size, what);
    if (!(count >= 3 && count <= 1e6)) values.fail(what + ": the number of corners is outside 3..1000000");
    corners.clear();
    census.plain += std::to_string(static_cast<int>(count));
    for (int corner = 0; corner < static_cast<int>(count); ++corner) {
      const auto index = values.next(list.kind, list.size, what);
      if (!(index >= 0 && index < double(vertex.count)) || index != std::floor(index)) {
        values.fail(what + ": a vertex index is outside 0.." + std::to_string(vertex.count - 1));
      }
      corners.push_back(static_cast<std::int64_t>(index));
      census.plain += ' ' + std::to_string(corners.back());
    }
    census.plain += '\n';
    census.polygons += detail::distinct(corners) >= 3;
    for (std::size_t p = 1; p < face.properties.size(); ++p) {
      values.next(face.properties[p].kind, face.properties[p].size, what);
    }
  }
  return census;
}

}  // namespace palpate
