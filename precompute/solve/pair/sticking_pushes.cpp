// SPDX-License-Identifier: GPL-3.0-or-later
// Tangential pushes of a contact that sticks, from points of the normal indentation.
#include "precompute/solve/contact/gates.hpp"
#include "precompute/solve/pair/error_estimate.hpp"
#include "precompute/solve/pair/pair_run.hpp"

#include <algorithm>
#include <optional>

namespace palpate::solve {
namespace {

using Eigen::Vector3d;

class StickingPushes {
public:
  explicit StickingPushes(PairRun& run)
      : run_(run),
        path_(run.path),
        moved_(std::size_t(path_.tangential_directions) * std::size_t(path_.tangential_points)) {}

  bool solve() {
    std::uint16_t index = 0;
    for (const double wanted : path_.tangential_depths) {
      const CurvePoint& at = run_.point_from(wanted);
      for (int d = 0; d < path_.tangential_directions; ++d) {
        run_.push.restore(at.state);
        if (path_.form_frictionless) run_.push.stick();
        WayEnergy way(run_.push);
        for (int k = 1; k <= path_.tangential_points; ++k) {
          const auto failure = push_on(at, way, d, k, index++);
          if (!failure) continue;
          if (!run_.stop_short(failure->cause, k == 1, failure->peels)) return false;
          index = static_cast<std::uint16_t>(index + path_.tangential_points - k);
          break;
        }
      }
    }
    return true;
  }

private:
  // Estimates of a tangential push's end, by the same push at the last depth, and by the opposite push at this depth.
  std::vector<Eigen::VectorXd> starts(const CurvePoint& at, double reach, int slot) const {
    std::vector<Eigen::VectorXd> starts;
    if (moved_[slot].size() > 0) starts.emplace_back(at.state.x + reach * moved_[slot]);
    const int half = path_.tangential_directions / 2 * path_.tangential_points;
    if (path_.tangential_directions % 2 == 0 && slot >= half && moved_[slot - half].size() > 0) {
      starts.emplace_back(at.state.x - reach * moved_[slot - half]);
    }
    return starts;
  }

  struct Failure {
    std::string cause;
    bool peels = false;
  };

  // Nothing when the sample was taken.
  std::optional<Failure> push_on(const CurvePoint& at, WayEnergy& way, int direction, int point, std::uint16_t index) {
    const double reach = path_.tangential_reach * at.depth * point / path_.tangential_points;
    const int slot = direction * path_.tangential_points + point - 1;
    const Vector3d local = run_.direction(direction, path_.tangential_directions);
    const Sample base = run_.sample_of(at);
    const StepResult step = run_.move_to(at.state.translation + reach * run_.frame.to_world(local), at.depth, true,
                                         starts(at, reach, slot));
    ++run_.result.outcome.tangential_solves;
    const auto where = " in the tangential push of " + std::to_string(1e3 * reach) + " mm at depth " +
                       std::to_string(1e3 * at.depth) + " mm";
    if (!step.converged) return Failure{step.cause + where, step.peels};
    way.moved();
    moved_[slot] = (run_.push.state().x - at.state.x) / reach;
    Sample s = run_.sample(step.iterations);
    s.kind = SampleKind::tangential;
    s.index = index;
    const double pull = (s.force - base.force).dot(local);
    const GateState gate = run_.tangential_gate(at.depth, s, way);
    if (const auto failed = failed_sticking_gate(gate, pull, GateLimits{})) return Failure{*failed + where};
    // The anchors' own compliance, at a constant contact area: 2 E / Q, E without what the normal indentation had
    // sheared. An answer without a sign (GateLimits::tangential_response) gives no compliance.
    const double sheared = std::max(gate.contact.tangential_energy - at.contact.tangential_energy, 0.0);
    const double give = pull < 0 ? 2 * sheared / -pull : 0.0;
    s.deflection = (reach - std::min(give, 0.1 * reach)) * local + Vector3d(0, 0, base.deflection.z());
    s.error_estimate =
        base.error_estimate + error_estimate({gate.contact.force.norm(), reach, give, step.energy_error,
                                              run_.push.state().penalty * gate.contact.area, s.contact_points});
    run_.result.samples.push_back(s);
    return std::nullopt;
  }

  PairRun& run_;
  const PairPath& path_;
  std::vector<Eigen::VectorXd> moved_;  // by pushes (direction, point) at the last depth, per metre pushed
};

}  // namespace

bool sticking_pushes(PairRun& run) { return StickingPushes(run).solve(); }

}  // namespace palpate::solve
