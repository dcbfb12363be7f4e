// SPDX-License-Identifier: MIT
// Root search for the point at which a contact and a spring are in balance.
#pragma once

#include "palpate/math/vec3.hpp"

#include <cmath>

namespace palpate::runtime {

/// Constants of the search for the balance. The figures are trials a tick on a box with a coupling of 500 N/m. The
/// motion is random and touches four fifths of the time.
struct BalanceConstants {
  /// Largest residual over the contact's force: 1.3 trials (1.1 at 1e-2, 1.6 at 1e-4). A hand notices 7 %.
  static constexpr double kForceTolerance = 1e-3;
  /// Largest distance from the balance over the contact's size, for small forces; relative rounding of a position.
  static constexpr double kPositionTolerance = 1e-5, kRounding = 1e-15;
  /// Largest motion of a touching tool in one tick over the contact's size. A contact begins anew beyond 1.
  static constexpr double kMostMotion = 0.5;
  /// Largest step over that without contact, which bounds a slope of wrong sign (1 to 5: the same).
  static constexpr double kMostStep = 1.5;
  /// Factor on a step after a trial without force or with a larger residual (0.25 to 0.7: the same).
  static constexpr double kShorten = 0.5;
  /// Largest correction of the slope by the last tick's force, over the slope: a rotation of the tool may have changed
  /// this force without a translation. 1.6 trials at 0.03, 1.3 from 0.3 on.
  static constexpr double kMostCorrection = 0.3;
};

/// A spring and a damper in one tick, which together are linear: force k (x - goal) on the device.
struct CouplingSpring {
  double damper = 0;     ///< N/m, damping over the time of the tick
  double stiffness = 0;  ///< k (N/m), spring and damper
  Vec3 goal;             ///< m, position of the tool without contact
  [[nodiscard]] Vec3 force(const Vec3& tool) const { return stiffness * (tool - goal); }
};

/// A position of the tool with the contact's force there.
struct BalanceTrial {
  Vec3 tool;           ///< m
  Vec3 force, torque;  ///< N and N m, of the contact on the tool
  Vec3 residual;       ///< N, force of the contact less force of the spring
  [[nodiscard]] bool pushes() const { return dot(force, force) > 0; }
};

/// Searches the position x with F(x) = k (x - goal) by Broyden's quasi-Newton method (Broyden 1965):
///
///     x += (G + k I)^-1 (F(x) - k (x - goal)),      G += (dF + G dx) (-dx)^T / |dx|^2
///
///     F  force of the contact on the tool (N)       G  how F falls as the tool moves (N/m, 3x3)
///
/// G stays from tick to tick, so that most ticks need one trial. The caller evaluates F and passes the trials.
class BalanceSearch {
public:
  /// Starts the search of a tick. `last`: the tool and its force at the end of the last tick. `size` (m): of the
  /// contact. `touching`: the tool touched the body in the last tick.
  void begin(const CouplingSpring& spring, const BalanceTrial& last, double size, bool touching) {
    spring_ = spring;
    start_ = last.tool;
    touching_ = touching;
    reach_ = touching ? BalanceConstants::kMostMotion * size : HUGE_VAL;
    free_ = within_reach(spring.goal);
    tolerance_ = BalanceConstants::kPositionTolerance * size;
    rounding_ = BalanceConstants::kRounding * spring.stiffness * (length(spring.goal) + size);
    base_ = trial(last.tool, last.force, last.torque);
    base_is_new_ = tried_free_ = false;
    shortening_ = 1;
  }

  [[nodiscard]] BalanceTrial trial(const Vec3& tool, const Vec3& force, const Vec3& torque) const {
    return {tool, force, torque, force - spring_.force(tool)};
  }

  /// Returns the first position to try. A free tool starts at the position without contact.
  [[nodiscard]] Vec3 first() const { return touching_ ? within_reach(start_ + step(base_.residual)) : spring_.goal; }

  /// Takes the result of a trial into the slope. Returns true where it shows that the tool is free.
  bool observe(const BalanceTrial& now) {
    const bool at_free = !(length(now.tool - free_) > 0);
    tried_free_ = tried_free_ || at_free;
    if (now.pushes()) update_slope(now);
    return at_free && !now.pushes();
  }

  /// True where the residual is within the tolerances.
  [[nodiscard]] bool balanced(const BalanceTrial& now) const {
    const double position = tolerance_ * std::fmin(spring_.stiffness, slope());
    return length(now.residual) <= BalanceConstants::kForceTolerance * length(now.force) + position + rounding_;
  }

  /// Returns the next position to try, after a trial that is not balanced.
  Vec3 next(const BalanceTrial& now) {
    // A trial without force shows either that the tool is free or that the step was too long.
    if (!now.pushes()) {
      return tried_free_ ? base_.tool + BalanceConstants::kShorten * (now.tool - base_.tool) : free_;
    }
    if (!base_is_new_ || length(now.residual) < length(base_.residual)) {
      base_ = now;
      shortening_ = 1;
    } else {
      shortening_ *= BalanceConstants::kShorten;
    }
    base_is_new_ = true;
    return within_reach(base_.tool + shortening_ * step(base_.residual));
  }

  /// Returns the trial of this tick with the least residual, or null where no trial had a force.
  [[nodiscard]] const BalanceTrial* best() const { return base_is_new_ ? &base_ : nullptr; }
  [[nodiscard]] double rounding() const { return rounding_; }  ///< N, of the spring's force

private:
  [[nodiscard]] Vec3 within_reach(const Vec3& tool) const {
    const Vec3 way = tool - start_;
    const double size = length(way);
    return size > reach_ ? start_ + (reach_ / size) * way : tool;
  }

  void update_slope(const BalanceTrial& now) {
    const Vec3 way = now.tool - base_.tool, change = now.force - base_.force;
    const double size = dot(way, way);
    if (!(size > 0)) return;
    if (!touching_ && !base_is_new_) {
      // A contact that begins has its whole force from the motion -way against the force.
      const Vec3 n = unit(now.force, {});
      const double along = -dot(way, n), rise = length(now.force) / (along > 0 ? along : std::sqrt(size));
      slope_[0] = rise * n.x * n;
      slope_[1] = rise * n.y * n;
      slope_[2] = rise * n.z * n;
      return;
    }
    const Vec3 error{change.x + dot(slope_[0], way), change.y + dot(slope_[1], way), change.z + dot(slope_[2], way)};
    const double most = BalanceConstants::kMostCorrection * slope() * std::sqrt(size);
    if (!base_is_new_ && !(length(error) <= most)) return;
    slope_[0] = slope_[0] - (error.x / size) * way;
    slope_[1] = slope_[1] - (error.y / size) * way;
    slope_[2] = slope_[2] - (error.z / size) * way;
  }

  /// N/m, Frobenius norm of G, which is at least the steepest slope.
  [[nodiscard]] double slope() const {
    return std::sqrt(dot(slope_[0], slope_[0]) + dot(slope_[1], slope_[1]) + dot(slope_[2], slope_[2]));
  }

  /// Returns the step (m) that removes a residual (N), of bounded length.
  [[nodiscard]] Vec3 step(const Vec3& residual) const {
    const double k = spring_.stiffness;
    const Vec3 a = slope_[0] + Vec3{k, 0, 0}, b = slope_[1] + Vec3{0, k, 0}, c = slope_[2] + Vec3{0, 0, k};
    const Vec3 bc = cross(b, c), ca = cross(c, a), ab = cross(a, b);
    const Vec3 way = (1 / dot(a, bc)) * (residual.x * bc + residual.y * ca + residual.z * ab);
    const bool usable = dot(way, residual) > 0 && k * length(way) <= BalanceConstants::kMostStep * length(residual);
    return usable ? way : (1 / k) * residual;
  }

  Vec3 slope_[3];  ///< G, rows
  CouplingSpring spring_;
  Vec3 start_, free_;      ///< m, tool at the last tick; the goal, or the point towards it at reach_
  double reach_ = 0;       ///< m, most that the tool moves in this tick
  double tolerance_ = 0;   ///< m
  double rounding_ = 0;    ///< N
  BalanceTrial base_;      ///< least residual so far, or the end of the last tick
  double shortening_ = 1;  ///< factor on the step
  bool touching_ = false;
  bool base_is_new_ = false;  ///< base_ is a trial of this tick
  bool tried_free_ = false;   ///< free_ was tried
};

}  // namespace palpate::runtime
