// SPDX-License-Identifier: MIT
// NRRD and MetaImage by ITK. The implementation alone includes ITK, whose copy of Eigen is not ours.
#pragma once

#include "formats/image/image_file.hpp"

namespace palpate::detail {

/// The header must have passed check_header, which found the voxels. Throws Error(bad_input) naming the file, and ITK's
/// reason, for an image that ITK refuses, that is cut short, or that holds values which are not whole numbers of 32
/// bits.
ImageFile read_by_itk(const std::filesystem::path& file, ImageKind kind, const VoxelPlace& voxels);

}  // namespace palpate::detail
