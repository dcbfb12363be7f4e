// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cli/contact_case.hpp"

#include "formats/io/error.hpp"
#include "precompute/geometry/solids.hpp"

#include <algorithm>
#include <cstdio>

namespace palpate::cli {

ContactCase block_contact(double half, double radius, double depth, double friction) {
  ContactCase c;
  char name[160];
  std::snprintf(name, sizeof name, "block of %.0f x %.0f x %.0f mm, sphere of %.0f mm, %.3g mm deep, friction %.2g",
                2e3 * half, 2e3 * half, 1e3 * half, 1e3 * radius, 1e3 * depth, friction);
  c.name = name;
  c.scene.friction = friction;
  c.scene.tools.resize(1);
  c.scene.tools[0].radius = radius;
  SupportScene bottom;
  bottom.point = {0, 0, -half * (1 - 1e-6)};
  c.scene.supports = {bottom};
  c.body = prepare_body(c.scene, box_solid({-half, -half, -half}, {half, half, 0}, half, "block"));
  c.tool = make_tool(c.scene.tools[0]);
  c.contacts = {{ContactFrame{}, depth}};
  return c;
}

ContactCase scene_contacts(const std::string& scene, int count) {
  return plan_contacts(pipeline::prepare(scene), scene, count);
}

ContactCase plan_contacts(const pipeline::Pipeline& p, const std::string& scene, int count) {
  const Plan plan = make_plan(p.scene, p.body, p.mesh, p.tools);
  ContactCase c{scene, p.scene, p.body, p.tools.at(0), {}};
  std::vector<BenchContact> all;
  for (const PairPlan& pair : plan.pairs) {
    if (pair.tool == 0 && pair.tool_vertex == 0) all.push_back({pair.frame, pair.depth});
  }
  if (all.empty()) throw Error(ExitCode::bad_input, scene + ": its plan has no pair of the first tool's tip");
  const auto wanted = std::min(std::size_t(count), all.size());
  for (std::size_t k = 0; k < wanted; ++k) c.contacts.push_back(all[(2 * k + 1) * all.size() / (2 * wanted)]);
  return c;
}

}  // namespace palpate::cli
