// SPDX-License-Identifier: MIT
// Reader of VTK's XML polydata (.vtp): text, base64 and appended arrays, plain or compressed by zlib.
#include "formats/surface/surface_text.hpp"
#include "formats/surface/vtk_numbers.hpp"

#include <zlib.h>

#include <map>

namespace palpate {
namespace {

using Attributes = std::map<std::string, std::string, std::less<>>;

struct Tag {
  std::string name;  ///< with a '/' before it where it closes
  Attributes attributes;
  std::size_t end = 0;  ///< of the byte behind '>'
};

class XmlReader {
public:
  XmlReader(std::string_view bytes, const std::filesystem::path& file) : bytes_(bytes), file_(file) {}

  PolygonSoup read() {
    soup_.frame = stated_frame(bytes_.substr(0, 4096));
    Tag tag;
    bool inside = false;
    std::string section;
    while (next(tag)) {
      if (tag.name == "VTKFile") {
        begin_file(tag);
        inside = true;
      } else if (tag.name == "AppendedData") {
        break;
      } else if (tag.name == "Piece") {
        end_piece();
      } else if (tag.name == "DataArray" && inside) {
        data_array(tag, section);
      } else if (tag.name == "Points" || tag.name == "Polys" || tag.name == "Strips") {
        section = tag.name;
      } else if (tag.name == "/Points" || tag.name == "/Polys" || tag.name == "/Strips") {
        section.clear();
      } else if (tag.name == "FieldData" && tag.attributes.empty()) {
        section.clear();
      }
    }
    if (!inside) fail("not a VTK XML file: no element VTKFile");
    if (bytes_.find("</VTKFile", bytes_.size() - std::min<std::size_t>(bytes_.size(), 64)) == std::string_view::npos) {
      fail("truncated: it does not end with </VTKFile>");
    }
    end_piece();
    if (const auto cause = detail::vtk_points_fault(soup_); !cause.empty()) fail(cause);
    return std::move(soup_);
  }

private:
  [[noreturn]] void fail(const std::string& cause) const {
    throw Error(ExitCode::bad_input, file_.string() + ": " + cause);
  }

  static std::string get(const Tag& tag, std::string_view name, const char* otherwise = "") {
    const auto at = tag.attributes.find(name);
    return at == tag.attributes.end() ? otherwise : at->second;
  }

  bool next(Tag& tag) {
    for (;;) {
      at_ = bytes_.find('<', at_);
      if (at_ == std::string_view::npos) return false;
      if (bytes_.substr(at_, 4) == "<!--") {
        const auto end = bytes_.find("-->", at_);
        if (soup_.frame == Frame::unstated) soup_.frame = stated_frame(bytes_.substr(at_, end - at_));
        if (end == std::string_view::npos) return false;
        at_ = end;
        continue;
      }
      const auto end = bytes_.find('>', at_);
      if (end == std::string_view::npos) fail("truncated in an element");
      std::string_view text = bytes_.substr(at_ + 1, end - at_ - 1);
      at_ = tag.end = end + 1;
      if (text.starts_with('?') || text.starts_with('!')) continue;
      if (text.ends_with('/')) text.remove_suffix(1);
      parse(text, tag);
      return true;
    }
  }

  void parse(std::string_view text, Tag& tag) const {
    constexpr std::string_view space = " \t\r\n";
    const auto name_end = std::min(text.find_first_of(space), text.size());
    tag.name = text.substr(0, name_end);
    tag.attributes.clear();
    text.remove_prefix(name_end);
    for (;;) {
      const auto begin = text.find_first_not_of(space);
      if (begin == std::string_view::npos) return;
      const auto equals = text.find('=', begin);
      const auto quote = equals == std::string_view::npos ? equals : text.find_first_of("\"'", equals);
      const auto close = quote == std::string_view::npos ? quote : text.find(text[quote], quote + 1);
      if (close == std::string_view::npos) fail("damaged attributes of element " + tag.name.substr(0, 32));
      auto key = text.substr(begin, equals - begin);
      while (!key.empty() && space.find(key.back()) != std::string_view::npos) key.remove_suffix(1);
      tag.attributes.emplace(key, text.substr(quote + 1, close - quote - 1));
      text.remove_prefix(close + 1);
    }
  }

  void begin_file(const Tag& tag) {
    if (get(tag, "type") != "PolyData") fail("its type is " + get(tag, "type").substr(0, 32) + "; allowed: PolyData");
    big_endian_ = get(tag, "byte_order", "LittleEndian") == "BigEndian";
    header_size_ = get(tag, "header_type", "UInt32") == "UInt64" ? 8 : 4;
    const std::string compressor = get(tag, "compressor");
    compressed_ = !compressor.empty();
    if (compressed_ && compressor != "vtkZLibDataCompressor") {
      fail("compressed by " + compressor.substr(0, 40) + "; allowed: vtkZLibDataCompressor, or none");
    }
    const auto appended = bytes_.find("<AppendedData");
    if (appended == std::string_view::npos) return;
    const auto end = bytes_.find('>', appended), mark = bytes_.find('_', end);
    if (mark == std::string_view::npos) fail("appended data without their mark '_'");
    raw_ = bytes_.substr(appended, end - appended).find("raw") != std::string_view::npos;
    appended_ = bytes_.substr(mark + 1);
  }

  // Quads of base64; a padded quad may stand between a header and its data.
  std::string base64(std::string_view text, std::size_t most) const {
    static constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    std::uint32_t bits = 0;
    int count = 0, padding = 0;
    for (const char c : text) {
      if (c == ' ' || c == '\n' || c == '\r' || c == '\t') continue;
      if (c == '<' || out.size() >= most) break;
      const auto digit = c == '=' ? 0 : digits.find(c);
      if (digit == std::string_view::npos) fail("its base64 data are damaged");
      padding += c == '=';
      bits = bits << 6 | std::uint32_t(digit);
      if (++count < 4) continue;
      for (int b = 0; b < 3 - padding; ++b) out += char(bits >> (16 - 8 * b) & 0xff);
      bits = 0;
      count = padding = 0;
    }
    return out;
  }

  std::uint64_t header_word(std::string_view data, std::size_t k) const {
    if (data.size() < (k + 1) * header_size_) fail("truncated in the header of an array");
    const double word =
        detail::vtk_numbers(data.substr(k * header_size_, header_size_), {'u', header_size_}, big_endian_)[0];
    constexpr double kMost = 0x1p40;  // bytes
    if (!(word < kMost)) fail("a length in the header of an array is out of range");
    return std::uint64_t(word);
  }

  // The plain bytes of an array whose header begins at `text`.
  std::string array_bytes(std::string_view text, bool encoded) const {
    constexpr std::uint64_t kMost = std::uint64_t{1} << 31;
    const auto piece = [&](std::size_t bytes) {
      return encoded ? base64(text, bytes) : std::string(text.substr(0, std::min(bytes, text.size())));
    };
    if (!compressed_) {
      const std::uint64_t length = header_word(piece(header_size_), 0);
      if (length > kMost || length > text.size()) fail("truncated in an array");
      std::string all = piece(header_size_ + std::size_t(length));
      if (all.size() < header_size_ + length) fail("truncated in an array");
      return all.substr(header_size_, std::size_t(length));
    }
    const std::uint64_t blocks = header_word(piece(header_size_), 0);
    if (blocks > text.size() / header_size_) fail("truncated in the header of an array");
    const std::size_t header = std::size_t(3 + blocks) * header_size_;
    const std::string head = piece(header);
    const std::uint64_t block = header_word(head, 1), last = header_word(head, 2);
    if (block > kMost || last > kMost || blocks * block > kMost) fail("an array of more than 2 GiB");
    // Encoded on its own, the header is padded to whole quads.
    const std::size_t skipped = encoded ? (header + 2) / 3 * 4 : header;
    if (encoded) {
      const auto begin = text.find_first_not_of(" \n\r\t");
      text.remove_prefix(std::min(text.size(), (begin == std::string_view::npos ? text.size() : begin) + skipped));
    } else {
      text.remove_prefix(std::min(text.size(), skipped));
    }
    std::uint64_t stored = 0;
    for (std::uint64_t b = 0; b < blocks; ++b) stored += header_word(head, std::size_t(3 + b));
    if (stored > text.size()) fail("truncated in an array");
    const std::string packed = piece(std::size_t(stored));
    std::string out;
    std::size_t from = 0;
    for (std::uint64_t b = 0; b < blocks; ++b) {
      const auto length = std::size_t(header_word(head, std::size_t(3 + b)));
      if (from + length > packed.size()) fail("truncated in an array");
      auto size = uLongf(b + 1 == blocks && last > 0 ? last : block);
      constexpr std::size_t kMostShrunk = 1100;  // zlib packs no better
      if (size > kMostShrunk * (length + 64))
        fail("its compressed data are damaged: a block is too small for its size");
      const std::size_t begin = out.size();
      out.resize(begin + size);
      if (uncompress(reinterpret_cast<Bytef*>(out.data() + begin), &size,
                     reinterpret_cast<const Bytef*>(packed.data() + from), uLong(length)) != Z_OK ||
          begin + size != out.size()) {
        fail("its compressed data are damaged");
      }
      from += length;
    }
    return out;
  }

  std::vector<double> array_numbers(const Tag& tag) {
    const auto type = detail::vtk_type(get(tag, "type"));
    if (!type) fail("an array of the unknown type '" + get(tag, "type").substr(0, 32) + "'");
    const std::string format = get(tag, "format", "ascii");
    if (format == "ascii") {
      std::vector<double> values;
      detail::TextScan scan(bytes_.substr(tag.end, bytes_.find('<', tag.end) - tag.end), file_);
      for (auto token = scan.token(); !token.empty(); token = scan.token()) {
        double value = 0;
        const auto [end, code] = std::from_chars(token.data(), token.data() + token.size(), value);
        if (end != token.data() + token.size() || code != std::errc()) {
          fail("'" + std::string(token.substr(0, 32)) + "' in an array is not a number");
        }
        values.push_back(value);
      }
      return values;
    }
    std::string data;
    if (format == "binary") {
      data = array_bytes(bytes_.substr(tag.end, bytes_.find('<', tag.end) - tag.end), true);
    } else if (format == "appended") {
      const std::string text = get(tag, "offset", "x");
      std::uint64_t offset = 0;
      const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), offset);
      if (code != std::errc() || end != text.data() + text.size() || offset > appended_.size()) {
        fail("the offset '" + text.substr(0, 32) + "' of an array lies outside the appended data");
      }
      data = array_bytes(appended_.substr(std::size_t(offset)), !raw_);
    } else {
      fail("an array of the unknown format '" + format.substr(0, 32) + "'");
    }
    return detail::vtk_numbers(data, *type, big_endian_);
  }

  void data_array(const Tag& tag, const std::string& section) {
    const std::string name = get(tag, "Name");
    if (section == "Points") {
      if (!points_.empty()) return;
      points_ = array_numbers(tag);
      soup_.single = soup_.single || get(tag, "type") == "Float32";
    } else if (section == "Polys" || section == "Strips") {
      auto& cells = section == "Polys" ? polygons_ : strips_;
      if (name == "connectivity") cells.connectivity = array_numbers(tag);
      if (name == "offsets") cells.offsets = array_numbers(tag);
    }
  }

  void end_piece() {
    const std::size_t first = soup_.vertices.size();
    if (points_.size() % 3 != 0) fail("its points are not triples");
    for (std::size_t k = 0; k + 2 < points_.size(); k += 3) {
      soup_.vertices.emplace_back(points_[k], points_[k + 1], points_[k + 2]);
    }
    strips_.strips = true;
    for (const auto* cells : {&polygons_, &strips_}) {
      if (const auto cause = detail::add_vtk_cells(soup_, *cells, first); !cause.empty()) fail(cause);
    }
    points_.clear();
    polygons_ = strips_ = {};
  }

  std::string_view bytes_, appended_;
  const std::filesystem::path& file_;
  std::size_t at_ = 0, header_size_ = 4;
  bool big_endian_ = false, compressed_ = false, raw_ = false;
  PolygonSoup soup_;
  std::vector<double> points_;
  detail::VtkCells polygons_, strips_;
};

}  // namespace

PolygonSoup read_vtp(std::string_view bytes, const std::filesystem::path& file) {
  return XmlReader(bytes, file).read();
}

}  // namespace palpate
