// SPDX-License-Identifier: MIT
#include "device/open_link/open_link_protocol.hpp"

#include "palpate/output/output_chain.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::device {

using namespace openlink;

namespace {

Request write(const Frame& frame) {
  Request request;
  request.kind = Request::Kind::write;
  std::copy_n(frame.bytes, frame.size(), request.bytes);
  request.size = static_cast<std::uint8_t>(frame.size());
  return request;
}

Request nothing(double until) {
  Request request;
  request.until = until;
  return request;
}

Vec3 vector(const float (&v)[3]) { return {v[0], v[1], v[2]}; }

// No longer than `most`, along what is driven alone; zero where it is no number.
void limit(const Vec3& v, double most, unsigned axes, float (&out)[3]) {
  const Vec3 driven{(axes & 1U) != 0 ? v.x : 0, (axes & 2U) != 0 ? v.y : 0, (axes & 4U) != 0 ? v.z : 0};
  if (!finite(driven)) return;
  const Vec3 held = runtime::output::Limit{most}(driven, 0);
  out[0] = static_cast<float>(held.x);
  out[1] = static_cast<float>(held.y);
  out[2] = static_cast<float>(held.z);
}

double dot4(const float (&a)[4], const float (&b)[4]) {
  double sum = 0;
  for (std::size_t i = 0; i < 4; ++i) sum += static_cast<double>(a[i]) * b[i];
  return sum;
}

}  // namespace

void OpenLinkProtocol::start(double time) {
  const Wiring wiring = wiring_;
  *this = OpenLinkProtocol(wiring);
  sample_.time = ask_at_ = time;
  sample_.phase = Phase::starting;
}

void OpenLinkProtocol::stop(Fault fault) {
  if (!going()) return;
  sample_.phase = Phase::stopped;
  sample_.fault = fault;
}

// A sequence of its own each time does not matter: letting go is obeyed with any.
Request OpenLinkProtocol::zero() const { return write(encode(static_cast<std::uint8_t>(sequence_ + 1), Drive{})); }

Request OpenLinkProtocol::hello(double time) {
  if (time < ask_at_) return nothing(ask_at_);
  if (hellos_++ == kHellos) {
    stop(noise_ ? Fault::garbled : Fault::silent);
    return zero();
  }
  ask_at_ = time + kHelloWait;
  sent_at_[++sequence_] = time;
  return write(encode(sequence_, Hello{}));
}

Request OpenLinkProtocol::drive(double time, const Drive& drive) {
  sent_at_[++sequence_] = time;
  return write(encode(sequence_, drive));
}

Drive OpenLinkProtocol::limited(const Command& command) const {
  Drive drive;
  drive.on = true;
  limit(command.force, capabilities_.peak_force, capabilities_.drives, drive.force);
  limit(command.torque, capabilities_.peak_torque, capabilities_.drives >> 3U, drive.torque);
  return drive;
}

Request OpenLinkProtocol::next(double time, const Command& command) {
  if (sample_.phase == Phase::starting) return hello(time);
  if (!going()) return zero();
  watch_.ask(time);
  if (watch_.fault() != Fault::none) {
    stop(watch_.fault());
    return zero();
  }
  if (time < ask_at_) return nothing(ask_at_);
  const bool ready = sample_.phase == Phase::ready;
  // A tenth more than announced is the loop's jitter.
  ask_at_ = time + std::max(0.9 / capabilities_.rate, ready ? 0 : kHomingPeriod);
  return drive(time, ready && watch_.believed() ? limited(command) : Drive{});
}

void OpenLinkProtocol::ended(double /*time*/, Outcome outcome) {
  untaken_ = outcome == Outcome::timed_out ? untaken_ + 1 : 0;
  if (outcome == Outcome::gone) stop(Fault::unplugged);
  if (outcome == Outcome::stalled || untaken_ == kUntaken) stop(Fault::stalled);
}

void OpenLinkProtocol::received(double time, const std::uint8_t* bytes, std::size_t size) {
  for (std::size_t i = 0; i < size && going(); ++i) {
    reader_.put(bytes[i]);
    for (Frame frame; going() && reader_.get(frame);) take(time, frame);
    const std::size_t noise = reader_.drain_noise();
    noise_ = noise_ || noise > 0;
    if (sample_.phase == Phase::starting) continue;
    watch_.noise(noise);
    if (watch_.fault() != Fault::none) stop(watch_.fault());
  }
}

void OpenLinkProtocol::take(double time, const Frame& frame) {
  Capabilities capabilities;
  State state;
  if (sample_.phase == Phase::starting) {
    if (decode(frame, capabilities)) meet(time, capabilities);
    theirs_ = frame.sequence();
  } else if (newer(frame.sequence(), theirs_)) {
    theirs_ = frame.sequence();
    if (decode(frame, state)) take(time, state);
  }
}

void OpenLinkProtocol::meet(double time, const Capabilities& capabilities) {
  if (capabilities.major != kMajor) return stop(Fault::firmware);
  if (wrong(capabilities) != nullptr) return stop(Fault::impossible);
  capabilities_ = capabilities;
  sample_.phase = Phase::homing;
  ask_at_ = time;
  watch_.start(time);
}

void OpenLinkProtocol::take(double time, const State& state) {
  if (!possible(time, state)) {
    steady_ = 0;
    return watch_.impossible();
  }
  const bool ready = sample_.phase == Phase::ready, homed = (state.flags & State::kHomed) != 0;
  if (state.fault != 0 || (ready && !homed)) return stop(Fault::reported);
  if (ready && (state.flags & State::kTripped) != 0) return stop(Fault::host_late);
  last_ = state;
  any_ = true;
  // A frame delayed in transit does not end the silence: only a fresh one counts as good.
  last_sent_ = sent_at_[state.heard];
  if (time - last_sent_ < kLimits.hold) watch_.good(time);
  sample_.time = time;
  ++sample_.number;
  sample_.buttons = state.buttons;
  steady_ = homed ? steady_ + 1 : 0;
  if (homed) {
    const float(&q)[4] = state.orientation;
    sample_.pose = Pose::from_quaternion(q[0], q[1], q[2], q[3], vector(state.position));
  }
  if (sample_.phase == Phase::homing && steady_ == kSteady) sample_.phase = Phase::ready;
}

bool OpenLinkProtocol::possible(double time, const State& state) const {
  const double out = length(vector(state.position)), size = dot4(state.orientation, state.orientation);
  // Written so that a NaN fails; the tolerances are those of binary32 computed on a microcontroller.
  if (!(out <= 1.001 * capabilities_.radius) || !(std::fabs(size - 1) < 1e-3)) return false;
  if (!any_) return true;
  const double passed = 1e-6 * static_cast<std::uint32_t>(state.clock - last_.clock);
  // The previous state was measured after its frame was sent, and this one before it was received. These two times
  // bound the interval between the measurements, whatever the delays. kOff allows for a device that measures ahead of
  // the frame.
  constexpr double kOff = 0.05;  // s
  if (!(passed > 0) || passed > 1.01 * (time - last_sent_) + kOff) return false;
  // Homing moves the origin.
  if (((state.flags ^ last_.flags) & State::kHomed) != 0 || (state.flags & State::kHomed) == 0) return true;
  const double moved = length(vector(state.position) - vector(last_.position));
  const double cosine = std::fabs(dot4(state.orientation, last_.orientation));
  const double turned =
      2 * std::acos(std::min(cosine / std::sqrt(size * dot4(last_.orientation, last_.orientation)), 1.0));
  return moved <= kFastest * passed + 1e-4 && turned <= kFastestTurn * passed + 1e-2;
}

}  // namespace palpate::device
