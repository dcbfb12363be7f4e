// SPDX-License-Identifier: MIT
// NIfTI by the format's own library (libnifti). ITK refuses an sform whose inverse is not exact in single precision, a
// third of those with turned axes, and takes no sheared one.
#pragma once

#include "formats/image/image_file.hpp"

namespace palpate::detail {

/// Reads NIfTI-1, plain or gzip, in mm. The header must have passed check_header. The place is that of the sform, or of
/// the qform where there is no sform or the sform leads into a template's space (codes 3 and 4), in LPS. Without either
/// it is the voxels' size alone, in no frame. Throws Error(bad_input) naming the file for an image that is cut short,
/// has more than three dimensions, or holds values which are not whole numbers of 32 bits.
ImageFile read_nifti(const std::filesystem::path& file);

}  // namespace palpate::detail
