// SPDX-License-Identifier: GPL-3.0-or-later
// Prepared bodies for solver tests, made without files.
#pragma once

#include "precompute/body.hpp"
#include "precompute/mesh/remesh.hpp"
#include "tests/support/shapes.hpp"

namespace palpate::test {

/// Block of 2 half x 2 half x half (m) with its top face in z = 0, held at the bottom.
inline Body block_body(double half, double young, double poisson) {
  Body body;
  const Surface surface = box_surface({-half, -half, -half}, {half, half, 0});
  body.query = std::make_shared<const SurfaceQuery>(surface);
  body.base_size = half / 6;
  body.base = remesh_uniform(surface, body.base_size);
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
