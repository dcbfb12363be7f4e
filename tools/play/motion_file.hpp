// SPDX-License-Identifier: GPL-3.0-or-later
// A motion of a tool: poses over time, read from CSV.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "palpate/math/pose.hpp"

namespace palpate::cli {

struct MotionRow {
  double time = 0;                      ///< s, strictly ascending
  runtime::Vec3 position;               ///< m, origin of the tool's frame in the body's
  double quaternion[4] = {1, 0, 0, 0};  ///< w, x, y, z; unit, tool to body
};

/// Reads the columns t,x,y,z,qw,qx,qy,qz, with that header. Throws Error(io) when the file cannot be read and
/// Error(bad_input) "file:line: ..." for a wrong header, number, order of time, or a quaternion that is not
/// of length 1 within 1 %.
std::vector<MotionRow> read_motion(const std::filesystem::path& file);

/// Oddity of a motion's numbers, as a hint: places that look like millimetres beside a body of this size and
/// place, times that look like milliseconds. Empty: nothing is. `low` and `high` bound the body (m).
std::string motion_hint(const std::vector<MotionRow>& rows, const runtime::Vec3& low, const runtime::Vec3& high);

/// The pose a share of the way from `a` to `b`; turns at an even rate. share in [0, 1].
runtime::Pose pose_between(const MotionRow& a, const MotionRow& b, double share);

}  // namespace palpate::cli
