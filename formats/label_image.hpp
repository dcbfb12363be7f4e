// SPDX-License-Identifier: MIT
// Reads which voxels of a label image have a value: NRRD (raw or text) and MetaImage (raw).
#pragma once

#include "formats/scene.hpp"

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace palpate {

/// The voxels of one label. Voxel (i, j, k) has its centre at origin + axes (i, j, k).
struct LabelMask {
  std::array<int, 3> size{};         ///< voxels along each index
  Eigen::Vector3d origin{0, 0, 0};   ///< m
  Eigen::Matrix3d axes;              ///< m, columns: from one voxel to the next along each index
  std::vector<std::uint8_t> inside;  ///< 1 where the voxel has the label; the first index runs fastest
  std::size_t count = 0;             ///< of those
};

/// Reads .nrrd, .nhdr, .mha or .mhd: three dimensions, one whole number a voxel, not compressed, at most 2^31 bytes.
/// `source.unit` is the length unit of the file's coordinates, which are taken as they stand (a surface made of the
/// same image lies in the same ones); a header that names another unit is refused.
/// Throws Error(io) when a file cannot be read; Error(bad_input) that names file, field and what is allowed for
/// anything else, and for a label that no voxel has (the message lists labels that there are).
LabelMask read_label_mask(const SurfaceSource& source, int label);

}  // namespace palpate
