// SPDX-License-Identifier: GPL-3.0-or-later
// Normals of a triangle surface's faces, edges and vertices, for the sign of a distance.
#pragma once

#include "formats/surface/surface.hpp"

#include <array>
#include <vector>

namespace palpate::geometry {

/// Closest point of one triangle, with its barycentric weights; a weight is exactly 0 off its corner.
struct TrianglePoint {
  Eigen::Vector3d point{0, 0, 0};
  Eigen::Vector3d weights{1, 0, 0};
};

/// Closest point of triangle a, b, c to p.
TrianglePoint closest_on_triangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                  const Eigen::Vector3d& c);

/// Unit face normals and angle-weighted pseudo-normals (Baerentzen and Aanaes 2005) of a surface. Vertices
/// at the same coordinates count as one, so a soup of touching triangles is closed here.
class FeatureNormals {
public:
  /// Throws Error(bad_input) on an empty surface, an index out of range or a coordinate that is not finite.
  explicit FeatureNormals(const Surface& surface);

  /// Zero for a triangle without area.
  [[nodiscard]] const Eigen::Vector3d& face(std::int32_t triangle) const { return face_[triangle]; }
  /// Pseudo-normal (not unit) of the feature of `triangle` that carries the weights: face, edge or corner.
  [[nodiscard]] const Eigen::Vector3d& at(std::int32_t triangle, const Eigen::Vector3d& weights) const;
  /// Edges whose two triangles turn by more than `degrees`, by their vertices in `surface`, in a fixed order.
  /// Connected lines of them that are shorter in all than `shortest` (m) are left out: on an organ they are noise.
  [[nodiscard]] std::vector<std::array<std::int32_t, 2>> sharp_lines(const Surface& surface, double degrees,
                                                                     double shortest) const;

private:
  std::vector<Eigen::Vector3d> face_;
  std::vector<std::array<Eigen::Vector3d, 3>> edge_;  // per triangle, edge k opposite to corner k
  std::vector<Eigen::Vector3d> vertex_;               // per welded vertex
  std::vector<std::array<std::int32_t, 3>> corners_;  // per triangle, welded
};

}  // namespace palpate::geometry
