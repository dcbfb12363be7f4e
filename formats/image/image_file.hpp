// SPDX-License-Identifier: MIT
// One image file as plain arrays.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace palpate::detail {

enum class ImageKind { nifti, nrrd, meta };

/// Places of the voxels.
struct VoxelPlace {
  std::filesystem::path file;
  std::size_t offset = 0;  ///< bytes before them
  bool gzip = false, zlib = false;
};

struct ImageFile {
  std::array<int, 3> size{};
  int layers = 1;                  ///< numbers a voxel
  std::array<double, 3> origin{};  ///< file units, centre of the first voxel; LPS where the file states a frame
  std::array<std::array<double, 3>, 3> axes{};  ///< file units: from one voxel to the next along each index
  bool states_frame = false;                    ///< NIfTI: its qform or sform code says what the coordinates are
  std::vector<std::int32_t> values;             ///< layers of a voxel side by side; the first index runs fastest
  std::map<std::string, std::string> texts;     ///< key and value pairs of the header
};

/// Largest number of values of an image: 2 GiB as 32-bit numbers.
inline constexpr std::size_t largest_image = std::size_t{1} << 29U;

}  // namespace palpate::detail
