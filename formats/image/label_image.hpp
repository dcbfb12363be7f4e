// SPDX-License-Identifier: MIT
// Label images: NIfTI, NRRD (with Slicer's segments) and MetaImage, and the voxels of some of their labels.
#pragma once

#include "formats/scene/scene.hpp"

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace palpate {

/// A segment that the file names (Slicer's .seg.nrrd).
struct LabelSegment {
  std::string name;
  int layer = 0;           ///< which of the numbers of a voxel holds it
  std::int32_t value = 1;  ///< of its voxels in that layer
};

/// Voxel (i, j, k) has its centre at origin + axes (i, j, k).
struct LabelImage {
  std::filesystem::path file;
  std::array<int, 3> size{};           ///< voxels along each index
  Eigen::Vector3d origin{0, 0, 0};     ///< m
  Eigen::Matrix3d axes;                ///< m, columns: from one voxel to the next along each index
  Frame frame = Frame::unstated;       ///< of origin and axes: LPS, or unstated
  bool states_unit = false;            ///< the file states its unit; else the scene does, or millimetres are taken
  int layers = 1;                      ///< numbers a voxel
  std::vector<LabelSegment> segments;  ///< in the file's order; empty where it names none
  std::vector<std::int32_t> values;    ///< layers of a voxel side by side; the first index runs fastest
};

/// The voxels of one body or region, in a box that holds them all.
struct LabelMask {
  std::array<int, 3> size{};         ///< voxels along each index
  Eigen::Vector3d origin{0, 0, 0};   ///< m
  Eigen::Matrix3d axes;              ///< m, columns: from one voxel to the next along each index
  std::vector<std::uint8_t> inside;  ///< 1 where the voxel belongs to it; the first index runs fastest
  std::size_t count = 0;             ///< of those
  std::vector<std::string> notes;    ///< what was dropped, filled or closed, one line each
};

/// One value of one layer: how many voxels have it and where.
struct LabelExtent {
  std::string name;  ///< of its segment; empty: none
  int layer = 0;
  std::int32_t value = 0;
  std::size_t voxels = 0;
  std::array<int, 3> low{}, high{};  ///< first and last index along each axis
};

/// Reads .nii, .nii.gz, .nrrd, .nhdr, .mha or .mhd: three dimensions (and layers in NRRD), whole numbers of at most 32
/// bits, at most 2^29 of them. `unit` is the length (m) of the file's coordinates; 0: what the file states, else 1 mm.
/// Throws Error(io) when a file cannot be read; Error(bad_input) that names file, field and what is allowed for a
/// damaged or truncated file, a unit that contradicts the file's, and voxels below 5 micrometres.
LabelImage read_label_image(const std::filesystem::path& file, double unit);

/// Every value but 0, by layer, then by value. At most 65536 different ones, else Error(bad_input).
std::vector<LabelExtent> label_extents(const LabelImage& image);

/// Purpose of the mask: a body is one piece, a region may be several.
enum class MaskUse { body, region };

/// The voxels of all the values and segments that `source` names. Islands (over faces) of less than 1 % of the
/// largest are dropped, holes of less than 0.1 % of all voxels are filled; notes report it, and what the image's border
/// cuts. Throws Error(bad_input) for a value or segment that is not there (the message lists those that are), and for a
/// body of several large islands unless `source.islands` says what to keep.
/// `also`: masks of other files whose voxels belong to it as well (a tumour's file beside its organ's). Their voxels
/// must be those of the image, else Error(bad_input).
LabelMask label_mask(const LabelImage& image, const LabelSource& source, MaskUse use,
                     const std::vector<LabelMask>& also = {});

}  // namespace palpate
