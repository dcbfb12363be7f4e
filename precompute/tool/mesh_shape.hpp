// SPDX-License-Identifier: GPL-3.0-or-later
// Signed distance to a closed triangle mesh, smooth enough for a solver that wants its derivatives.
#pragma once

#include "precompute/geometry/query.hpp"
#include "precompute/tool/tool.hpp"

#include <vector>

namespace palpate::tool {

/// Exact distance (bounding-volume tree) away from the surface, with a zero Hessian. Within `rounding` of it at least,
/// and beyond twice of it no more, the exact distances on a lattice of half that spacing, weighted by uniform cubic
/// B-splines: twice differentiable, gradient and Hessian those of the value, flat faces where they are up to about
/// `rounding` from an edge, a sharp convex edge set back as by a radius of half of it, and a ball of radius R smaller
/// by rounding^2 / (12 R). Facets narrower than half the rounding are evened out.
class MeshShape final : public ToolShape {
public:
  /// `rounding` > 0 (m). Throws Error(bad_input) where the lattice would take more than 20 million points.
  MeshShape(const Surface& surface, double rounding);

  [[nodiscard]] DistanceSample distance(const Eigen::Vector3d& point) const override;
  [[nodiscard]] double lower_bound(const Eigen::Vector3d& point) const override;
  [[nodiscard]] bool surely_beyond(const Eigen::Vector3d& point, double gap) const override {
    return lower_bound(point) > gap;
  }
  [[nodiscard]] Eigen::AlignedBox3d bounds() const override { return bounds_; }
  [[nodiscard]] const geometry::SurfaceQuery& query() const { return query_; }

private:
  void fill();
  [[nodiscard]] DistanceSample exact(const Eigen::Vector3d& point, bool inside) const;

  geometry::SurfaceQuery query_;
  Eigen::AlignedBox3d bounds_;
  double spacing_;                        // m, of the lattice
  Eigen::Vector3d origin_{0, 0, 0};       // of the lattice
  std::array<std::ptrdiff_t, 3> size_{};  // points along each axis
  std::vector<double> values_;            // exact distances; far from the surface lower bounds of them
};

}  // namespace palpate::tool
