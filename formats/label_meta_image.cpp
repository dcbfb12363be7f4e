// SPDX-License-Identifier: MIT
// MetaImage headers: the text before the voxels, and what ITK takes for a field left out.
#include "formats/label_header.hpp"

namespace palpate::detail {

VoxelData read_meta_image(const std::string& bytes, LabelHeader& header, double unit) {
  std::size_t at = 0;
  std::string file;
  while (file.empty()) {
    const std::size_t end = bytes.find('\n', at);
    const std::string line = trimmed(std::string_view(bytes).substr(at, end == std::string::npos ? end : end - at));
    const auto equals = line.find('=');
    if (equals == std::string::npos) {
      if (end == std::string::npos) header.fail("ElementDataFile", "missing");
      if (!line.empty()) header.fail("", beginning(line) + " is not a field of a MetaImage header");
    } else {
      const std::string name = trimmed(std::string_view(line).substr(0, equals));
      const std::string value = trimmed(std::string_view(line).substr(equals + 1));
      if (lower(name) == "elementdatafile") file = value;
      header.set(name, value);
      if (end == std::string::npos && file.empty()) header.fail("ElementDataFile", "missing");
    }
    at = end == std::string::npos ? bytes.size() : end + 1;
  }
  if (header.need({"ndims"}) != "3") header.fail("NDims", "got " + header.need({"ndims"}) + "; allowed 3");
  VoxelData data;
  data.size = header.size("DimSize", header.need({"dimsize"}));
  const auto spacing =
      header.numbers("ElementSpacing", header.get({"elementspacing", "elementsize"}).value_or("1 1 1"), 3);
  auto axes = header.numbers(
      "TransformMatrix", header.get({"transformmatrix", "rotation", "orientation"}).value_or("1 0 0 0 1 0 0 0 1"), 9);
  for (std::size_t k = 0; k < 9; ++k) axes[k] *= spacing[k / 3];
  header.set_frame(data, "TransformMatrix", axes,
                   header.numbers("Offset", header.get({"offset", "position", "origin"}).value_or("0 0 0"), 3), unit);
  if (const auto name = header.get({"distanceunits"})) header.check_unit("DistanceUnits", *name, unit);
  static const std::map<std::string, VoxelType> types{
      {"met_char", VoxelType::int8},     {"met_uchar", VoxelType::uint8}, {"met_short", VoxelType::int16},
      {"met_ushort", VoxelType::uint16}, {"met_int", VoxelType::int32},   {"met_uint", VoxelType::uint32},
      {"met_long", VoxelType::int32},    {"met_ulong", VoxelType::uint32}};
  const auto is = [&](std::initializer_list<const char*> names, const char* otherwise) {
    return lower(header.get(names).value_or(otherwise)) == "true";
  };
  if (is({"compresseddata"}, "False")) header.fail("CompressedData", "allowed: False");
  if (header.get({"elementnumberofchannels"}).value_or("1") != "1")
    header.fail("ElementNumberOfChannels", "allowed: 1");
  if (header.get({"headersize"}).value_or("0") != "0") header.fail("HeaderSize", "allowed: 0");
  data.type = header.type("ElementType", header.need({"elementtype"}), types);
  data.text = !is({"binarydata"}, "True");
  data.big_endian = is({"binarydatabyteordermsb", "elementbyteordermsb"}, "False");
  if (lower(file) == "local") {
    data.bytes = bytes.substr(at);
  } else {
    data.bytes = header.data_beside("ElementDataFile", file);
  }
  return data;
}

}  // namespace palpate::detail
