// SPDX-License-Identifier: MIT
// From a force of the scene to what a device is told: limits, filters and frames, each present only where it is named.
#pragma once

#include "palpate/math3.hpp"

#include <cmath>
#include <tuple>
#include <type_traits>
#include <utility>

namespace palpate::runtime {

/// Steps take a force or a torque (any unit, the device's frame) and the time since the last one (s, above 0), and give
/// what goes on. None allocates, and each passes zero on as zero once it has come to rest. validate(): null, or what is
/// wrong with its parameters.
namespace output {

/// As far as a Pose's axes may be.
inline bool is_unit(const Vec3& direction) { return std::fabs(dot(direction, direction) - 1) < 1e-3; }

/// No longer than `most`, along the same line.
struct Limit {
  double most;  ///< at least 0
  [[nodiscard]] const char* validate() const { return most >= 0 ? nullptr : "the limit is below 0 or no number"; }
  Vec3 operator()(const Vec3& force, double /*seconds*/) const {
    const double size = length(force);
    return size > most ? (most / size) * force : force;
  }
  void reset() {}
};

/// Changes by no more than `most` in a second, along the straight way to where it should be.
struct RateLimit {
  double most;  ///< above 0
  [[nodiscard]] const char* validate() const { return most > 0 ? nullptr : "the limit of the rate is not above 0"; }
  Vec3 operator()(const Vec3& force, double seconds) {
    const Vec3 change = force - last;
    const double size = length(change), allowed = most * seconds;
    last = size > allowed ? last + (allowed / size) * change : force;
    return last;
  }
  void reset() { last = {}; }
  Vec3 last{};
};

/// First order, 3 dB down at `frequency` (Hz) where ticks are much faster; the same at any rate of ticks.
struct LowPass {
  double frequency;  ///< Hz, above 0
  [[nodiscard]] const char* validate() const {
    return frequency > 0 ? nullptr : "the frequency of the low-pass is not above 0";
  }
  Vec3 operator()(const Vec3& force, double seconds) {
    const Vec3 change = force - last;
    // Arrives where nobody feels a difference: else what is left falls for ever, to numbers that are slow to reckon
    // with.
    last = dot(change, change) > kNothing * kNothing ? last + (1 - std::exp(-kFullTurn * frequency * seconds)) * change
                                                     : force;
    return last;
  }
  void reset() { last = {}; }
  Vec3 last{};
  static constexpr double kNothing = 1e-12;
};

/// What a device with one actuated direction (a cable on a finger) can give: it pulls along `direction` (unit), and
/// with `pulls_only` never pushes back.
struct OneAxis {
  Vec3 direction;
  bool pulls_only = false;
  [[nodiscard]] const char* validate() const {
    return is_unit(direction) ? nullptr : "the actuated direction is no unit vector";
  }
  Vec3 operator()(const Vec3& force, double /*seconds*/) const {
    const double along = dot(force, direction);
    return (pulls_only && along < 0 ? 0 : along) * direction;
  }
  void reset() {}
};

/// What a device with two actuated directions, across the unit vector `free`, can give.
struct TwoAxes {
  Vec3 free;
  [[nodiscard]] const char* validate() const {
    return is_unit(free) ? nullptr : "the direction that is not actuated is no unit vector";
  }
  Vec3 operator()(const Vec3& force, double /*seconds*/) const { return tangential(force, free); }
  void reset() {}
};

}  // namespace output

/// Steps one after the other: Output<output::LowPass, output::Limit> out({80}, {3.0}). Output<> is empty and changes
/// nothing. A force that is not finite, or a time that is not above 0, gives zero and resets every step: nothing of it
/// is remembered. But a time of 0 (a sample that came twice) gives once more what was given, kRepeats times in a row:
/// no time went by, yet a clock that stands still must hold no force. With a step whose parameters are wrong
/// (validate()) there is never a force. Steps that ask for it (passivity.hpp) are given where the device was seen (m,
/// its frame), too: then out(force, seconds, position), where a position that is not finite counts as such a force.
template <class... Steps>
class Output {
public:
  static constexpr int kRepeats = 8;

  Output() = default;
  explicit Output(const Steps&... steps) : steps_(steps...) {}

  /// Null, or what is wrong with the first step of which something is. Asks those that have a validate().
  [[nodiscard]] const char* validate() const {
    return std::apply(
        [](const auto&... step) {
          const char* wrong = nullptr;
          ((wrong = wrong ? wrong : wrong_with(step)), ...);
          return wrong;
        },
        steps_);
  }

  Vec3 operator()(Vec3 force, double seconds) {
    static_assert(!(kWantsPosition<Steps> || ...), "a step asks for the position");
    return (*this)(force, seconds, {});
  }

  Vec3 operator()(Vec3 force, double seconds, const Vec3& position) {
    const bool finite = std::isfinite(dot(force, force) + dot(position, position));
    if (seconds == 0 && finite && repeated_ < kRepeats) {
      ++repeated_;
      return given_;
    }
    if (!(usable_ && finite && seconds > 0 && std::isfinite(seconds))) {
      reset();
      return {};
    }
    repeated_ = 0;
    std::apply([&](auto&... step) { ((force = take(step, force, seconds, position)), ...); }, steps_);
    given_ = force;
    return force;
  }

  /// As if the last force had been zero.
  void reset() {
    std::apply([](auto&... step) { (step.reset(), ...); }, steps_);
    given_ = {};
  }

  /// A step, by its type.
  template <class Step>
  [[nodiscard]] const Step& step() const {
    return std::get<Step>(steps_);
  }

private:
  template <class Step>
  static constexpr bool kWantsPosition = std::is_invocable_v<Step&, const Vec3&, double, const Vec3&>;

  template <class Step>
  static Vec3 take(Step& step, const Vec3& force, double seconds, const Vec3& position) {
    if constexpr (kWantsPosition<Step>) {
      return step(force, seconds, position);
    } else {
      return step(force, seconds);
    }
  }

  template <class Step, class = void>
  struct Checked : std::false_type {};
  template <class Step>
  struct Checked<Step, std::void_t<decltype(std::declval<const Step&>().validate())>> : std::true_type {};

  template <class Step>
  static const char* wrong_with(const Step& step) {
    if constexpr (Checked<Step>::value) {
      return step.validate();
    } else {
      return nullptr;
    }
  }

  std::tuple<Steps...> steps_;
  bool usable_ = validate() == nullptr;
  int repeated_ = 0;  ///< in a row
  Vec3 given_;        ///< in the last tick
};

template <>
class Output<> {
public:
  Vec3 operator()(const Vec3& force, double /*seconds*/, const Vec3& /*position*/ = {}) const { return force; }
  [[nodiscard]] const char* validate() const { return nullptr; }
  void reset() {}
};

/// Where a device sits in the scene: its origin is at `origin` (m, scene), its axes are turned by `turn`, and a metre
/// of the hand is `scale` (above 0) metres of the scene. With `force_scale` (at least 0) the hand feels that many times
/// the force. One that is wrong gives neither force nor torque.
struct DeviceFrame {
  Pose turn;  ///< device to scene; its translation is the origin
  double scale = 1;
  double force_scale = 1;

  /// Null, or what is wrong.
  [[nodiscard]] const char* validate() const {
    if (!turn.valid()) return "the device's place in the scene is no pose";
    if (!(scale > 0 && std::isfinite(scale))) return "the device's scale is not above 0";
    if (!(force_scale >= 0 && std::isfinite(force_scale))) return "the scale of the device's force is below 0";
    return nullptr;
  }

  /// A pose of the device in the scene.
  [[nodiscard]] Pose to_scene(Pose device) const {
    device.translation = scale * device.translation;
    return turn * device;
  }

  /// A force of the scene (N) in the device's frame. With force_scale = scale the hand does the scene's work.
  [[nodiscard]] Vec3 to_device(const Vec3& force) const { return to_device(force, force_scale); }

  /// A torque of the scene (N m) in the device's frame. Angles are the hand's and a lever in its metres is `scale`
  /// times as short, so this is the torque of to_device's forces: else moves and turns one after the other would make
  /// energy.
  [[nodiscard]] Vec3 torque_to_device(const Vec3& torque) const { return to_device(torque, force_scale / scale); }

private:
  [[nodiscard]] Vec3 to_device(const Vec3& v, double times) const {
    return validate() == nullptr ? times * inverse(turn).rotate(v) : Vec3{};
  }
};

}  // namespace palpate::runtime
