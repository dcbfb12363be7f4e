// SPDX-License-Identifier: MIT
// Voxels of any integer type in either byte order, or as text.
#include "formats/label_image.hpp"

#include "formats/file.hpp"
#include "formats/label_header.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <set>
#include <string>

namespace palpate {
namespace {

using detail::LabelHeader;
using detail::VoxelData;
using detail::VoxelType;

std::int64_t voxel(const char* at, VoxelType type, bool big_endian) {
  std::uint32_t bits = 0;
  const std::size_t size = size_of(type);
  for (std::size_t k = 0; k < size; ++k) {
    bits |= std::uint32_t(static_cast<unsigned char>(at[big_endian ? size - 1 - k : k])) << (8 * k);
  }
  switch (type) {
    case VoxelType::int8:
      return static_cast<std::int8_t>(bits);
    case VoxelType::int16:
      return static_cast<std::int16_t>(bits);
    case VoxelType::int32:
      return static_cast<std::int32_t>(bits);
    default:
      return bits;
  }
}

// Calls take(value) for every voxel; nothing is set aside for voxels that the file only announces.
template <class Take>
void for_each_voxel(const VoxelData& data, const LabelHeader& header, Take&& take) {
  const std::size_t total = data.count();
  if (!data.text) {
    const std::size_t size = size_of(data.type);
    if (data.bytes.size() != total * size) {
      header.fail("", "its voxels take " + std::to_string(total * size) + " bytes, there are " +
                          std::to_string(data.bytes.size()));
    }
    for (std::size_t k = 0; k < total; ++k) take(voxel(data.bytes.data() + k * size, data.type, data.big_endian));
    return;
  }
  const char *at = data.bytes.data(), *end = at + data.bytes.size();
  std::size_t k = 0;
  for (;; ++k) {
    while (at != end && std::isspace(static_cast<unsigned char>(*at)) != 0) ++at;
    if (at == end) break;
    std::int64_t value = 0;
    const auto [next, code] = std::from_chars(at, end, value);
    if (code != std::errc() || (next != end && std::isspace(static_cast<unsigned char>(*next)) == 0)) {
      header.fail("", "voxel " + std::to_string(k) + " is not a whole number");
    }
    take(value);
    at = next;
  }
  if (k != total) {
    header.fail("", std::to_string(k) + " voxels are there, " + std::to_string(total) + " were announced");
  }
}

}  // namespace

LabelMask read_label_mask(const SurfaceSource& source, int label) {
  const std::string extension = detail::lower(source.file.extension().string());
  const bool nrrd = extension == ".nrrd" || extension == ".nhdr";
  LabelHeader header(source.file);
  if (!nrrd && extension != ".mha" && extension != ".mhd") {
    header.fail("", "unknown image format '" + extension + "' (allowed: .nrrd, .nhdr, .mha, .mhd)");
  }
  const std::string bytes = read_file(source.file, "label image", detail::largest_image);
  const VoxelData data =
      nrrd ? detail::read_nrrd(bytes, header, source.unit) : detail::read_meta_image(bytes, header, source.unit);
  LabelMask mask;
  mask.size = data.size;
  mask.origin = data.origin;
  mask.axes = data.axes;
  mask.inside.reserve(std::min(data.count(), data.bytes.size()));
  std::set<std::int64_t> others;
  constexpr std::size_t kListed = 20;
  for_each_voxel(data, header, [&](std::int64_t value) {
    const bool in = value == label;
    mask.inside.push_back(in ? 1 : 0);
    mask.count += in ? 1 : 0;
    if (!in && others.size() < kListed) others.insert(value);
  });
  if (mask.count == 0) {
    std::string list;
    for (const std::int64_t value : others) list += (list.empty() ? "" : ", ") + std::to_string(value);
    header.fail("", "no voxel has the label " + std::to_string(label) + "; there are: " + list);
  }
  return mask;
}

}  // namespace palpate
