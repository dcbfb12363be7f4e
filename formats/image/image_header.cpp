// SPDX-License-Identifier: MIT
// Text headers of NRRD (teem.sourceforge.net/nrrd/format.html) and MetaImage: fields by name, and what they must hold.
#include "formats/image/image_header.hpp"

#include "formats/io/error.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::detail {
namespace {

constexpr std::size_t kLongestHeader = std::size_t{1} << 20;  // bytes; a header of Slicer's takes some kilobytes

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::string trimmed(std::string_view text) {
  const auto begin = text.find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) return {};
  return std::string(text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1));
}

constexpr double kLargestNumber = 1e12;

class Header {
public:
  Header(const std::filesystem::path& file, ImageKind kind) : file_(file) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) {
      throw Error(ExitCode::io, file.string() + ": cannot read the image: no regular file is there");
    }
    std::ifstream stream(file, std::ios::binary);
    std::string text(kLongestHeader, '\0');
    stream.read(text.data(), std::streamsize(text.size()));
    text.resize(std::size_t(std::max<std::streamsize>(stream.gcount(), 0)));
    if (!stream.is_open() || stream.bad()) throw Error(ExitCode::io, file.string() + ": cannot read the image");
    if (text.empty()) fail("", "the file is empty");
    if (kind == ImageKind::nrrd) parse_nrrd(text);
    if (kind == ImageKind::meta) parse_meta(text);
  }

  [[noreturn]] void fail(const std::string& field, const std::string& what) const {
    throw Error(ExitCode::bad_input, file_.string() + ": " + (field.empty() ? "" : field + ": ") + what);
  }

  [[nodiscard]] std::optional<std::string> get(std::initializer_list<const char*> names) const {
    for (const char* name : names) {
      if (const auto at = fields_.find(name); at != fields_.end()) return at->second;
    }
    return std::nullopt;
  }

  [[nodiscard]] std::string need(const char* name) const {
    if (const auto value = get({name})) return *value;
    fail(name, "missing");
  }

  [[nodiscard]] std::vector<double> numbers(const std::string& field, std::string value) const {
    std::replace_if(
        value.begin(), value.end(), [](char c) { return c == '(' || c == ')' || c == ',' || c == '\t'; }, ' ');
    std::vector<double> all;
    std::istringstream words(value);
    for (std::string word; words >> word;) {
      if (word == "none" || lower(word) == "nan") continue;  // an axis of a list has no direction in space
      double number = 0;
      const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), number);
      if (code != std::errc() || end != word.data() + word.size() || !(std::abs(number) < kLargestNumber)) {
        fail(field, "got '" + value.substr(0, 60) + "'; allowed: numbers");
      }
      all.push_back(number);
    }
    return all;
  }

  // Image axes of `field`, `dimensions` of them; a list of segments' layers may come before.
  void check_sizes(const char* field, std::size_t dimensions) const {
    const auto sizes = numbers(field, need(field));
    if (sizes.size() != dimensions) {
      fail(field, "got " + std::to_string(sizes.size()) + " numbers; allowed: " + std::to_string(dimensions));
    }
    for (const double n : sizes) {
      if (!(n >= 1 && n <= 65536 && n == double(std::int64_t(n)))) {
        fail(field, "got '" + need(field).substr(0, 60) + "'; allowed: whole numbers from 1 to 65536");
      }
    }
  }

  // Voxels beside the header: one regular file, and no pattern of names.
  void check_data_file(const char* field, const std::string& name) const {
    if (name.find(' ') != std::string::npos || name.find('%') != std::string::npos || lower(name) == "list") {
      fail(field, "got '" + name.substr(0, 60) + "'; allowed: one file");
    }
    std::error_code error;
    if (!std::filesystem::is_regular_file(file_.parent_path() / name, error)) {
      throw Error(ExitCode::io, file_.string() + ": " + field + ": '" + name + "' is not there, or no regular file");
    }
  }

  // Beside the header (`name` as the header has it), or behind it.
  [[nodiscard]] VoxelPlace voxels(const std::optional<std::string>& name) const {
    if (name) return {file_.parent_path() / *name, 0, false, false};
    return {file_, offset_, false, false};
  }

private:
  void set(const std::string& name, std::string value) {
    if (!fields_.emplace(lower(name), std::move(value)).second) fail(name, "stands twice in the header");
  }

  void parse_nrrd(std::string_view text) {
    if (text.substr(0, 4) != "NRRD") fail("", "not an NRRD file: it does not begin with NRRD");
    std::size_t at = text.find('\n');
    while (at != std::string_view::npos) {
      const std::size_t end = text.find('\n', at + 1);
      if (end == std::string_view::npos && text.size() == kLongestHeader) break;
      const std::string line = trimmed(text.substr(at + 1, end == std::string_view::npos ? end : end - at - 1));
      at = end;
      if (line.empty()) {
        offset_ = end == std::string_view::npos ? text.size() : end + 1;
        return;
      }
      if (line.front() == '#' || line.find(":=") != std::string::npos) continue;
      const auto colon = line.find(':');
      if (colon == std::string::npos) fail("", "'" + line.substr(0, 40) + "' is not a field of an NRRD header");
      set(line.substr(0, colon), trimmed(std::string_view(line).substr(colon + 1)));
    }
    if (text.size() == kLongestHeader) fail("", "the header does not end within 1 MiB");
    if (!get({"data file", "datafile"})) fail("", "the header has no end (an empty line), and names no data file");
  }

  void parse_meta(std::string_view text) {
    std::size_t at = 0;
    while (at < text.size()) {
      const std::size_t end = std::min(text.find('\n', at), text.size());
      const std::string line = trimmed(text.substr(at, end - at));
      at = end + 1;
      const auto equals = line.find('=');
      if (equals == std::string::npos) {
        if (!line.empty()) fail("", "'" + line.substr(0, 40) + "' is not a field of a MetaImage header");
        continue;
      }
      const std::string name = trimmed(std::string_view(line).substr(0, equals));
      set(name, trimmed(std::string_view(line).substr(equals + 1)));
      offset_ = at;
      if (lower(name) == "elementdatafile") return;
    }
    fail("ElementDataFile", "missing");
  }

  std::filesystem::path file_;
  std::size_t offset_ = 0;  // of the first byte behind the header
  std::map<std::string, std::string> fields_;
};

// 0: the name is no length.
double length_of(const std::string& name) {
  static const std::map<std::string, double> lengths{
      {"m", 1.0},           {"meter", 1.0},       {"metre", 1.0},       {"cm", 0.01},
      {"centimeter", 0.01}, {"mm", 0.001},        {"millimeter", 1e-3}, {"millimetre", 1e-3},
      {"um", 1e-6},         {"\u00b5m", 1e-6},    {"\u03bcm", 1e-6},    {"micron", 1e-6},
      {"micrometer", 1e-6}, {"micrometre", 1e-6}, {"in", 0.0254},       {"inch", 0.0254}};
  std::string one = lower(name);
  if (one.size() > 3 && one.back() == 's') one.pop_back();  // "millimeters"
  const auto at = lengths.find(one);
  return at == lengths.end() ? 0.0 : at->second;
}

StatedSpace check_nrrd(const Header& header) {
  const std::string dimension = header.need("dimension");
  if (dimension != "3" && dimension != "4")
    header.fail("dimension", "got " + dimension + "; allowed: 3, or 4 with layers");
  header.check_sizes("sizes", std::size_t(dimension[0] - '0'));
  if (const auto axes = header.get({"space directions"})) {
    if (header.numbers("space directions", *axes).size() != 9)
      header.fail("space directions", "allowed: three vectors");
  } else if (header.numbers("spacings", header.need("spacings")).size() < 3) {
    header.fail("spacings", "allowed: three numbers");
  }
  if (const auto origin = header.get({"space origin"})) {
    if (header.numbers("space origin", *origin).size() != 3) header.fail("space origin", "allowed: one vector");
  }
  for (const char* ends : {"axis mins", "axis maxs", "axismins", "axismaxs"}) {
    if (header.get({ends})) header.fail(ends, "not allowed; the place of the voxels is 'space origin'");
  }
  if (const auto file = header.get({"data file", "datafile"})) header.check_data_file("data file", *file);
  StatedSpace stated;
  stated.voxels = header.voxels(header.get({"data file", "datafile"}));
  const std::string encoding = lower(header.need("encoding"));
  stated.voxels.gzip = encoding == "gzip" || encoding == "gz";
  const std::string space = lower(header.get({"space"}).value_or(""));
  // ITK mirrors the wrong axis.
  if (space == "las" || space == "left-anterior-superior") {
    header.fail("space", "got '" + space + "', which is left-handed; allowed: LPS, RAS. Save the file in one of them");
  }
  static const std::vector<std::string> known{"lps", "ras", "left-posterior-superior", "right-anterior-superior"};
  if (std::find(known.begin(), known.end(), space) != known.end()) stated.frame = Frame::lps;
  for (const char* field : {"space units", "units"}) {
    std::string names = header.get({field}).value_or("");
    std::replace(names.begin(), names.end(), '"', ' ');
    std::istringstream words(names);
    for (std::string name; words >> name;) {
      const double unit = length_of(name);
      if (stated.unit > 0 && unit > 0 && unit != stated.unit) header.fail(field, "allowed: one unit for all axes");
      if (unit > 0) stated.unit = unit;
      if (unit == 0 && name.find_first_not_of('?') != std::string::npos && lower(name) != "none")
        stated.unknown_unit = name;
    }
  }
  return stated;
}

StatedSpace check_meta(const Header& header) {
  if (header.need("ndims") != "3") header.fail("NDims", "got " + header.need("ndims") + "; allowed: 3");
  header.check_sizes("dimsize", 3);
  if (header.get({"elementnumberofchannels"}).value_or("1") != "1")
    header.fail("ElementNumberOfChannels", "got " + header.need("elementnumberofchannels") + "; allowed: 1");
  const auto check_count = [&](std::initializer_list<const char*> names, std::size_t count) {
    const auto value = header.get(names);
    if (!value || header.numbers(*names.begin(), *value).size() == count) return;
    header.fail(*names.begin(), "got '" + value->substr(0, 60) + "'; allowed: " + std::to_string(count) + " numbers");
  };
  check_count({"elementspacing", "elementsize"}, 3);
  check_count({"offset", "position", "origin"}, 3);
  check_count({"transformmatrix", "rotation", "orientation"}, 9);
  const std::string file = header.need("elementdatafile");
  if (lower(file) != "local") header.check_data_file("ElementDataFile", file);
  StatedSpace stated;
  stated.voxels = header.voxels(lower(file) == "local" ? std::nullopt : std::optional(file));
  stated.voxels.zlib = lower(header.get({"compresseddata"}).value_or("false")) == "true";
  // ITK's convention is LPS, whatever the letters are; "???" stands for unknown.
  const std::string letters = header.get({"anatomicalorientation"}).value_or("");
  if (letters.size() == 3 && letters != "???") stated.frame = Frame::lps;
  if (const auto unit = header.get({"distanceunits"})) {
    stated.unit = length_of(*unit);
    if (stated.unit == 0 && *unit != "?") stated.unknown_unit = *unit;
  }
  return stated;
}

// Refuses headers that libnifti accepts: places that are no numbers, dimensions out of range, gzip data under a name without
// .gz.
void check_nifti(const std::filesystem::path& file) {
  const auto refuse = [&](const std::string& what) { throw Error(ExitCode::bad_input, file.string() + ": " + what); };
  std::array<unsigned char, 348> head{};
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> stream(gzopen(file.c_str(), "rb"), gzclose);
  if (!stream) throw Error(ExitCode::io, file.string() + ": cannot read the image");
  if (gzread(stream.get(), head.data(), unsigned(head.size())) != int(head.size())) {
    refuse("not a NIfTI file, or cut short: its header takes 348 bytes");
  }
  std::string ending = file.filename().string();
  ending = ending.substr(lower(ending).rfind(".nii"));
  const auto holds = [&](int (*kind)(int)) {
    return std::any_of(ending.begin(), ending.end(), [&](unsigned char c) { return kind(c) != 0; });
  };
  if (holds(std::isupper) && holds(std::islower)) {
    refuse("its name ends in '" + ending + "'; allowed: .nii and .nii.gz, in letters of one case");
  }
  std::int32_t size = 0;
  std::memcpy(&size, head.data(), 4);
  const bool swapped = size == 0x5C010000;
  if (size == 540 || size == 0x1C020000) refuse("is a NIfTI-2 file; allowed: NIfTI-1");
  if (size != 348 && !swapped) refuse("not a NIfTI file: its header does not begin with 348");
  if (std::memcmp(head.data() + 344, "n+1", 3) != 0) refuse("is no single NIfTI file; allowed: .nii and .nii.gz");
  const auto real = [&](std::size_t at) {
    std::array<unsigned char, 4> raw{head[at], head[at + 1], head[at + 2], head[at + 3]};
    if (swapped) std::reverse(raw.begin(), raw.end());
    float number = 0;
    std::memcpy(&number, raw.data(), 4);
    return number;
  };
  const auto check = [&](const char* name, std::size_t from, std::size_t count) {
    for (std::size_t at = from; at < from + 4 * count; at += 4) {
      if (!(std::abs(real(at)) < kLargestNumber)) refuse(std::string(name) + " is not finite or beyond 1e12");
    }
  };
  if (gzdirect(stream.get()) == 0 && lower(file.extension().string()) != ".gz") {
    refuse("is compressed by gzip; its name has to end in .nii.gz");
  }
  const auto dim = [&](std::size_t k) {
    std::array<unsigned char, 2> raw{head[40 + 2 * k], head[41 + 2 * k]};
    if (swapped) std::swap(raw[0], raw[1]);
    std::int16_t n = 0;
    std::memcpy(&n, raw.data(), sizeof n);
    return int(n);
  };
  if (dim(0) < 3 || dim(0) > 7) refuse("has " + std::to_string(dim(0)) + " dimensions; allowed: 3");
  for (std::size_t k = 1; k <= 3; ++k) {
    if (dim(k) < 1) refuse("dim[" + std::to_string(k) + "]: got " + std::to_string(dim(k)) + "; allowed: 1 to 32767");
  }
  check("pixdim", 76, 8);
  constexpr float kFirstVoxel = 352, kLastVoxel = 1 << 30;  // bytes
  if (const float offset = real(108); !(offset >= kFirstVoxel && offset <= kLastVoxel)) {
    std::ostringstream text;
    text << "vox_offset: got " << offset << "; allowed: 352 to 2^30";
    refuse(text.str());
  }
  check("scl_slope", 112, 2);
  check("its quaternion", 256, 6);
  check("its srow matrix", 280, 12);
}

}  // namespace

ImageKind image_kind(const std::filesystem::path& file) {
  const std::string name = lower(file.filename().string());
  const auto ends = [&](const char* extension) { return name.ends_with(extension); };
  if (ends(".nii") || ends(".nii.gz")) return ImageKind::nifti;
  if (ends(".nrrd") || ends(".nhdr")) return ImageKind::nrrd;
  if (ends(".mha") || ends(".mhd")) return ImageKind::meta;
  throw Error(ExitCode::bad_input, file.string() + ": unknown image format '" + file.extension().string() +
                                       "' (allowed: .nii, .nii.gz, .nrrd, .nhdr, .mha, .mhd)");
}

StatedSpace check_header(const std::filesystem::path& file, ImageKind kind) {
  const Header header(file, kind);
  switch (kind) {
    case ImageKind::nrrd:
      return check_nrrd(header);
    case ImageKind::meta:
      return check_meta(header);
    case ImageKind::nifti:
      break;
  }
  check_nifti(file);
  return {Frame::unstated, 1e-3, {}, {file, 0, true, false}};  // the reader delivers millimetres
}

}  // namespace palpate::detail
