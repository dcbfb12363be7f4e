// SPDX-License-Identifier: MIT
// Limits, filters and projections between a contact's force and a device's command.
#pragma once

#include "palpate/math/pose.hpp"

#include <cmath>
#include <tuple>
#include <type_traits>

namespace palpate::runtime {

/// Steps of an OutputChain. step(force, seconds) returns the changed force (or torque) in the device's frame. `seconds`
/// is the time since the last call, above 0. Every step returns zero for zero once its transient is over. validate()
/// returns null, or the parameter that is wrong. reset() ends the transient. No step allocates.
namespace output {

/// True where the length is 1 within 5e-4, the tolerance of a Pose's axes.
inline bool is_unit(const Vec3& direction) { return std::fabs(dot(direction, direction) - 1) < 1e-3; }

/// Limits the magnitude and keeps the direction.
struct Limit {
  double most;  ///< largest magnitude, at least 0
  [[nodiscard]] const char* validate() const { return most >= 0 ? nullptr : "force limit is outside [0, inf]"; }
  Vec3 operator()(const Vec3& force, double /*seconds*/) const {
    const double size = length(force);
    return size > most ? (most / size) * force : force;
  }
  void reset() {}
};

/// Limits the rate of change. The output moves straight towards the input.
struct RateLimit {
  double most;  ///< largest change in a second, above 0
  [[nodiscard]] const char* validate() const { return most > 0 ? nullptr : "rate limit is outside (0, inf]"; }
  Vec3 operator()(const Vec3& force, double seconds) {
    const double size = length(force - last), allowed = most * seconds;
    return last = size > allowed ? last + (allowed / size) * (force - last) : force;
  }
  void reset() { last = {}; }
  Vec3 last{};
};

/// First-order low-pass filter. The cut-off does not depend on the tick rate, if that is much faster.
struct LowPass {
  double frequency;  ///< Hz, cut-off (-3 dB), above 0
  [[nodiscard]] const char* validate() const {
    return frequency > 0 ? nullptr : "cut-off frequency of the low-pass is outside (0, inf] Hz";
  }
  Vec3 operator()(const Vec3& force, double seconds) {
    const Vec3 change = force - last;
    const bool settled = !(dot(change, change) > kSettled * kSettled);
    return last = settled ? force : last + (1 - std::exp(-kFullTurn * frequency * seconds)) * change;
  }
  void reset() { last = {}; }
  Vec3 last{};
  /// Distance at which the output becomes the input. Denormal numbers would be slow.
  static constexpr double kSettled = 1e-12;
};

/// Projects the force on the only actuated direction of a device, such as a cable on a finger.
struct OneAxis {
  Vec3 direction;           ///< unit
  bool pulls_only = false;  ///< forces against the direction become zero
  [[nodiscard]] const char* validate() const {
    return is_unit(direction) ? nullptr : "actuated direction is not of length 1 within 5e-4";
  }
  Vec3 operator()(const Vec3& force, double /*seconds*/) const {
    const double along = dot(force, direction);
    return (pulls_only && along < 0 ? 0 : along) * direction;
  }
  void reset() {}
};

/// Removes the force along the only direction that a device does not actuate.
struct TwoAxes {
  Vec3 free;  ///< unit, the direction without actuator
  [[nodiscard]] const char* validate() const {
    return is_unit(free) ? nullptr : "direction without actuator is not of length 1 within 5e-4";
  }
  Vec3 operator()(const Vec3& force, double /*seconds*/) const { return tangential(force, free); }
  void reset() {}
};

}  // namespace output

/// Applies steps one after the other: OutputChain<output::LowPass, output::Limit> out({80}, {3.0}). OutputChain<> is
/// empty and returns its input. Three cases give zero and reset all steps: a force or position that is not finite, a
/// time that is not above 0, a wrong parameter.
template <class... Steps>
class OutputChain {
public:
  /// Calls with time 0 (a repeated sample) that repeat the last output. The next one gives zero: the clock has stopped.
  static constexpr int kRepeats = 8;

  OutputChain() = default;
  explicit OutputChain(const Steps&... steps) : steps_(steps...) {}

  /// Returns null, or the first wrong parameter.
  [[nodiscard]] const char* validate() const {
    const auto first = [](auto... wrong) {
      const char* result = nullptr;
      return ((result = result ? result : wrong), ..., result);
    };
    return std::apply([&](const auto&... step) { return first(step.validate()...); }, steps_);
  }

  Vec3 operator()(Vec3 force, double seconds) {
    static_assert(!(kTakesPosition<Steps> || ...), "a step takes the position: call with force, seconds, position");
    return (*this)(force, seconds, {});
  }

  /// `position` (m, device frame): of the device in this tick, for steps with step(force, seconds, position).
  Vec3 operator()(Vec3 force, double seconds, const Vec3& position) {
    const bool finite = std::isfinite(dot(force, force) + dot(position, position));
    if (seconds == 0 && finite && repeats_ < kRepeats) return ++repeats_, last_;
    if (!(usable_ && finite && seconds > 0 && std::isfinite(seconds))) return reset(), Vec3{};
    repeats_ = 0;
    std::apply([&](auto&... step) { ((force = call(step, force, seconds, position)), ...); }, steps_);
    return last_ = force;
  }

  /// Resets all steps. The last force counts as zero.
  void reset() {
    std::apply([](auto&... step) { (step.reset(), ...); }, steps_);
    last_ = {};
  }

  /// Returns a step by its type.
  template <class Step>
  [[nodiscard]] const Step& step() const {
    return std::get<Step>(steps_);
  }

private:
  template <class Step>
  static constexpr bool kTakesPosition = std::is_invocable_v<Step&, const Vec3&, double, const Vec3&>;

  template <class Step>
  static Vec3 call(Step& step, const Vec3& force, double seconds, [[maybe_unused]] const Vec3& position) {
    if constexpr (kTakesPosition<Step>) {
      return step(force, seconds, position);
    } else {
      return step(force, seconds);
    }
  }

  std::tuple<Steps...> steps_;
  bool usable_ = validate() == nullptr;
  int repeats_ = 0;  ///< in a row
  Vec3 last_;        ///< last output
};

template <>
class OutputChain<> {
public:
  Vec3 operator()(const Vec3& force, double /*seconds*/, const Vec3& /*position*/ = {}) const { return force; }
  [[nodiscard]] const char* validate() const { return nullptr; }
  void reset() {}
};

}  // namespace palpate::runtime
