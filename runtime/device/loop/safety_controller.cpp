// SPDX-License-Identifier: MIT
#include "device/loop/safety_controller.hpp"

#include "palpate/output/output_chain.hpp"

#include <cmath>

namespace palpate::device {
namespace {

bool within(double value, double low, double high) { return value >= low && value <= high; }

Vec3 shortened(const Vec3& v, double most) { return runtime::output::Limit{most}(v, 0); }

}  // namespace

const char* SafetyLimits::validate() const {
  constexpr double kLeast = 1e-9;
  if (!within(rate, 100, 10000)) return "the rate is outside 100 to 10000 Hz";
  if (!within(limit, kLeast, 100)) return "the limit of the force is outside 0 to 100 N";
  if (!within(torque_limit, 0, 10)) return "the limit of the torque is outside 0 to 10 N m";
  if (!within(ramp_up, 0.01, 60)) return "the ramp up is outside 0.01 to 60 s";
  if (!within(ramp_down, 0.001, 1)) return "the ramp down is outside 0.001 to 1 s";
  if (!within(stale, kLeast, kStale)) return "the age of a stale sample is outside 0 to 0.01 s";
  if (!within(gap, kLeast, kStale)) return "the longest gap between two ticks is outside 0 to 0.01 s";
  if (gap * rate < 1) return "the longest gap between two ticks is shorter than a period";
  if (!within(silent, 0.01, 60)) return "the time without a usable force is outside 0.01 to 60 s";
  if (!within(missed_share, kLeast, 1)) return "the share of missed deadlines is outside 0 to 1";
  return nullptr;
}

TickOutput SafetyController::step(const TickInput& seen, ForceSource& source) noexcept {
  if (mode_ == Mode::stopped) return stop(seen, cause_);
  if (const Cause end = ends(seen); end != Cause::none) return stop(seen, end);
  if (const Cause wait = holds(seen); wait != Cause::none) return hold(seen, wait, source);

  TickOutput out;
  out.answer = source.answer(seen.sample, seen.seconds);
  if (!out.answer.usable || !finite(out.answer.force) || !finite(out.answer.torque) || !finite(out.answer.pull)) {
    return hold(seen, Cause::source, source);
  }
  held_ = 0;
  const bool stopping = (seen.requests & TickInput::stop) != 0 || mode_ == Mode::stopping;
  share_ += stopping ? -seen.seconds / limits_.ramp_down : seen.seconds / limits_.ramp_up;
  if (stopping && share_ <= 0) return stop(seen, Cause::asked);
  share_ = std::fmin(1, share_);
  mode_ = stopping ? Mode::stopping : share_ < 1 ? Mode::ramping : Mode::engaged;
  out.mode = mode_;
  out.command = {seen.time, share_ * shortened(out.answer.force, limits_.limit),
                 share_ * shortened(out.answer.torque, limits_.torque_limit), limited(out.answer.pull, limits_.limit)};
  for (double& pull : out.command.pull) pull *= share_;
  return out;
}

/// Counted over whole seconds, one after the other.
bool SafetyController::too_many_missed(const TickInput& seen) {
  second_ += seen.seconds;
  if (second_ >= 1) second_ = missed_ = 0;
  missed_ += seen.missed;
  return missed_ > limits_.missed_share * limits_.rate;
}

Cause SafetyController::ends(const TickInput& seen) {
  const bool missed = too_many_missed(seen);
  if ((seen.requests & TickInput::emergency_stop) != 0) return Cause::emergency;
  if ((seen.sample.buttons & limits_.stop_buttons) != 0) return Cause::button;
  if (seen.sample.phase == Phase::stopped || seen.sample.fault != Fault::none) return Cause::device;
  return missed ? Cause::deadlines : Cause::none;
}

// Written so that a NaN is refused.
Cause SafetyController::holds(const TickInput& seen) const {
  constexpr double kClocks = 1e-3;  // s that a sample may come from the future, by clocks of two processors
  if (seen.sample.phase != Phase::ready) return Cause::not_ready;
  const double age = seen.time - seen.sample.time;
  if (!within(age, -kClocks, limits_.stale)) return Cause::stale;
  if (!(seen.seconds > 0 && seen.seconds <= limits_.gap)) return Cause::late;
  return seen.sample.pose.valid() ? Cause::none : Cause::pose;
}

TickOutput SafetyController::stop(const TickInput& seen, Cause cause) {
  if (mode_ != Mode::stopped) fault_ = seen.sample.fault;
  mode_ = Mode::stopped;
  cause_ = cause;
  TickOutput out;
  out.command.time = seen.time;
  out.mode = mode_;
  out.cause = cause_;
  out.fault = fault_;
  return out;
}

TickOutput SafetyController::hold(const TickInput& seen, Cause cause, ForceSource& source) {
  if ((seen.requests & TickInput::stop) != 0 || mode_ == Mode::stopping) return stop(seen, Cause::asked);
  if (mode_ == Mode::ramping || mode_ == Mode::engaged || cause == Cause::source) source.reset();
  if (mode_ != Mode::waiting) {
    mode_ = Mode::suspended;
    held_ = cause == Cause::not_ready ? 0 : held_ + seen.seconds;
    if (!(held_ <= limits_.silent)) return stop(seen, cause);
  }
  share_ = 0;
  TickOutput out;
  out.command.time = seen.time;
  out.mode = mode_;
  out.cause = cause;
  return out;
}

const char* name(Mode mode) {
  switch (mode) {
    case Mode::waiting:
      return "waiting";
    case Mode::ramping:
      return "ramping";
    case Mode::engaged:
      return "engaged";
    case Mode::suspended:
      return "suspended";
    case Mode::stopping:
      return "stopping";
    case Mode::stopped:
      return "stopped";
  }
  return "unknown";
}

const char* name(Cause cause) {
  switch (cause) {
    case Cause::none:
      return "none";
    case Cause::not_ready:
      return "the device is not ready";
    case Cause::stale:
      return "the sample is stale";
    case Cause::late:
      return "the tick is late";
    case Cause::pose:
      return "the device's pose is none";
    case Cause::source:
      return "the force is not usable";
    case Cause::asked:
      return "stop requested";
    case Cause::emergency:
      return "emergency stop";
    case Cause::button:
      return "emergency stop on the device";
    case Cause::device:
      return "the device stopped";
    case Cause::deadlines:
      return "too many deadlines missed";
  }
  return "unknown";
}

}  // namespace palpate::device
