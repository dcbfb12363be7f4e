// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies built by hand, without surface preparation, and size fields round one site.
#pragma once

#include "precompute/common/body.hpp"
#include "precompute/mesh/size_field.hpp"
#include "precompute/mesh/surface/remesh.hpp"
#include "tests/support/shapes.hpp"

#include <algorithm>
#include <memory>

namespace palpate::test {

/// `base_edge` (m) is the edge length of the base surface.
inline Body body_of(const Surface& surface, double base_edge) {
  Body body;
  body.query = std::make_shared<const geometry::SurfaceQuery>(surface);
  body.base = mesh::remesh_uniform(surface, base_edge);
  body.base_size = base_edge;
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& v : surface.vertices) box.extend(v);
  body.diagonal = box.diagonal().norm();
  return body;
}

inline void add_inclusion(Body& body, const Surface& surface, double base_edge) {
  Inclusion inclusion;
  inclusion.name = "lump";
  inclusion.query = std::make_shared<const geometry::SurfaceQuery>(surface);
  inclusion.base = mesh::remesh_uniform(surface, base_edge);
  body.inclusions.push_back(std::move(inclusion));
}

/// h0 at `site`, growing by 0.7 of the distance up to `largest` (m).
inline mesh::SizeField size_round(const Eigen::Vector3d& site, double h0, double largest) {
  return [=](const Eigen::Vector3d& p) { return std::min(largest, h0 + 0.7 * (p - site).norm()); };
}

/// Block of 10 x 10 x 5 R whose top centre is the origin.
inline Body block_body(double r) { return body_of(box_surface({-5 * r, -5 * r, -5 * r}, {5 * r, 5 * r, 0}), 2 * r); }

}  // namespace palpate::test
