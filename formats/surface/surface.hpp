// SPDX-License-Identifier: MIT
// An indexed triangle surface with a name for every part it was made of.
#pragma once

#include "formats/scene/frame.hpp"

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace palpate {

/// Triangle soup or mesh. Coordinates in metres, counter-clockwise seen from outside once validated.
struct Surface {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<std::int32_t, 3>> triangles;
  /// Per triangle an index into part_names (the named mesh it came from); same length as triangles.
  std::vector<std::int32_t> parts;
  std::vector<std::string> part_names;
  Frame frame = Frame::unstated;   ///< that the file states
  std::vector<std::string> notes;  ///< what reading it left aside or closed, one line each

  [[nodiscard]] bool empty() const noexcept { return triangles.empty(); }
};

}  // namespace palpate
