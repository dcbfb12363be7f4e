// SPDX-License-Identifier: GPL-3.0-or-later
// Prepared bodies for solver tests, made without files.
#pragma once

#include "precompute/common/body.hpp"
#include "precompute/mesh/surface/remesh.hpp"
#include "tests/support/shapes.hpp"

namespace palpate::test {

/// Holds what lies behind the plane through `point` (m) with `normal`; springs of 1e5 N/m^3.
inline SupportScene half_space(SupportScene::Type type, const Eigen::Vector3d& point, const Eigen::Vector3d& normal) {
  SupportScene s;
  s.kind = SupportScene::Kind::half_space;
  s.type = type;
  s.stiffness = 1e5;
  s.point = point;
  s.normal = normal;
  return s;
}

/// Block of 2 half x 2 half x half (m) with its top face in z = 0, held at the bottom.
inline Body block_body(double half, double young, double poisson) {
  Body body;
  const Surface surface = box_surface({-half, -half, -half}, {half, half, 0});
  body.query = std::make_shared<const geometry::SurfaceQuery>(surface);
  body.base_size = half / 6;
  body.base = mesh::remesh_uniform(surface, body.base_size);
  body.material.young = young;
  body.material.poisson = poisson;
  body.diagonal = 3 * half;
  SupportScene bottom;
  bottom.kind = SupportScene::Kind::half_space;
  bottom.point = {0, 0, -half * (1 - 1e-6)};
  body.supports.push_back(bottom);
  body.support_surfaces.emplace_back();
  return body;
}

}  // namespace palpate::test
