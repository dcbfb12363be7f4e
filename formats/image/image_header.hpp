// SPDX-License-Identifier: MIT
// Checks the text header of an NRRD or MetaImage file, and finds the frame and the unit that the header states.
#pragma once

#include "formats/image/image_file.hpp"
#include "formats/scene/scene.hpp"

#include <filesystem>
#include <string>

namespace palpate::detail {

/// The kind by the file's extension. Throws Error(bad_input) that lists the known extensions for another one.
ImageKind image_kind(const std::filesystem::path& file);

/// Contents of a header besides the voxels' frame and type.
struct StatedSpace {
  Frame frame = Frame::unstated;  ///< lps for any frame that ITK turns into LPS
  double unit = 0.0;              ///< m; 0: not stated
  std::string unknown_unit;       ///< stated, but no known length
  VoxelPlace voxels;
};

/// Reads the header alone. Throws Error(io) when a file cannot be read, Error(bad_input) naming file and field for a
/// damaged header, for sizes out of range, and for voxels that lie in several files or in no regular file.
StatedSpace check_header(const std::filesystem::path& file, ImageKind kind);

}  // namespace palpate::detail
