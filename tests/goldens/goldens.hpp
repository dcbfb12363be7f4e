// SPDX-License-Identifier: GPL-3.0-or-later
// Stated contacts and deflections of a golden file, and what today's runtime answers to them.
#pragma once

#include <string>
#include <vector>

#include "palpate/contact/bonded_contact.hpp"
#include "palpate/format/open.hpp"
#include "palpate/response/interpolation.hpp"
#include "palpate/shared/compliance.hpp"

namespace palpate::test {

/// A line of a .forces file: a word, the question, "=", the answer. The words:
///
///     force    triangle b0 b1 b2 tool patch w0 w1 w2 dx dy dz = fx fy fz limit
///     spun     triangle b0 b1 b2 tool patch w0 w1 w2 dx dy dz r00 r01 r02 r10 .. r22 = fx fy fz limit
///     distance px py pz = d
///     bonded   triangle b0 b1 b2 tool patch w0 w1 w2 dx dy dz = fx fy fz
///     torque   triangle b0 b1 b2 tool patch w0 w1 w2 dx dy dz rx ry rz = fx fy fz tx ty tz
///
///     compliance triangle b0 b1 b2 triangle b0 b1 b2 = C
///
/// force: the contact (triangle and barycentric weights on the body; tool, tool patch and weights on the tool), the
/// deflection p - c (m), the force on the tool (N) while it sticks, and mu F (N, inf in a frictionless file). A tool
/// with spins has its first. spun: the same with the rotation of the tool (tool frame to body frame). distance: a point
/// (m) and its distance from the contact surface (m), negative inside. bonded: the force on a tool that is bonded.
/// torque: the same for a tool that was rotated by a rotation vector (rad), and its torque about p (N m). compliance:
/// the displacement of the second point by unit forces at the first (m/N, row by row).
struct GoldenLine {
  std::string word;
  std::vector<double> asked, answered;
};

/// The answers of the runtime. Throws std::runtime_error for an unknown line.
inline std::vector<double> answer(const runtime::View& view, const std::string& word,
                                  const std::vector<double>& asked) {
  using runtime::Vec3;
  const auto vec = [&](std::size_t at) { return Vec3{asked.at(at), asked.at(at + 1), asked.at(at + 2)}; };
  if (word == "distance") return {closest_point(view, vec(0)).signed_distance};
  const runtime::BodyPoint at{static_cast<std::uint32_t>(asked.at(0)), {asked.at(1), asked.at(2), asked.at(3)}};
  if (word == "compliance") {
    const runtime::BodyPoint to{static_cast<std::uint32_t>(asked.at(4)), {asked.at(5), asked.at(6), asked.at(7)}};
    const runtime::Matrix3 c = runtime::Compliance(view).between(at, to);
    return {c.row[0].x, c.row[0].y, c.row[0].z, c.row[1].x, c.row[1].y, c.row[1].z, c.row[2].x, c.row[2].y, c.row[2].z};
  }
  const runtime::ToolPoint on_tool{static_cast<std::uint32_t>(asked.at(5)), {asked.at(6), asked.at(7), asked.at(8)}};
  const auto tool = static_cast<std::uint32_t>(asked.at(4));
  if (word == "bonded" || word == "torque") {
    const runtime::BondedResponse<true> response(view, tool, at, on_tool);
    const runtime::BondedForce w = response.at(vec(9), word == "torque" ? vec(12) : Vec3{});
    if (word == "bonded") return {w.force.x, w.force.y, w.force.z};
    return {w.force.x, w.force.y, w.force.z, w.torque.x, w.torque.y, w.torque.z};
  }
  if (word != "force" && word != "spun") throw std::runtime_error("unknown golden line: " + word);
  runtime::Pose pose;
  for (std::size_t k = 0; word == "spun" && k < 9; ++k) pose.rotation[k] = asked.at(12 + k);
  runtime::BlendedResponse<> response;
  response.blend(view, tool, at, on_tool, {1, 0, 0}, word == "spun" ? &pose : nullptr);
  const double depth = -dot(vec(9), response.normal());
  if (!(depth > 0)) return {0, 0, 0, 0};
  const Vec3 f = response.force(vec(9));
  const runtime::ResponseAtDepth terms = response.law().at(depth);
  const double limit = terms.friction_coefficient * terms.normal_force;
  return {f.x, f.y, f.z, view.has(layout::feature_friction) ? limit : HUGE_VAL};
}

}  // namespace palpate::test
