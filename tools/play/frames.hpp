// SPDX-License-Identifier: GPL-3.0-or-later
// The dented body of a played motion as pictures: one GLB file a frame.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "tools/play/motion_file.hpp"
#include "tools/play/play.hpp"

namespace palpate::cli {

struct DentFrames {
  std::filesystem::path folder;       ///< made where it is missing; files frame-00000.glb and so on
  double rate = 30;                   ///< frames a second of the motion
  std::size_t most_vertices = 60000;  ///< of the drawn surface, which is the contact surface with finer triangles
  std::size_t most_frames = 10000;
};

/// Draws the contact surface at even times with runtime::Dent, coloured by its displacement ("displacement", m), by the
/// force and the place of the last row before. Returns the number of frames. Throws Error(bad_input) where the file has
/// no compliance or the motion has too many frames, Error(io) where a file cannot be written.
std::size_t write_frames(const runtime::View& view, std::uint32_t tool, const std::vector<MotionRow>& motion,
                         const std::vector<PlayedRow>& rows, const DentFrames& options);

}  // namespace palpate::cli
