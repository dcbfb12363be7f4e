// SPDX-License-Identifier: GPL-3.0-or-later
// Point queries on a triangle surface (CGAL AABB tree behind a narrow header). Safe to share between threads.
#pragma once

#include "formats/surface/surface.hpp"

#include <array>
#include <memory>
#include <optional>
#include <vector>

namespace palpate::geometry {

struct ClosestPoint {
  Eigen::Vector3d point{0, 0, 0};  ///< m, on the surface
  std::int32_t triangle = -1;
  double distance = 0.0;  ///< m, unsigned
};

/// Angle between the normals of two triangles beyond which their edge is sharp (degrees).
inline constexpr double kFeatureAngle = 50.0;
/// Feature lines are connected sharp edges at least this long in all, of the bounding box's diagonal.
inline constexpr double kFeatureLength = 0.25;

class SurfaceQuery {
public:
  explicit SurfaceQuery(const Surface& surface);
  ~SurfaceQuery();
  SurfaceQuery(SurfaceQuery&&) noexcept;
  SurfaceQuery& operator=(SurfaceQuery&&) noexcept;

  [[nodiscard]] const Surface& surface() const noexcept;
  [[nodiscard]] ClosestPoint closest(const Eigen::Vector3d& point) const;
  /// First hit of the ray from `origin` along `direction` (unit) farther than `skip` metres: its distance.
  [[nodiscard]] std::optional<double> ray(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                          double skip) const;
  /// Negative inside a closed surface; magnitude is the distance (m).
  [[nodiscard]] double signed_distance(const Eigen::Vector3d& point) const;
  /// Wall thickness at a surface point: distance to the opposite wall along -normal, the smallest over a
  /// cone of 30 degrees (m); the bounding-box diagonal where nothing is hit.
  [[nodiscard]] double thickness(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const;
  /// Outward normal averaged over the surface within `radius` of `point`, weighted by area and falling off
  /// to the rim; the closest triangle's normal where the radius is 0.
  [[nodiscard]] Eigen::Vector3d normal(const Eigen::Vector3d& point, double radius) const;
  /// Edges of the feature lines, by vertices of surface().
  [[nodiscard]] const std::vector<std::array<std::int32_t, 2>>& feature_edges() const noexcept;
  /// Closest point on the feature lines; none where the surface has none.
  [[nodiscard]] std::optional<Eigen::Vector3d> closest_on_feature(const Eigen::Vector3d& point) const;

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::geometry
