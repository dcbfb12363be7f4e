// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/solve/reference/together.hpp"

#include "formats/io/error.hpp"
#include "precompute/solve/contact/gates.hpp"
#include "precompute/solve/pair/at_depth.hpp"
#include "precompute/solve/pair/contact_size.hpp"
#include "precompute/solve/push/push.hpp"

#include <cmath>
#include <list>
#include <numeric>
#include <optional>

namespace palpate::solve {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int kAsideSteps = 4;

struct Press {
  std::string cause;             // empty: the forces are valid
  std::vector<Vector3d> forces;  // N, of each pressed place, in its frame
  std::vector<Vector3d> deepest;
  std::vector<std::vector<std::array<double, 2>>> pushed;  // of each place: depths, and forces along n
  std::vector<SurfaceNode> surface;
};

class Tools {
public:
  Tools(const Body& body, const tool::Tool& tool, const tool::ToolVertex& vertex, const TogetherPath& path,
        const PairOptions& options, const mesh::TetMesh& mesh)
      : body_(body), tool_(tool), vertex_(vertex), path_(path), options_(options), mesh_(mesh) {}

  // Tools at the places of these indices. The push moves the first; the others are further parts of its energy. One
  // tool goes on to `deeper` (m) in a last step that only `pushed` holds, if that is more than its depth.
  [[nodiscard]] Press press(const std::vector<std::size_t>& places, double deeper = 0) const {
    Press result;
    const Isometry3d first = tool::touching_pose(vertex_, place(places, 0));
    Push push(body_, mesh_, *tool_.shape, first, {body_.material.young, options_.penalty, options_.tolerance});
    if (!push.held_anywhere()) {
      result.cause = "support: no node of the mesh is held";
      return result;
    }
    const VectorXd rest = push.state().x;
    const double anchors = options_.penalty * body_.material.young / tool::contact_radius(vertex_, path_.depth);
    push.set_anchor_stiffness(anchors);
    std::list<ContactEnergy> others;
    for (std::size_t k = 1; k < places.size(); ++k) {
      others.emplace_back(mesh_, push.fixed(), *tool_.shape, tool::touching_pose(vertex_, place(places, k)),
                          push.contact().offsets());
      others.back().set_anchor_stiffness(anchors);
      push.add(others.back());
    }
    Vector3d down = first.translation();
    for (int step = 1; step <= path_.steps && result.cause.empty(); ++step) {
      const double share = static_cast<double>(step) / path_.steps, depth = path_.depth * share * share;
      const double radius = tool::contact_radius(vertex_, depth);
      const auto lowered = lower([&](const Vector3d& t) { return push.rest_gap(t); }, place(places, 0), depth);
      if (!lowered) return no_surface(result);
      down = *lowered;
      std::size_t k = 1;
      for (ContactEnergy& other : others) {
        const auto also = lower(
            [&](const Vector3d& t) {
              other.set_translation(t);
              return other.gap(rest);
            },
            place(places, k++), depth);
        if (!also) return no_surface(result);
        other.set_translation(*also);
        other.set_penalty(options_.penalty * body_.material.young / radius);
      }
      move(push, down, radius, depth, result);
      record(push, others, places, std::vector<double>(places.size(), depth), result);
    }
    if (!result.cause.empty()) return result;
    result.deepest.push_back(down);
    for (const ContactEnergy& other : others) result.deepest.push_back(other.translation());
    down = lower_by_compression(push, others, places, down, result);
    if (places[0] == 0 && path_.aside > 0) go_aside(push, down, result);
    if (!result.cause.empty()) return result;
    result.surface = surface(rest, push.state().x);
    result.forces.push_back(checked(push, push.report(), place(places, 0), result.cause));
    std::size_t k = 1;
    for (const ContactEnergy& other : others) {
      result.forces.push_back(checked(push, other.report(push.state().x), place(places, k++), result.cause));
    }
    if (deeper > path_.depth) go_deeper(push, places, down, deeper - path_.depth, result);
    return result;
  }

private:
  [[nodiscard]] const ContactFrame& place(const std::vector<std::size_t>& places, std::size_t k) const {
    return path_.places[places[k]];
  }

  void move(Push& push, const Vector3d& to, double radius, double depth, Press& result) const {
    const StepResult step = push.move_to(to, radius, body_.material.young * radius * depth * depth, path_.sticking);
    if (!step.converged) result.cause = step.cause + " at depth " + std::to_string(1e3 * depth) + " mm";
  }

  /// m, by which a contact's penalty is compressed: dE/dF of its energy E ~ F^m, with m = 4/3 for a sphere and 2 for a
  /// flat face.
  [[nodiscard]] double compression(const ContactReport& report, const ContactFrame& frame) const {
    const double force = report.force.dot(frame.n), power = vertex_.flat_radius > 0 ? 2.0 : 4.0 / 3;
    return force > 0 ? power * report.normal_energy / force : 0.0;
  }

  /// Notes the forces of tools whose depths are `depths` and the compression of their penalties.
  void record(const Push& push, const std::list<ContactEnergy>& others, const std::vector<std::size_t>& places,
              const std::vector<double>& depths, Press& result) const {
    result.pushed.resize(places.size());
    const auto add = [&](std::size_t k, const ContactReport& report) {
      result.pushed[k].push_back(
          {depths[k] - compression(report, place(places, k)), report.force.dot(place(places, k).n)});
    };
    add(0, push.report());
    std::size_t k = 1;
    for (const ContactEnergy& other : others) add(k++, other.report(push.state().x));
  }

  /// Lowers all tools by the compression of their penalties, so that their forces are those of tissue pressed to
  /// path_.depth. Returns the translation of the first (m).
  Vector3d lower_by_compression(Push& push, std::list<ContactEnergy>& others, const std::vector<std::size_t>& places,
                                const Vector3d& down, Press& result) const {
    std::vector<double> depths{path_.depth + compression(push.report(), place(places, 0))};
    for (ContactEnergy& other : others) {
      const ContactFrame& frame = place(places, depths.size());
      const double way = compression(other.report(push.state().x), frame);
      other.set_translation(other.translation() - way * frame.n);
      depths.push_back(path_.depth + way);
    }
    const Vector3d lowered = down - (depths[0] - path_.depth) * place(places, 0).n;
    move(push, lowered, tool::contact_radius(vertex_, path_.depth), path_.depth, result);
    record(push, others, places, depths, result);
    return lowered;
  }

  void go_deeper(Push& push, const std::vector<std::size_t>& places, const Vector3d& down, double more,
                 Press& result) const {
    const double depth = path_.depth + compression(push.report(), place(places, 0)) + more;
    move(push, down - more * place(places, 0).n, tool::contact_radius(vertex_, depth), depth, result);
    record(push, {}, places, {depth}, result);
  }

  void go_aside(Push& push, const Vector3d& down, Press& result) const {
    const double radius = tool::contact_radius(vertex_, path_.depth);
    for (int step = 1; step <= kAsideSteps && result.cause.empty(); ++step) {
      move(push, down + (path_.aside * step / kAsideSteps) * path_.places[0].x, radius, path_.depth, result);
    }
  }

  [[nodiscard]] std::vector<SurfaceNode> surface(const VectorXd& rest, const VectorXd& x) const {
    std::vector<char> outside(mesh_.nodes.size());
    for (const auto& face : mesh_.faces) {
      for (const std::int32_t node : face) outside[static_cast<std::size_t>(node)] = 1;
    }
    std::vector<SurfaceNode> nodes;
    for (std::size_t k = 0; k < outside.size(); ++k) {
      const auto at = static_cast<Eigen::Index>(3 * k);
      if (outside[k] != 0) nodes.push_back({rest.segment<3>(at), x.segment<3>(at)});
    }
    return nodes;
  }

  static Press no_surface(Press& result) {
    result.cause = "first touch: the surface is not found along the normal";
    return result;
  }

  std::optional<Vector3d> lower(const std::function<double(const Vector3d&)>& gap, const ContactFrame& frame,
                                double depth) const {
    return at_depth(gap, tool::touching_pose(vertex_, frame).translation(), frame.n, depth, 1e-6 * path_.depth,
                    2 * std::max(vertex_.curvature_radius, path_.depth));
  }

  Vector3d checked(const Push& push, const ContactReport& report, const ContactFrame& frame, std::string& cause) const {
    GateState gate;
    gate.depth = path_.depth;
    gate.contact_radius = tool::contact_radius(vertex_, path_.depth);
    gate.force = report.force.dot(frame.n);
    gate.min_jacobian = push.min_jacobian();
    gate.contact = report;
    if (const auto failed = failed_tangential_gate(gate, -1.0, GateLimits{})) cause = *failed;
    return frame.to_local(report.force);
  }

  const Body& body_;
  const tool::Tool& tool_;
  const tool::ToolVertex& vertex_;
  const TogetherPath& path_;
  const PairOptions& options_;
  const mesh::TetMesh& mesh_;
};

void validate(const TogetherPath& path) {
  const bool aside = path.aside == 0 || (path.aside > 0 && path.sticking);
  if (path.depth > 0 && std::isfinite(path.depth + path.aside + path.alone_depth) && !path.places.empty() &&
      path.steps >= 1 && aside) {
    return;
  }
  throw Error(ExitCode::usage, "tools together: depth " + std::to_string(path.depth) + " m, " +
                                   std::to_string(path.places.size()) + " places, " + std::to_string(path.steps) +
                                   " steps, " + std::to_string(path.aside) +
                                   " m aside; allowed > 0, >= 1, >= 1, and >= 0 where the contacts stick, else 0");
}

}  // namespace

TogetherResult solve_together(const Body& body, const tool::Tool& tool, const tool::ToolVertex& vertex,
                              const TogetherPath& path, const PairOptions& options) {
  validate(path);
  TogetherResult result;
  if (body.prestress.any()) {
    result.cause = "prestress: tools together are solved of bodies without prestress only";
    return result;
  }
  const ContactFrame& first = path.places.front();
  std::vector<Vector3d> further;
  for (std::size_t k = 1; k < path.places.size(); ++k) further.push_back(path.places[k].origin - first.origin);
  if (path.aside > 0) further.push_back(path.aside * first.x);
  const mesh::SizeField size = contact_size({body, tool, vertex, first}, path.depth, options.refine, options, further);
  const mesh::VolumeMeshResult mesh = mesh::mesh_volume(body, size, {first.origin}, options.mesh);
  if (!mesh.usable) {
    result.cause = "mesh: " + mesh.cause;
    return result;
  }
  result.nodes = static_cast<std::uint32_t>(mesh.mesh.nodes.size());
  try {
    const Tools tools(body, tool, vertex, path, options, mesh.mesh);
    std::vector<std::size_t> all(path.places.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    for (const std::size_t k : all) {
      const Press one = tools.press({k}, path.alone_depth);
      if (result.cause.empty()) result.cause = one.cause;
      if (!result.cause.empty()) return result;
      result.pushed_alone.push_back(one.pushed.front());
      result.alone.push_back(one.forces.front());
    }
    const Press together = tools.press(all);
    result.cause = together.cause;
    result.together = together.forces;
    result.deepest = together.deepest;
    result.pushed_together = together.pushed;
    result.surface = together.surface;
  } catch (const Error& e) {
    result.cause = e.what();
  }
  if (!result.cause.empty()) return result;
  double sum = 0, less = 0;
  for (std::size_t k = 0; k < path.places.size(); ++k) {
    sum += result.alone[k].z();
    less += result.alone[k].z() - result.together[k].z();
  }
  result.difference = less / sum;
  result.usable = true;
  return result;
}

}  // namespace palpate::solve
