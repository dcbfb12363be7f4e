// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/contact_case.hpp"

#include "formats/io/error.hpp"
#include "precompute/geometry/solids.hpp"

#include <algorithm>
#include <cstdio>

namespace palpate::cli {

namespace {

constexpr double kSiteSpacing = 5e-3;     // m
constexpr double kSitesOverWall = 0.35;   // site spacing over a slab's thickness, at most
constexpr double kPressedShare = 0.75;    // of a slab's half width: tools press in the middle, away from its sharp rim
constexpr double kPinchTolerance = 0.01;  // of a slab's compliance
constexpr double kPinchedDepth = 1.4;  // of the depth: a pinch through a slab as thick as the sphere's radius has 1.28

/// A sphere in the middle of the top of a box of 2 half x 2 half x height (m), whose top lies in z = 0.
ContactCase box_contact(const std::string& name, double half, double height, double radius, double depth,
                        const std::vector<SupportScene>& supports, double friction) {
  ContactCase c;
  char text[200];
  std::snprintf(text, sizeof text, "%s of %.0f x %.0f x %.0f mm, sphere of %.0f mm, %.3g mm deep, friction %.2g",
                name.c_str(), 2e3 * half, 2e3 * half, 1e3 * height, 1e3 * radius, 1e3 * depth, friction);
  c.name = text;
  c.scene.friction = friction;
  c.scene.tools.resize(1);
  c.scene.tools[0].radius = radius;
  c.scene.supports = supports;
  c.scene.sampling.depth = depth;
  c.scene.sampling.spacing = c.scene.sampling.margin_spacing = kSiteSpacing;
  c.body = prepare_body(c.scene, geometry::box_solid({-half, -half, -height}, {half, half, 0}, half, "block"));
  c.tool = tool::make_tool(c.scene.tools[0]);
  c.contacts = {{ContactFrame{}, depth}};
  return c;
}

}  // namespace

ContactCase block_contact(double half, double radius, double depth, double friction) {
  SupportScene bottom;
  bottom.point = {0, 0, -half * (1 - 1e-6)};
  return box_contact("block", half, half, radius, depth, {bottom}, friction);
}

ContactCase slab_contact(double half, double thickness, double radius, double depth) {
  std::vector<SupportScene> sides(4);
  for (std::size_t k = 0; k < sides.size(); ++k) {
    const Eigen::Vector3d out =
        (k % 2 == 0 ? 1.0 : -1.0) * (k < 2 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY());
    sides[k].point = half * (1 - 1e-6) * out;
    sides[k].normal = -out;
  }
  ContactCase c = box_contact("slab held at its sides", half, thickness, radius, depth, sides, 0);
  c.scene.sampling.depth = kPinchedDepth * depth;
  c.scene.sampling.spacing = c.scene.sampling.margin_spacing = std::min(kSiteSpacing, kSitesOverWall * thickness);
  c.scene.compliance.tolerance = kPinchTolerance;
  const double pressed = kPressedShare * half;
  c.scene.sampling.within_box.emplace(Eigen::Vector3d(-pressed, -pressed, -2 * thickness),
                                      Eigen::Vector3d(pressed, pressed, thickness));
  return c;
}

ContactCase scene_contacts(const std::string& scene, int count) {
  return plan_contacts(pipeline::prepare(scene), scene, count);
}

ContactCase plan_contacts(const pipeline::Pipeline& p, const std::string& scene, int count) {
  const bake::Plan plan = bake::make_plan(p.scene, p.body, p.mesh, p.tools);
  ContactCase c{scene, p.scene, p.body, p.tools.at(0), {}};
  std::vector<verify::BenchContact> all;
  for (const PairPlan& pair : plan.pairs) {
    if (pair.tool == 0 && pair.tool_vertex == 0) all.push_back({pair.frame, pair.depth});
  }
  if (all.empty()) throw Error(ExitCode::bad_input, scene + ": its plan has no pair of the first tool's tip");
  const auto wanted = std::min(std::size_t(count), all.size());
  for (std::size_t k = 0; k < wanted; ++k) c.contacts.push_back(all[(2 * k + 1) * all.size() / (2 * wanted)]);
  return c;
}

}  // namespace palpate::cli
