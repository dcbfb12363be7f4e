// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/solve/reference/stroke.hpp"

#include "formats/io/error.hpp"
#include "precompute/solve/contact/gates.hpp"
#include "precompute/solve/pair/at_depth.hpp"
#include "precompute/solve/pair/contact_size.hpp"
#include "precompute/solve/push/coulomb_push.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace palpate::solve {
namespace {

using Eigen::Vector3d;

constexpr double kPlaces = 0.5;       // contact radii between places that the mesh is refined at
constexpr double kShallowest = 1e-3;  // of the deepest station: less has no contact radius of its own

double deepest(const StrokePath& path) {
  double depth = 0;
  for (const Vector3d& s : path.stations) {
    if (!s.allFinite()) throw Error(ExitCode::usage, "stroke: a station is not a number");
    depth = std::max(depth, -s.z());
  }
  if (!(depth > 0)) throw Error(ExitCode::usage, "stroke: no station is in contact");
  if (!(path.friction > 0 && path.friction <= 2)) {
    throw Error(ExitCode::usage, "stroke: friction is " + std::to_string(path.friction) + "; allowed (0, 2]");
  }
  return depth;
}

class Stroke {
public:
  Stroke(const ContactCase& contact, const StrokePath& path, const PairOptions& options)
      : contact_(contact),
        path_(path),
        options_(options),
        depth_(deepest(path)),
        radius_(tool::contact_radius(contact.vertex, depth_)) {
    result_.contact_radius = radius_;
  }

  StrokeResult run() {
    if (contact_.body.prestress.any()) return refuse("prestress: strokes are solved of bodies without prestress only");
    const std::vector<Vector3d> places = pressed_places();
    if (!result_.cause.empty()) return result_;
    const mesh::SizeField size = contact_size(contact_, depth_, options_.refine, options_, places);
    const mesh::VolumeMeshResult mesh = mesh::mesh_volume(contact_.body, size, {contact_.frame.origin}, options_.mesh);
    if (!mesh.usable) return refuse("mesh: " + mesh.cause);
    result_.nodes = static_cast<std::uint32_t>(mesh.mesh.nodes.size());
    try {
      Push push(contact_.body, mesh.mesh, *contact_.tool.shape, tool::touching_pose(contact_.vertex, contact_.frame),
                {contact_.body.material.young, options_.penalty, options_.tolerance});
      if (!push.held_anywhere()) return refuse("support: no node of the mesh is held");
      const auto touch =
          at_depth([&](const Vector3d& t) { return push.rest_gap(t); }, push.state().translation, contact_.frame.n, 0.0,
                   1e-6 * depth_, 2 * std::max(contact_.vertex.curvature_radius, radius_));
      if (!touch) return refuse("first touch: the surface is not found along the normal");
      CoulombOptions friction;
      friction.coefficient = path_.friction;
      friction.stiffness = options_.penalty * contact_.body.material.young / radius_;
      CoulombPush slip(push, friction);
      result_.usable = draw(push, slip, *touch);
      result_.factorisations = push.factorisations();
    } catch (const Error& e) {
      return refuse(e.what());
    }
    return result_;
  }

private:
  StrokeResult& refuse(const std::string& cause) {
    result_.usable = false;
    result_.cause = cause;
    return result_;
  }

  // On the surface under the stations in contact and the ways between them, from the frame's origin.
  std::vector<Vector3d> pressed_places() {
    std::vector<Vector3d> places;
    Vector3d from(0, 0, 0);
    for (const Vector3d& to : path_.stations) {
      const int count = std::max(1, static_cast<int>(std::ceil((to - from).norm() / (kPlaces * radius_))));
      for (int k = 1; k <= count; ++k) {
        const Vector3d at = from + (to - from) * k / count;
        if (at.z() >= 0) continue;
        const Vector3d on =
            contact_.body.query->closest(contact_.frame.origin + contact_.frame.to_world({at.x(), at.y(), 0})).point;
        if (contact_.body.held(on)) refuse("path: the surface is held under a station");
        const Vector3d place = on - contact_.frame.origin;
        const auto near = [&](const Vector3d& other) { return (other - place).norm() < 0.9 * kPlaces * radius_; };
        if (!near(Vector3d::Zero()) && std::none_of(places.begin(), places.end(), near)) places.push_back(place);
      }
      from = to;
    }
    return places;
  }

  bool draw(Push& push, CoulombPush& slip, const Vector3d& touch) {
    for (const Vector3d& station : path_.stations) {
      const auto where = " at station " + std::to_string(result_.steps.size());
      const Vector3d target = touch + contact_.frame.to_world(station);
      const double overlap = -push.rest_gap(target), depth = std::max(overlap, kShallowest * depth_);
      const double radius = tool::contact_radius(contact_.vertex, depth);
      if (overlap > 0) {
        const StepResult step = slip.move_to(target, radius, contact_.body.material.young * radius * depth * depth);
        if (!step.converged) return refuse(step.cause + where), false;
      } else {
        slip.let_go(target);
      }
      if (const auto failed = accept(push, slip, station, depth, radius)) return refuse(*failed + where), false;
    }
    const StrokeStep& last = result_.steps.back();
    result_.imbalance = (last.work - last.stored - last.dissipated) / most_work_;
    return true;
  }

  // The gate that failed; nothing where the step was taken.
  std::optional<std::string> accept(const Push& push, const CoulombPush& slip, const Vector3d& station, double depth,
                                    double radius) {
    const FrictionReport friction = slip.friction();
    GateState gate;
    gate.contact = push.report();
    StrokeStep s;
    s.station = station;
    s.force = contact_.frame.to_local(slip.force());
    s.points = gate.contact.points;
    s.resolved = s.points >= GateLimits{}.resolved_points;
    s.slipping = friction.slipping;
    s.gross = friction.gross();
    s.work = slip.work();
    s.stored = slip.stored();
    s.dissipated = slip.dissipated();
    most_work_ = std::max(most_work_, s.work);
    gate.depth = depth;
    gate.contact_radius = radius;
    gate.force = s.force.z();
    gate.work = s.work;
    gate.stored = s.stored;
    gate.energy_scale = contact_.body.material.young * radius_ * depth_ * depth_;
    gate.min_jacobian = push.min_jacobian();
    if (auto failed = failed_stroke_gate(gate, most_work_, s.dissipated, GateLimits{})) return failed;
    result_.steps.push_back(s);
    return std::nullopt;
  }

  const ContactCase& contact_;
  const StrokePath& path_;
  const PairOptions& options_;
  const double depth_, radius_;
  double most_work_ = 0.0;
  StrokeResult result_;
};

}  // namespace

StrokeResult solve_stroke(const ContactCase& contact, const StrokePath& path, const PairOptions& options) {
  return Stroke(contact, path, options).run();
}

}  // namespace palpate::solve
