// SPDX-License-Identifier: GPL-3.0-or-later
// Vertical ray casting by looking at every triangle: the surfaces here are small.
#include "datasets-synthetic/sites.hpp"

#include <Eigen/Geometry>

namespace palpate::synth {

View::View(const Surface& surface) : surface_(surface), normals_(surface.vertices.size(), Eigen::Vector3d::Zero()) {
  for (const auto& [a, b, c] : surface.triangles) {
    const Eigen::Vector3d& origin = surface.vertices[static_cast<std::size_t>(a)];
    const Eigen::Vector3d normal = (surface.vertices[static_cast<std::size_t>(b)] - origin)
                                       .cross(surface.vertices[static_cast<std::size_t>(c)] - origin);
    for (const std::int32_t v : {a, b, c}) normals_[static_cast<std::size_t>(v)] += normal;
  }
  for (Eigen::Vector3d& normal : normals_) normal.normalize();
}

std::optional<Site> View::highest(double x, double y) const {
  std::optional<Site> best;
  const Eigen::Vector2d place(x, y);
  const auto cross = [](const Eigen::Vector2d& u, const Eigen::Vector2d& v) { return u.x() * v.y() - u.y() * v.x(); };
  for (const auto& triangle : surface_.triangles) {
    std::array<Eigen::Vector3d, 3> corner;
    for (std::size_t k = 0; k < 3; ++k) corner[k] = surface_.vertices[static_cast<std::size_t>(triangle[k])];
    std::array<Eigen::Vector2d, 3> flat;
    for (std::size_t k = 0; k < 3; ++k) flat[k] = corner[k].head<2>() - place;
    const double area = cross(flat[1] - flat[0], flat[2] - flat[0]);
    if (area <= 0) continue;  // seen from below, or on edge
    const Eigen::Vector3d weight(cross(flat[1], flat[2]) / area, cross(flat[2], flat[0]) / area,
                                 cross(flat[0], flat[1]) / area);
    // A little over the rim, so that a line through an edge or a corner is not lost between triangles.
    if (weight.minCoeff() < -1e-9) continue;
    Site site{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
    for (std::size_t k = 0; k < 3; ++k) {
      site.point += weight[static_cast<Eigen::Index>(k)] * corner[k];
      site.normal += weight[static_cast<Eigen::Index>(k)] * normals_[static_cast<std::size_t>(triangle[k])];
    }
    site.normal.normalize();
    if (!best || site.point.z() > best->point.z()) best = site;
  }
  return best;
}

}  // namespace palpate::synth
