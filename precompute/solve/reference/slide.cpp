// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/solve/reference/slide.hpp"

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

constexpr int kTransition = 6;  // steps of a quarter of the way to full slip; a turn round takes twice as many

void check(const SlidePath& path) {
  const auto within = [](const char* name, double value, bool good, const char* allowed) {
    if (!good || !std::isfinite(value)) {
      throw Error(ExitCode::usage,
                  std::string("slide: ") + name + " is " + std::to_string(value) + "; allowed " + allowed);
    }
  };
  within("depth", path.depth, path.depth > 0, "> 0");
  within("friction", path.friction, path.friction > 0 && path.friction <= 2, "(0, 2]");
  within("length", path.radii, path.radii > 0 && path.radii <= 100, "(0, 100] contact radii");
  within("approach", path.approach, std::abs(path.approach) < 1.5, "(-1.5, 1.5)");
  within("step", path.step, path.step > 0 && path.step <= 1, "(0, 1] contact radii");
  within("press steps", path.press_steps, path.press_steps >= 2 && path.press_steps <= 100, "[2, 100]");
}

class Slide {
public:
  Slide(const ContactCase& contact, const SlidePath& path, const PairOptions& options)
      : contact_(contact),
        path_(path),
        options_(options),
        way_(std::cos(path.angle) * contact.frame.x + std::sin(path.angle) * contact.frame.y),
        radius_(tool::contact_radius(contact.vertex, path.depth)),
        work_scale_(contact.body.material.young * radius_ * path.depth * path.depth) {
    result_.contact_radius = radius_;
  }

  SlideResult run() {
    if (contact_.body.prestress.any()) return refuse("prestress: slides are solved of bodies without prestress only");
    const std::vector<Vector3d> places = places_on_the_way();
    if (!result_.cause.empty()) return result_;
    const mesh::SizeField size = contact_size(contact_, path_.depth, options_.refine, options_, places);
    const mesh::VolumeMeshResult mesh = mesh::mesh_volume(contact_.body, size, {contact_.frame.origin}, options_.mesh);
    if (!mesh.usable) return refuse("mesh: " + mesh.cause);
    result_.nodes = static_cast<std::uint32_t>(mesh.mesh.nodes.size());
    try {
      Push push(contact_.body, mesh.mesh, *contact_.tool.shape, tool::touching_pose(contact_.vertex, contact_.frame),
                {contact_.body.material.young, options_.penalty, options_.tolerance});
      if (!push.held_anywhere()) return refuse("support: no node of the mesh is held");
      CoulombOptions friction;
      friction.coefficient = path_.friction;
      friction.stiffness = options_.penalty * contact_.body.material.young / radius_;
      CoulombPush slip(push, friction);
      if (press(push, slip) && slide(push, slip)) judge();
      result_.factorisations = push.factorisations();
    } catch (const Error& e) {
      return refuse(e.what());
    }
    return result_;
  }

private:
  SlideResult& refuse(const std::string& cause) {
    result_.usable = false;
    result_.cause = cause;
    return result_;
  }

  // From the frame's origin; half a contact radius apart.
  std::vector<Vector3d> places_on_the_way() {
    std::vector<Vector3d> places;
    const int count = static_cast<int>(std::ceil(2 * path_.radii));
    for (int k = 0; k <= count; ++k) {
      const Vector3d over = contact_.frame.origin + path_.radii * radius_ * k / count * way_;
      const Vector3d on = contact_.body.query->closest(over).point;
      // A way that the surface bends away from, or that passes its edge, is not one along it.
      const double off = (on - over).cross(contact_.frame.n).norm();
      const auto where = " at " + std::to_string(1e3 * (over - contact_.frame.origin).norm()) + " mm of the way";
      if (off > radius_) refuse("path: the surface bends away or ends" + where);
      if (contact_.body.held(on)) refuse("path: the surface is held" + where);
      if (k > 0) places.push_back(on - contact_.frame.origin);
    }
    return places;
  }

  // The positions of equilibria: small steps until all slips, so that the transition and its energy are resolved.
  std::vector<double> stations() const {
    std::vector<double> all;
    const double length = path_.radii * radius_, even = path_.step * radius_;
    const double gross = gross_slip_reach(path_.friction, contact_.body.material.poisson) * path_.depth;
    const int most = path_.approach < 0 ? 2 * kTransition : kTransition;
    for (int k = 1; k <= most && k * gross / 4 < std::min(most * even, length); ++k) {
      all.push_back(k * gross / 4);
    }
    const double from = all.empty() ? 0.0 : all.back();
    const int count = std::max(1, static_cast<int>(std::ceil((length - from) / even - 1e-9)));
    for (int k = 1; k <= count; ++k) all.push_back(from + (length - from) * k / count);
    return all;
  }

  std::optional<Vector3d> lower(Push& push, const Vector3d& translation, double depth) const {
    return at_depth([&](const Vector3d& t) { return push.rest_gap(t); }, translation, contact_.frame.n, depth,
                    1e-6 * path_.depth, 2 * std::max(contact_.vertex.curvature_radius, radius_));
  }

  bool press(Push& push, CoulombPush& slip) {
    const auto touch = lower(push, push.state().translation, 0.0);
    if (!touch) return refuse("first touch: the surface is not found along the normal"), false;
    for (int k = 1; k <= path_.press_steps; ++k) {
      const double share = static_cast<double>(k) / path_.press_steps, depth = path_.depth * share * share;
      const Vector3d aside = (depth - path_.depth) * std::tan(path_.approach) * way_;
      const auto target = lower(push, *touch + aside, depth);
      if (!target) return refuse("path: the surface is not found along the normal on the way in"), false;
      const double radius = tool::contact_radius(contact_.vertex, depth);
      const StepResult step = slip.move_to(*target, radius, contact_.body.material.young * radius * depth * depth);
      if (!step.converged)
        return refuse("way in at depth " + std::to_string(1e3 * depth) + " mm: " + step.cause), false;
    }
    slip.open_account();
    return accept(push, slip, 0.0, 0);
  }

  bool slide(Push& push, CoulombPush& slip) {
    const Vector3d start = push.state().translation;
    for (const double travelled : stations()) {
      const auto where = " after " + std::to_string(1e3 * travelled) + " mm of the way";
      Vector3d over = start + travelled * way_;
      over += contact_.frame.n.dot(push.state().translation - over) * contact_.frame.n;
      const auto target = lower(push, over, path_.depth);
      if (!target) return refuse("path: the surface is not found along the normal" + where), false;
      const StepResult step = slip.move_to(*target, radius_, work_scale_);
      if (!step.converged) return refuse(step.cause + where), false;
      if (!accept(push, slip, travelled, step.iterations)) {
        result_.cause += where;
        return false;
      }
    }
    return true;
  }

  // Takes the step where it passes its gates.
  bool accept(Push& push, CoulombPush& slip, double travelled, std::uint32_t iterations) {
    const FrictionReport friction = slip.friction();
    const Vector3d force = slip.force();
    SlideStep s;
    s.travelled = travelled;
    s.force = {-force.dot(way_), force.dot(contact_.frame.n.cross(way_)), force.dot(contact_.frame.n)};
    s.slipping = friction.slipping;
    s.gross = friction.gross();
    s.local_ratio = friction.traction / friction.pressure;
    s.predicted = path_.friction * push.contact().slip_ratio(push.state().x, way_, contact_.frame.n);
    s.work = slip.work();
    s.stored = slip.stored();
    s.dissipated = slip.dissipated();
    s.iterations = iterations;
    GateState gate;
    gate.depth = path_.depth;
    gate.contact_radius = radius_;
    gate.force = s.force.z();
    gate.work = s.work;
    gate.stored = s.stored;
    gate.energy_scale = work_scale_;
    gate.min_jacobian = push.min_jacobian();
    gate.contact = push.report();
    s.points = gate.contact.points;
    // A contact that came in from the side may pull along the way until all of it slips back.
    const double answer = s.gross && travelled > 0 ? -s.force.x() : -1.0;
    if (const auto failed = failed_slip_gate(gate, answer, s.dissipated, GateLimits{})) return refuse(*failed), false;
    result_.steps.push_back(s);
    return true;
  }

  void judge() {
    const std::vector<SlideStep>& steps = result_.steps;
    for (const SlideStep& s : steps) {
      if (!s.gross) {
        result_.gross_at = -1.0;
      } else if (result_.gross_at < 0) {
        result_.gross_at = s.travelled;
      }
    }
    const SlideStep& last = steps.back();
    result_.imbalance = (last.work - last.stored - last.dissipated) / last.work;
    if (result_.gross_at < 0 || result_.gross_at > 0.5 * last.travelled) {
      refuse("gross sliding: all of the contact slips in the last " +
             std::to_string(result_.gross_at < 0 ? 0.0 : 1e3 * (last.travelled - result_.gross_at)) +
             " mm of the way, " + std::to_string(500 * last.travelled) + " wanted");
      return;
    }
    const auto first = std::find_if(steps.begin(), steps.end(),
                                    [&](const SlideStep& s) { return s.travelled >= 0.5 * last.travelled; });
    const double count = static_cast<double>(steps.end() - first);
    for (auto s = first; s != steps.end(); ++s) {
      result_.ratio += s->force.x() / s->force.z() / count;
      result_.local_ratio += s->local_ratio / count;
      result_.predicted += s->predicted / count;
    }
    for (auto s = first; s != steps.end(); ++s) {
      result_.spread = std::max(result_.spread, std::abs(s->force.x() / s->force.z() / result_.ratio - 1));
    }
    result_.usable = true;
  }

  const ContactCase& contact_;
  const SlidePath& path_;
  const PairOptions& options_;
  const Vector3d way_;
  const double radius_, work_scale_;
  SlideResult result_;
};

}  // namespace

SlideResult solve_slide(const ContactCase& contact, const SlidePath& path, const PairOptions& options) {
  check(path);
  return Slide(contact, path, options).run();
}

}  // namespace palpate::solve
