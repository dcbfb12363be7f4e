// SPDX-License-Identifier: MIT
#include "device/recording/run_record.hpp"

#include "device/recording/run_hand.hpp"
#include "palpate/format/checksum.hpp"

#include <cstring>

namespace palpate::device {
namespace {

void store(double (&to)[3], const Vec3& v) { to[0] = v.x, to[1] = v.y, to[2] = v.z; }

Vec3 load(const double (&from)[3]) { return {from[0], from[1], from[2]}; }

bool same_bits(const double (&a)[3], const Vec3& v) {
  double b[3];
  store(b, v);
  return std::memcmp(a, b, sizeof b) == 0;
}

bool same_bits(const double (&a)[kFingers], const Pulls& pull) { return std::memcmp(a, pull.data(), sizeof a) == 0; }

template <class T>
std::uint64_t checksum_of(const T& part) {
  return checksum::of(&part, offsetof(T, checksum));
}

}  // namespace

void set_options(RunHeader& header, const SafetyLimits& options, const runtime::DeviceFrame& frame,
                 const std::optional<runtime::CouplingOptions>& coupling) {
  header.rate = options.rate;
  header.limit = options.limit;
  header.torque_limit = options.torque_limit;
  header.ramp_up = options.ramp_up;
  header.ramp_down = options.ramp_down;
  header.stale = options.stale;
  header.gap = options.gap;
  header.silent = options.silent;
  header.missed_share = options.missed_share;
  header.stop_buttons = options.stop_buttons;
  std::memcpy(header.rotation, frame.pose.rotation, sizeof header.rotation);
  store(header.origin, frame.pose.translation);
  header.scale = frame.scale;
  header.force_scale = frame.force_scale;
  if (!coupling) return;
  header.coupling_stiffness = coupling->stiffness;
  header.coupling_damping = coupling->damping;
  header.coupling_trials = static_cast<std::uint32_t>(coupling->trials);
}

SafetyLimits safety_limits(const RunHeader& header) {
  SafetyLimits options;
  options.rate = header.rate;
  options.limit = header.limit;
  options.torque_limit = header.torque_limit;
  options.ramp_up = header.ramp_up;
  options.ramp_down = header.ramp_down;
  options.stale = header.stale;
  options.gap = header.gap;
  options.silent = header.silent;
  options.missed_share = header.missed_share;
  options.stop_buttons = header.stop_buttons;
  return options;
}

runtime::DeviceFrame device_frame(const RunHeader& header) {
  runtime::DeviceFrame frame;
  std::memcpy(frame.pose.rotation, header.rotation, sizeof header.rotation);
  frame.pose.translation = load(header.origin);
  frame.scale = header.scale;
  frame.force_scale = header.force_scale;
  return frame;
}

std::optional<runtime::CouplingOptions> coupling_options(const RunHeader& header) {
  if (header.coupling_stiffness == 0) return std::nullopt;
  runtime::CouplingOptions options;
  options.stiffness = header.coupling_stiffness;
  options.damping = header.coupling_damping;
  options.trials = static_cast<int>(header.coupling_trials);
  return options;
}

RunTick to_tick(const TickInput& seen, const TickOutput& out) noexcept {
  RunTick r;
  r.number = seen.number;
  r.missed = seen.missed;
  r.due = seen.due;
  r.time = seen.time;
  r.seconds = seen.seconds;
  r.sample_time = seen.sample.time;
  std::memcpy(r.rotation, seen.sample.pose.rotation, sizeof r.rotation);
  store(r.position, seen.sample.pose.translation);
  r.sample_number = seen.sample.number;
  r.buttons = seen.sample.buttons;
  r.phase = static_cast<std::uint8_t>(seen.sample.phase);
  r.sample_fault = static_cast<std::uint8_t>(seen.sample.fault);
  r.requests = seen.requests;
  r.mode = static_cast<std::uint8_t>(out.mode);
  r.cause = static_cast<std::uint8_t>(out.cause);
  r.fault = static_cast<std::uint8_t>(out.fault);
  r.usable = out.answer.usable ? 1 : 0;
  r.depth = out.answer.depth;
  store(r.answer_force, out.answer.force);
  store(r.force, out.command.force);
  store(r.torque, out.command.torque);
  std::memcpy(r.hand.joints, seen.sample.joints.data(), sizeof r.hand.joints);
  std::memcpy(r.hand.answer_pull, out.answer.pull.data(), sizeof r.hand.answer_pull);
  std::memcpy(r.hand.pull, out.command.pull.data(), sizeof r.hand.pull);
  return r;
}

TickInput to_input(const RunTick& r) {
  TickInput seen;
  seen.number = r.number;
  seen.missed = r.missed;
  seen.due = r.due;
  seen.time = r.time;
  seen.seconds = r.seconds;
  seen.sample.time = r.sample_time;
  std::memcpy(seen.sample.pose.rotation, r.rotation, sizeof r.rotation);
  seen.sample.pose.translation = load(r.position);
  seen.sample.number = r.sample_number;
  seen.sample.buttons = r.buttons;
  seen.sample.phase = static_cast<Phase>(r.phase);
  seen.sample.fault = static_cast<Fault>(r.sample_fault);
  seen.requests = r.requests;
  std::memcpy(seen.sample.joints.data(), r.hand.joints, sizeof r.hand.joints);
  return seen;
}

bool same_output(const RunTick& r, const TickOutput& out) {
  return same_bits(r.force, out.command.force) && same_bits(r.torque, out.command.torque) &&
         same_bits(r.answer_force, out.answer.force) && same_bits(r.hand.pull, out.command.pull) &&
         same_bits(r.hand.answer_pull, out.answer.pull) && r.mode == static_cast<std::uint8_t>(out.mode) &&
         r.cause == static_cast<std::uint8_t>(out.cause);
}

template <class T>
void seal(T& part) {
  part.checksum = checksum_of(part);
}

template <class T>
bool sealed(const T& part) {
  return part.checksum == checksum_of(part);
}

template void seal(RunHeader&);
template void seal(RunRecord&);
template void seal(RunEnd&);
template void seal(HandRecord&);
template void seal(RunHand&);
template bool sealed(const RunHeader&);
template bool sealed(const RunRecord&);
template bool sealed(const RunEnd&);
template bool sealed(const HandRecord&);
template bool sealed(const RunHand&);

}  // namespace palpate::device
