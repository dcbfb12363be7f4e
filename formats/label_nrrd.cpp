// SPDX-License-Identifier: MIT
// NRRD headers, attached or detached (teem.sourceforge.net/nrrd/format.html).
#include "formats/label_header.hpp"

#include <algorithm>
#include <sstream>

namespace palpate::detail {

VoxelData read_nrrd(const std::string& bytes, LabelHeader& header, double unit) {
  if (bytes.compare(0, 4, "NRRD") != 0) header.fail("", "not an NRRD file: it does not begin with NRRD");
  std::size_t at = bytes.find('\n');
  bool ended = false;
  while (at != std::string::npos && !ended) {
    const std::size_t end = bytes.find('\n', at + 1);
    const std::string line =
        trimmed(std::string_view(bytes).substr(at + 1, end == std::string::npos ? end : end - at - 1));
    ended = line.empty() && end != std::string::npos;
    at = end;
    // Comments and key/value pairs say nothing of the voxels.
    if (line.empty() || line.front() == '#' || line.find(":=") != std::string::npos) continue;
    const auto colon = line.find(':');
    if (colon == std::string::npos) header.fail("", beginning(line) + " is not a field of an NRRD header");
    header.set(line.substr(0, colon), trimmed(std::string_view(line).substr(colon + 1)));
  }
  if (header.need({"dimension"}) != "3") header.fail("dimension", "got " + header.need({"dimension"}) + "; allowed 3");
  VoxelData data;
  data.size = header.size("sizes", header.need({"sizes"}));
  if (const auto axes = header.get({"space directions"})) {
    header.set_frame(data, "space directions", header.numbers("space directions", *axes, 9),
                     header.numbers("space origin", header.get({"space origin"}).value_or("0 0 0"), 3), unit);
  } else {
    const auto s = header.numbers("spacings", header.need({"spacings"}), 3);
    header.set_frame(data, "spacings", {s[0], 0, 0, 0, s[1], 0, 0, 0, s[2]}, {0, 0, 0}, unit);
  }
  for (const char* ends : {"axis mins", "axis maxs", "axismins", "axismaxs"}) {
    if (header.get({ends})) header.fail(ends, "not allowed; the place of the voxels is 'space origin'");
  }
  // One unit an axis, in quotes.
  for (const char* field : {"space units", "units"}) {
    std::string names = header.get({field}).value_or("");
    std::replace(names.begin(), names.end(), '"', ' ');
    std::istringstream words(names);
    for (std::string name; words >> name;) header.check_unit(field, name, unit);
  }
  static const std::map<std::string, VoxelType> types{
      {"signed char", VoxelType::int8},    {"int8", VoxelType::int8},
      {"int8_t", VoxelType::int8},         {"uchar", VoxelType::uint8},
      {"unsigned char", VoxelType::uint8}, {"uint8", VoxelType::uint8},
      {"uint8_t", VoxelType::uint8},       {"short", VoxelType::int16},
      {"short int", VoxelType::int16},     {"signed short", VoxelType::int16},
      {"int16", VoxelType::int16},         {"int16_t", VoxelType::int16},
      {"ushort", VoxelType::uint16},       {"unsigned short", VoxelType::uint16},
      {"uint16", VoxelType::uint16},       {"uint16_t", VoxelType::uint16},
      {"int", VoxelType::int32},           {"signed int", VoxelType::int32},
      {"int32", VoxelType::int32},         {"int32_t", VoxelType::int32},
      {"uint", VoxelType::uint32},         {"unsigned int", VoxelType::uint32},
      {"uint32", VoxelType::uint32},       {"uint32_t", VoxelType::uint32}};
  data.type = header.type("type", header.need({"type"}), types);
  const std::string encoding = lower(header.need({"encoding"}));
  data.text = encoding == "ascii" || encoding == "text" || encoding == "txt";
  if (!data.text && encoding != "raw") {
    header.fail("encoding", "got '" + encoding + "'; allowed: raw, ascii (save the image without compression)");
  }
  if (!data.text && size_of(data.type) > 1) {
    const std::string order = lower(header.need({"endian"}));
    if (order != "little" && order != "big") header.fail("endian", "got '" + order + "'; allowed: little, big");
    data.big_endian = order == "big";
  }
  for (const char* skip : {"line skip", "lineskip", "byte skip", "byteskip"}) {
    if (header.get({skip}).value_or("0") != "0") header.fail(skip, "allowed: 0");
  }
  if (const auto file = header.get({"data file", "datafile"})) {
    data.bytes = header.data_beside("data file", *file);
  } else {
    if (!ended) header.fail("", "the header has no end (an empty line), and names no data file");
    data.bytes = at == std::string::npos ? std::string() : bytes.substr(at + 1);
  }
  return data;
}

}  // namespace palpate::detail
