// SPDX-License-Identifier: GPL-3.0-or-later
// Points where a vertical line meets a surface from above: the places that the motions probe.
#pragma once

#include "formats/surface/surface.hpp"

#include <optional>
#include <vector>

namespace palpate::synth {

/// A point of a surface and its outward unit normal.
struct Site {
  Eigen::Vector3d point{0, 0, 0};   ///< m
  Eigen::Vector3d normal{0, 0, 1};  ///< interpolated between the vertices' normals
};

/// Looks down on a surface. Keeps a reference to it.
class View {
public:
  explicit View(const Surface& surface);
  /// Highest point of the surface over (x, y); nothing beside the surface.
  [[nodiscard]] std::optional<Site> highest(double x, double y) const;

private:
  const Surface& surface_;
  std::vector<Eigen::Vector3d> normals_;  ///< per vertex
};

}  // namespace palpate::synth
