// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/verify/ccx/ccx_case.hpp"

#include "precompute/fem/materials/distortion.hpp"
#include "precompute/fem/materials/invariant_law.hpp"
#include "precompute/geometry/solids.hpp"

#include <fmt/format.h>

#include <numbers>

namespace palpate::verify {
namespace {

using Laws = std::vector<std::shared_ptr<const fem::Law>>;

constexpr double kYoung = 5e3, kRadius = 0.005, kDeepest = 0.4, kHalf = 4 * kRadius;

CcxCase make_case(ToolScene::Shape shape, double share_of_i2, double poisson, int depths) {
  CcxCase c;
  const bool punch = shape == ToolScene::Shape::punch;
  c.name = fmt::format("{}, {}, nu {}", punch ? "punch" : "sphere", share_of_i2 > 0 ? "Mooney-Rivlin" : "neo-Hookean",
                       poisson);
  ToolScene tool;
  tool.shape = shape;
  tool.radius = kRadius;
  if (punch) {
    tool.edge_radius = kRadius / 5;
    // Its rim needs elements far smaller than the contact.
    c.base = std::numbers::sqrt2;
  }
  c.tool = tool::make_tool(tool);

  Scene scene;
  scene.material.young = kYoung;
  scene.material.poisson = poisson;
  SupportScene bottom;
  bottom.point = {0, 0, -kHalf * (1 - 1e-6)};
  scene.supports = {bottom};
  const Eigen::Vector3d low(-kHalf, -kHalf, -kHalf), high(kHalf, kHalf, 0);
  c.body = prepare_body(scene, geometry::box_solid(low, high, kHalf / 2, "block"));
  c.quarter = prepare_body(scene, geometry::box_solid({0, 0, -kHalf}, high, kHalf / 2, "quarter"));

  const double mu = kYoung / (2 * (1 + poisson));
  c.law.c01 = 0.5 * mu * share_of_i2;
  c.law.c10 = 0.5 * mu - c.law.c01;
  c.material = fem::Material::of(
      0, {std::make_shared<fem::Distortion>(2 * c.law.c10, Laws{std::make_shared<fem::SecondInvariant>(c.law.c01)})},
      poisson);
  c.law.bulk = c.material.bulk;
  for (int k = 1; k <= depths; ++k) c.depths.push_back(kDeepest * kRadius * k / depths);
  return c;
}

}  // namespace

std::vector<CcxCase> ccx_cases(int depths) {
  std::vector<CcxCase> cases;
  for (const auto shape : {ToolScene::Shape::sphere, ToolScene::Shape::punch}) {
    for (const double share : {0.0, 0.3}) {
      for (const double poisson : {0.3, 0.45}) cases.push_back(make_case(shape, share, poisson, depths));
    }
  }
  return cases;
}

}  // namespace palpate::verify
