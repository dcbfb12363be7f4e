// SPDX-License-Identifier: GPL-3.0-or-later
// One pair from mesh to samples: the ladder of mesh refinements, the normal curve, the sideways pushes.
#include "precompute/solve/pair.hpp"

#include "formats/error.hpp"
#include "precompute/solve/contact_size.hpp"
#include "precompute/solve/gates.hpp"
#include "precompute/solve/push.hpp"
#include "precompute/solve/slip_push.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace palpate {
namespace {

using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;
// How far apart, in contact radii at full depth, the meshes of body and pair may carry a site by prestress.
constexpr double kCarried = 0.5;

// Meshes are made of the body free of stress, whatever it has to bear.
const Body& stress_free(const Body& body) { return body.stress_free ? *body.stress_free : body; }

struct CurvePoint {
  double depth = 0.0;  // m moved by the tool
  ContactReport contact;
  double force = 0.0;  // N along n
  PushState state;
};

// Depth less the penalty's own compliance: d - dE/dF at fixed stiffness, from the local power law
// E k ~ F^m of neighbouring points (4/3 for a sphere, 2 for a constant contact area).
double corrected_depth(const std::vector<CurvePoint>& curve, std::size_t k) {
  const CurvePoint& here = curve[k];
  double m = 4.0 / 3;
  const std::size_t a = k > 0 ? k - 1 : k, b = k > 0 ? k : std::min(k + 1, curve.size() - 1);
  if (a != b && curve[b].force > 1.05 * curve[a].force && curve[a].force > 0) {
    const double ea = curve[a].contact.normal_energy * curve[a].state.penalty;
    const double eb = curve[b].contact.normal_energy * curve[b].state.penalty;
    if (ea > 0 && eb > 0) m = std::clamp(std::log(eb / ea) / std::log(curve[b].force / curve[a].force), 1.0, 2.0);
  }
  return here.depth - m * here.contact.normal_energy / here.force;
}

class PairSolve {
public:
  PairSolve(const Body& body, const Tool& tool, const ToolVertex& vertex, const ContactFrame& frame,
            const PairPath& path, const PairOptions& options)
      : body_(body), tool_(tool), vertex_(vertex), frame_(frame), path_(path), options_(options) {}

  // One attempt; the outcome says whether to try again on a finer mesh. The last attempt keeps what a sideways push
  // answered before it failed.
  PairResult attempt(const TetMesh& mesh, bool last) {
    PairResult result;
    result_ = &result;
    last_ = last;
    result.outcome.nodes = static_cast<std::uint32_t>(mesh.nodes.size());
    try {
      Push push(stress_free(body_), mesh, *tool_.shape, touching_pose(vertex_, frame_),
                {body_.material.young, options_.penalty, options_.tolerance}, options_.materials);
      if (!push.held_anywhere()) return refuse("support: no node of the mesh is held");
      if (body_.prestress.any() && !settle(push, mesh)) return result;
      run(push, path_.normal_depths.back());
      result.outcome.factorisations = push.factorisations();
    } catch (const Error& e) {
      return refuse(e.what());
    }
    return result;
  }

private:
  PairResult& refuse(const std::string& cause) {
    result_->outcome.accepted = false;
    result_->outcome.cause = cause;
    result_->samples.clear();
    return *result_;
  }

  void run(Push& push, double deepest) {
    if (!first_touch(push)) return;
    const bool stick_while_pushing = path_.friction > 0 && !path_.form_frictionless;
    const double full_radius = contact_radius(vertex_, deepest);
    push.set_anchor_stiffness(options_.penalty * body_.material.young / full_radius);
    if (!normal_curve(push, stick_while_pushing)) return;
    if (path_.tangential_directions > 0 && !tangential_pushes(push)) return;
    if (path_.slip_points > 0 && !slipping_pushes(push)) return;
    result_->outcome.accepted = true;
  }

  // Prestress acts before the tool comes near. It carries the site's node a little elsewhere than on the mesh that the
  // site's frame is from: the tool goes for the node.
  bool settle(Push& push, const TetMesh& mesh) {
    if (!body_.stress_free) {
      refuse("prestress: the site is of a surface that has not borne it yet");
      return false;
    }
    const Settled settled = push.settle(std::pow(options_.tolerance, 2) * work_scale(path_.normal_depths.front()));
    if (!settled.reached) {
      refuse("prestress: " + settled.cause);
      return false;
    }
    const Vector3d site = body_.material_point(frame_.origin).point;
    Eigen::Index node = 0;
    for (Eigen::Index k = 1; k < mesh.corner_count; ++k) {
      if ((mesh.nodes[std::size_t(k)] - site).norm() < (mesh.nodes[std::size_t(node)] - site).norm()) node = k;
    }
    carried_ = push.state().x.segment<3>(3 * node) - frame_.origin;
    const double most = kCarried * contact_radius(vertex_, path_.normal_depths.back());
    if (carried_.norm() <= most) return true;
    refuse("prestress: carries the site " + std::to_string(1e3 * carried_.norm()) +
           " mm from where it was found to stand, allowed " + std::to_string(1e3 * most) + " mm");
    return false;
  }

  // The tool starts where it first touches the meshed surface on its way along -n.
  bool first_touch(Push& push) {
    start_ = push.state().translation + carried_;
    const double limit = 2 * std::max(vertex_.curvature_radius, path_.normal_depths.back());
    double lift = 0.0, gap = push.rest_gap(start_);
    const double resolution = 1e-9 + 1e-6 * path_.normal_depths.back();
    while (gap < 0 && lift < limit) {
      lift += std::max(-gap, resolution);
      gap = push.rest_gap(start_ + lift * frame_.n);
    }
    if (gap < 0) {
      refuse("first touch: the tool overlaps the body even when lifted by " + std::to_string(1e3 * lift) + " mm");
      return false;
    }
    for (int k = 0; k < 200 && gap > resolution; ++k) {
      lift -= gap;
      gap = push.rest_gap(start_ + lift * frame_.n);
    }
    if (lift < -limit) {
      refuse("first touch: the surface is " + std::to_string(-1e3 * lift) + " mm beyond the site");
      return false;
    }
    start_ += lift * frame_.n;
    result_->outcome.first_touch = -lift;
    return true;
  }

  double work_scale(double depth) const {
    return body_.material.young * contact_radius(vertex_, depth) * depth * depth;
  }

  bool normal_curve(Push& push, bool sticking) {
    const GateLimits limits;
    double work = 0.0;
    for (const double depth : path_.normal_depths) {
      const double radius = contact_radius(vertex_, depth);
      const StepResult step = push.move_to(start_ - depth * frame_.n, radius, work_scale(depth), sticking);
      ++result_->outcome.normal_solves;
      if (!step.converged) {
        refuse("normal push at depth " + std::to_string(1e3 * depth) + " mm: " + step.cause);
        return false;
      }
      CurvePoint point{depth, push.report(), 0.0, push.state()};
      point.force = point.contact.force.dot(frame_.n);
      const double last_force = curve_.empty() ? 0.0 : curve_.back().force;
      const double last_depth = curve_.empty() ? 0.0 : curve_.back().depth;
      // Too few points to be a resolved contact: not believed, and not an error while it is shallow.
      if (point.contact.points < limits.resolved_points) {
        if (depth < path_.normal_depths.back()) continue;
        refuse("contact resolution: " + std::to_string(point.contact.points) + " points in contact at full depth, " +
               std::to_string(limits.resolved_points) + " wanted");
        return false;
      }
      work += curve_.empty() ? point.force * depth / (vertex_.flat_radius > 0 ? 2.0 : 2.5)
                             : power_law_work(last_depth, last_force, depth, point.force);
      GateState gate{depth,
                     radius,
                     point.force,
                     last_force,
                     work,
                     push.elastic_energy() + point.contact.normal_energy + point.contact.tangential_energy,
                     work_scale(path_.normal_depths.back()),
                     push.min_jacobian(),
                     point.contact};
      if (const auto failed = failed_gate(gate, limits)) {
        refuse(*failed);
        return false;
      }
      curve_.push_back(std::move(point));
      Sample sample = base_sample(push, step.iterations);
      sample.friction_limit = path_.friction > 0 ? path_.friction * slip_ratio(push) : 0.0;
      sample.min_jacobian = gate.min_jacobian;
      sample.index = static_cast<std::uint16_t>(curve_.size() - 1);
      result_->samples.push_back(sample);
    }
    const std::size_t wanted = std::min(limits.curve_points, path_.normal_depths.size());
    if (curve_.size() < wanted) {
      refuse("contact resolution: " + std::to_string(curve_.size()) + " of " +
             std::to_string(path_.normal_depths.size()) + " depths have enough points in contact, " +
             std::to_string(wanted) + " wanted");
      return false;
    }
    for (std::size_t k = 0; k < curve_.size(); ++k) {
      result_->samples[k].deflection = {0, 0, corrected_depth(curve_, k)};
    }
    return true;
  }

  // Integral of the force over the depth, a power law between two points (from zero: Hertz' 3/2, or linear).
  static double power_law_work(double z0, double f0, double z1, double f1) {
    if (!(f1 > 0)) return 0.0;
    const double m = std::log(f1 / f0) / std::log(z1 / z0);
    return std::abs(m + 1) > 1e-6 ? (f1 * z1 - f0 * z0) / (m + 1) : f1 * z1 * std::log(z1 / z0);
  }

  double slip_ratio(const Push& push) const {
    double mean = 0;
    for (int k = 0; k < 8; ++k) {
      const double angle = kPi * k / 4;
      mean +=
          push.contact().slip_ratio(push.state().x, std::cos(angle) * frame_.x + std::sin(angle) * frame_.y, frame_.n) /
          8;
    }
    return mean;
  }

  Sample base_sample(const Push& push, std::uint32_t iterations) const {
    const ContactReport r = push.report();
    Sample s;
    s.force = frame_.to_local(r.force);
    s.contact_area = r.area;
    s.penetration = r.penetration;
    s.min_jacobian = 1.0;
    s.contact_points = r.points;
    s.error_estimate = 1e-3 + 2.0 / std::max<double>(r.points, 1);
    s.iterations = iterations;
    return s;
  }

  // A shallow point may have been too small a contact to believe: then the next deeper one is pushed sideways.
  const CurvePoint& point_from(double wanted) const {
    return *std::find_if(curve_.begin(), curve_.end(),
                         [&](const CurvePoint& p) { return p.depth >= wanted * (1 - 1e-9); });
  }

  bool tangential_pushes(Push& push) {
    std::uint16_t index = 0;
    moved_.resize(std::size_t(path_.tangential_directions) * std::size_t(path_.tangential_points));
    for (const double wanted : path_.tangential_depths) {
      const CurvePoint* const at = &point_from(wanted);
      const Sample base = result_->samples[at - curve_.data()];
      for (int d = 0; d < path_.tangential_directions; ++d) {
        const double angle = path_.tangential_start + 2 * kPi * d / path_.tangential_directions;
        const Vector3d local(std::cos(angle), std::sin(angle), 0);
        push.restore(at->state);
        if (path_.form_frictionless) push.stick();
        for (int k = 1; k <= path_.tangential_points; ++k) {
          const double reach = path_.tangential_reach * at->depth * k / path_.tangential_points;
          const int slot = d * path_.tangential_points + k - 1;
          const auto failure = sideways(push, *at, base, local, reach, slot, index++);
          if (!failure) continue;
          if (k == 1 || !last_) {
            refuse(*failure);
            return false;
          }
          result_->outcome.cause = "stopped short: " + *failure;
          index = static_cast<std::uint16_t>(index + path_.tangential_points - k);
          break;
        }
      }
    }
    return true;
  }

  bool slipping_pushes(Push& push) {
    std::uint16_t index = 0;
    for (const double wanted : path_.tangential_depths) {
      const CurvePoint& at = point_from(wanted);
      SlipPush plan;
      plan.from = at.state;
      plan.depth = at.depth;
      plan.corrected_depth = result_->samples[std::size_t(&at - curve_.data())].deflection.z();
      plan.reach = path_.slip_reach * at.depth;
      plan.points = path_.slip_points;
      plan.contact_radius = contact_radius(vertex_, at.depth);
      plan.work_scale = work_scale(at.depth);
      plan.friction.coefficient = path_.friction;
      plan.friction.stiffness = at.state.penalty;
      plan.sample = [&](std::uint32_t iterations) { return base_sample(push, iterations); };
      for (int d = 0; d < path_.tangential_directions; ++d) {
        const double angle = path_.tangential_start + 2 * kPi * d / path_.tangential_directions;
        plan.direction = std::cos(angle) * frame_.x + std::sin(angle) * frame_.y;
        SlipPushResult slip = slip_push(push, frame_, plan);
        result_->outcome.tangential_solves += slip.solves;
        if (slip.samples.empty() || (!slip.cause.empty() && !last_)) {
          refuse(slip.cause);
          return false;
        }
        if (!slip.cause.empty()) result_->outcome.cause = "stopped short: " + slip.cause;
        for (Sample& s : slip.samples) {
          s.index = static_cast<std::uint16_t>(index + (&s - slip.samples.data()));
          result_->samples.push_back(s);
        }
        index = static_cast<std::uint16_t>(index + path_.slip_points);
      }
    }
    return true;
  }

  // Where a sideways push may end: moved as by the same one at the last depth, or against the opposite one here.
  std::vector<Eigen::VectorXd> sideways_starts(const CurvePoint& at, double reach, int slot) const {
    std::vector<Eigen::VectorXd> starts;
    if (moved_[slot].size() > 0) starts.emplace_back(at.state.x + reach * moved_[slot]);
    const int half = path_.tangential_directions / 2 * path_.tangential_points;
    if (path_.tangential_directions % 2 == 0 && slot >= half && moved_[slot - half].size() > 0) {
      starts.emplace_back(at.state.x - reach * moved_[slot - half]);
    }
    return starts;
  }

  // The cause of a failure, or nothing when the sample was taken. `slot` numbers direction and point.
  std::optional<std::string> sideways(Push& push, const CurvePoint& at, const Sample& base, const Vector3d& local,
                                      double reach, int slot, std::uint16_t index) {
    const Vector3d target = at.state.translation + reach * frame_.to_world(local);
    const StepResult step = push.move_to(target, contact_radius(vertex_, at.depth), work_scale(at.depth), true,
                                         sideways_starts(at, reach, slot));
    ++result_->outcome.tangential_solves;
    const auto where = " in the push of " + std::to_string(1e3 * reach) + " mm sideways at depth " +
                       std::to_string(1e3 * at.depth) + " mm";
    if (!step.converged) return step.cause + where;
    moved_[slot] = (push.state().x - at.state.x) / reach;
    Sample s = base_sample(push, step.iterations);
    s.kind = SampleKind::tangential;
    s.index = index;
    s.min_jacobian = push.min_jacobian();
    const double pull = (s.force - base.force).dot(local);
    GateState gate;
    gate.depth = at.depth;
    gate.contact_radius = contact_radius(vertex_, at.depth);
    gate.force = s.force.z();
    gate.min_jacobian = s.min_jacobian;
    gate.contact = push.report();
    gate.stored = gate.contact.tangential_energy;
    if (const auto failed = failed_sideways_gate(gate, pull, GateLimits{})) return *failed + where;
    // The anchors' own compliance, at a constant contact area: 2 E / Q.
    const double give = 2 * gate.contact.tangential_energy / -pull;
    s.deflection = (reach - std::min(give, 0.1 * reach)) * local + Vector3d(0, 0, base.deflection.z());
    result_->samples.push_back(s);
    return std::nullopt;
  }

  const Body& body_;
  const Tool& tool_;
  const ToolVertex& vertex_;
  const ContactFrame& frame_;
  const PairPath& path_;
  const PairOptions& options_;
  PairResult* result_ = nullptr;
  bool last_ = false;
  Vector3d start_{0, 0, 0};
  Vector3d carried_{0, 0, 0};  // m, by prestress, from the frame's origin
  std::vector<CurvePoint> curve_;
  std::vector<Eigen::VectorXd> moved_;  // by sideways pushes (direction, point) at the last depth, per metre pushed
};

}  // namespace

PairResult solve_on_mesh(const Body& body, const Tool& tool, const ToolVertex& vertex, const ContactFrame& frame,
                         const PairPath& path, const PairOptions& options, const TetMesh& mesh) {
  return PairSolve(body, tool, vertex, frame, path, options).attempt(mesh, true);
}

PairResult solve_pair(const Body& body, const Tool& tool, const ToolVertex& vertex, const ContactFrame& frame,
                      const PairPath& path, const PairOptions& options, const SampleSink& sink) {
  PairResult result;
  std::string causes;
  for (const double scale : {1.0, 0.8, 0.6}) {
    const SizeField size =
        contact_size(body, tool, vertex, frame, path.normal_depths.back(), options.refine * scale, options);
    const Vector3d site = body.material_point(frame.origin).point;
    const VolumeMeshResult mesh = mesh_volume(stress_free(body), size, {site}, options.mesh);
    result = {};
    if (mesh.usable) {
      result = PairSolve(body, tool, vertex, frame, path, options).attempt(mesh.mesh, scale == 0.6);
    } else {
      result.outcome.cause = "mesh: " + mesh.cause;
    }
    if (result.outcome.accepted) break;
    if (!causes.empty()) causes += "; finer: ";
    causes += result.outcome.cause;
  }
  if (!result.outcome.accepted) result.outcome.cause = causes;
  // Samples leave only with a pair that passed: a journal never holds points of an abandoned attempt.
  if (sink) {
    for (const Sample& s : result.samples) sink(s);
  }
  return result;
}

}  // namespace palpate
