// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/solve/reference/two_tips.hpp"

#include "formats/io/error.hpp"
#include "precompute/solve/contact/gates.hpp"
#include "precompute/solve/pair/at_depth.hpp"
#include "precompute/solve/pair/contact_size.hpp"
#include "precompute/solve/push/push.hpp"

#include <cmath>
#include <optional>

namespace palpate {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

struct Press {
  std::string cause;  // empty: the forces are valid
  Vector3d first{0, 0, 0}, second{0, 0, 0};
  std::vector<std::array<double, 2>> pushed;  // depths, and forces of the first along n
};

class TwoTips {
public:
  TwoTips(const Body& body, const Tool& tool, const ToolVertex& vertex, const ContactFrame& frame,
          const TwoTipsPath& path, const PairOptions& options, const TetMesh& mesh)
      : body_(body), tool_(tool), vertex_(vertex), frame_(frame), path_(path), options_(options), mesh_(mesh) {}

  // A tip at `first`, and one at `second` where there is one (poses of first touch with the body's surface).
  Press press(const Isometry3d& first, const std::optional<Isometry3d>& second) const {
    Press result;
    Push push(body_, mesh_, *tool_.shape, first, {body_.material.young, options_.penalty, options_.tolerance});
    if (!push.held_anywhere()) {
      result.cause = "support: no node of the mesh is held";
      return result;
    }
    const VectorXd rest = push.state().x;
    std::optional<ContactEnergy> other;
    if (second) {
      other.emplace(mesh_, push.fixed(), *tool_.shape, *second);
      push.add(*other);
    }
    for (int k = 1; k <= path_.steps && result.cause.empty(); ++k) {
      const double share = static_cast<double>(k) / path_.steps, depth = path_.depth * share * share;
      const double radius = contact_radius(vertex_, depth);
      const auto down = lower([&](const Vector3d& t) { return push.rest_gap(t); }, first, depth);
      const auto also = second ? lower(
                                     [&](const Vector3d& t) {
                                       other->set_translation(t);
                                       return other->gap(rest);
                                     },
                                     *second, depth)
                               : std::optional<Vector3d>(Vector3d::Zero());
      if (!down || !also) {
        result.cause = "first touch: the surface is not found along the normal";
        return result;
      }
      if (other) {
        other->set_translation(*also);
        other->set_penalty(options_.penalty * body_.material.young / radius);
      }
      const StepResult step = push.move_to(*down, radius, body_.material.young * radius * depth * depth, false);
      if (!step.converged) result.cause = step.cause + " at depth " + std::to_string(1e3 * depth) + " mm";
      result.pushed.push_back({depth, push.report().force.dot(frame_.n)});
    }
    if (!result.cause.empty()) return result;
    result.first = believe(push, push.report(), result.cause);
    if (other && result.cause.empty()) result.second = believe(push, other->report(push.state().x), result.cause);
    return result;
  }

private:
  std::optional<Vector3d> lower(const std::function<double(const Vector3d&)>& gap, const Isometry3d& touch,
                                double depth) const {
    return at_depth(gap, touch.translation(), frame_.n, depth, 1e-6 * path_.depth,
                    2 * std::max(vertex_.curvature_radius, path_.depth));
  }

  Vector3d believe(const Push& push, const ContactReport& report, std::string& cause) const {
    GateState gate;
    gate.depth = path_.depth;
    gate.contact_radius = contact_radius(vertex_, path_.depth);
    gate.force = report.force.dot(frame_.n);
    gate.min_jacobian = push.min_jacobian();
    gate.contact = report;
    if (const auto failed = failed_sideways_gate(gate, -1.0, GateLimits{})) cause = *failed;
    return frame_.to_local(report.force);
  }

  const Body& body_;
  const Tool& tool_;
  const ToolVertex& vertex_;
  const ContactFrame& frame_;
  const TwoTipsPath& path_;
  const PairOptions& options_;
  const TetMesh& mesh_;
};

}  // namespace

TwoTipsResult solve_two_tips(const Body& body, const Tool& tool, const ToolVertex& vertex, const ContactFrame& frame,
                             const TwoTipsPath& path, const PairOptions& options) {
  if (!(path.depth > 0) || !(path.spacing > 0) || !std::isfinite(path.depth + path.spacing + path.angle) ||
      path.steps < 1) {
    throw Error(ExitCode::usage, "two tips: depth " + std::to_string(path.depth) + " m, spacing " +
                                     std::to_string(path.spacing) + " m, steps " + std::to_string(path.steps) +
                                     "; allowed > 0 each");
  }
  TwoTipsResult result;
  if (body.prestress.any()) {
    result.cause = "prestress: two tips are solved of bodies without prestress only";
    return result;
  }
  const Vector3d over = frame.origin + path.spacing * (std::cos(path.angle) * frame.x + std::sin(path.angle) * frame.y);
  const Vector3d beside = body.query->closest(over).point - frame.origin;
  if ((frame.origin + beside - over).cross(frame.n).norm() > contact_radius(vertex, path.depth)) {
    result.cause = "second tip: the surface bends away or ends at " + std::to_string(1e3 * path.spacing) + " mm";
    return result;
  }
  if (body.held(frame.origin + beside)) {
    result.cause = "second tip: the surface is held at " + std::to_string(1e3 * path.spacing) + " mm";
    return result;
  }
  result.beside = beside;
  const SizeField size = contact_size(body, tool, vertex, frame, path.depth, options.refine, options, {beside});
  const VolumeMeshResult mesh = mesh_volume(body, size, {frame.origin}, options.mesh);
  if (!mesh.usable) {
    result.cause = "mesh: " + mesh.cause;
    return result;
  }
  result.nodes = static_cast<std::uint32_t>(mesh.mesh.nodes.size());
  const Isometry3d first = touching_pose(vertex, frame);
  Isometry3d second = first;
  second.translation() += beside;
  try {
    const TwoTips tips(body, tool, vertex, frame, path, options, mesh.mesh);
    const Press one = tips.press(first, std::nullopt), other = tips.press(second, std::nullopt),
                both = tips.press(first, second);
    result.alone = {one.first, other.first};
    result.together = {both.first, both.second};
    result.pushed = one.pushed;
    for (const Press* p : {&one, &other, &both}) {
      if (result.cause.empty()) result.cause = p->cause;
    }
  } catch (const Error& e) {
    result.cause = e.what();
  }
  if (!result.cause.empty()) return result;
  const Vector3d sum = result.alone[0] + result.alone[1];
  result.difference = (sum - result.together[0] - result.together[1]).norm() / sum.norm();
  result.usable = true;
  return result;
}

}  // namespace palpate
