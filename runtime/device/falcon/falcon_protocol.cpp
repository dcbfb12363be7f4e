// SPDX-License-Identifier: MIT
#include "device/falcon/falcon_protocol.hpp"

#include "device/usb/ftdi.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::device {

using namespace falcon;

namespace {

Request write(const Output& output) {
  Request request;
  request.kind = Request::Kind::write;
  const auto bytes = encode(output);
  std::copy(bytes.begin(), bytes.end(), request.bytes);
  request.size = kPacket;
  return request;
}

bool homed(const Input& input) { return (input.bits & Input::kHomed) == Input::kHomed; }

}  // namespace

void FalconProtocol::start(double time) {
  boot_.start(firmware_);
  reader_ = {};
  sample_ = {};
  sample_.time = last_time_ = time;
  sample_.phase = Phase::starting;
  last_ = {};
  arms_ = {};
  tip_ = kCentre;
  steady_ = untaken_ = 0;
}

Request FalconProtocol::zero() const {
  Output output;
  output.bits |= Output::kRed;
  return write(output);
}

void FalconProtocol::stop(Fault fault) {
  if (sample_.phase == Phase::stopped) return;
  sample_.phase = Phase::stopped;
  sample_.fault = fault;
}

Request FalconProtocol::next(double time, const Command& command) {
  if (sample_.phase == Phase::homing || sample_.phase == Phase::ready) {
    watch_.ask(time);
    if (watch_.fault() != Fault::none) stop(watch_.fault());
  }
  switch (sample_.phase) {
    case Phase::starting: {
      const Request request = boot_.next(time);
      if (boot_.state() != Boot::State::failed) return request;
      stop(boot_.fault());
      return zero();
    }
    case Phase::homing: {
      Request nothing;
      nothing.until = write_at_;
      if (time < write_at_) return nothing;
      write_at_ = time + kHomingPeriod;
      return zero();
    }
    case Phase::ready: {
      if (!watch_.believed()) return zero();
      Output output;
      output.bits |= Output::kBlue;
      output.motors = motors(torques(arms_, command.force));
      return write(output);
    }
    case Phase::closed:
    case Phase::stopped:
      break;
  }
  return zero();
}

void FalconProtocol::ended(double time, Outcome outcome) {
  if (sample_.phase == Phase::starting) {
    boot_.ended(time, outcome);
    if (boot_.state() == Boot::State::failed) stop(boot_.fault());
    return;
  }
  untaken_ = outcome == Outcome::timed_out ? untaken_ + 1 : 0;
  if (outcome == Outcome::gone) stop(Fault::unplugged);
  if (outcome == Outcome::stalled || untaken_ == kUntaken) stop(Fault::stalled);
}

void FalconProtocol::received(double time, const std::uint8_t* bytes, std::size_t size) {
  ftdi::for_payload(bytes, size, wiring().packet, [&](const std::uint8_t* payload, std::size_t count) {
    if (sample_.phase == Phase::starting) {
      boot_.received(payload, count);
      if (boot_.state() == Boot::State::running) {
        sample_.phase = Phase::homing;
        watch_.start(time);
        write_at_ = time;
      } else if (boot_.state() == Boot::State::failed) {
        stop(boot_.fault());
      }
      return;
    }
    for (std::size_t i = 0; i < count && (sample_.phase == Phase::homing || sample_.phase == Phase::ready); ++i) {
      const bool whole = reader_.take(payload[i]);
      watch_.noise(reader_.drain_noise());
      if (whole) take(time, reader_.input());
      if (watch_.fault() != Fault::none) stop(watch_.fault());
    }
  });
}

// Accepts a packet whose pose is possible, and counts the others as impossible.
void FalconProtocol::take(double time, const Input& input) {
  if (sample_.phase == Phase::ready && !homed(input)) return stop(Fault::reported);
  if (homed(input) && !placed(time, input)) {
    steady_ = 0;
    return watch_.impossible();
  }
  last_ = input;
  last_time_ = time;
  watch_.good(time);
  sample_.time = time;
  ++sample_.number;
  sample_.buttons = input.bits & Input::kButtons;
  if (!homed(input)) {
    steady_ = 0;
  } else if (sample_.phase == Phase::homing && ++steady_ == kSteady) {
    sample_.phase = Phase::ready;
  }
}

// Computes the grip's position. False where the encoders jump or the position is out of reach.
bool FalconProtocol::placed(double time, const Input& input) {
  Triple angles;
  for (std::size_t i = 0; i < 3; ++i) angles[i] = angle_of(input.encoders[i]);
  // Their origin jumps when the last arm finds it: what was before is no measure.
  if (homed(last_)) {
    const double most = kFastest * (time - last_time_ + kSlack);
    for (std::size_t i = 0; i < 3; ++i) {
      if (!(std::fabs(angles[i] - angle_of(last_.encoders[i])) <= most)) return false;
    }
  }
  const Reached reached = forward(angles, tip_);
  if (!reached.ok || length(reached.tip - kCentre) > kFarthest) return false;
  const Arms arms = inverse(reached.tip);
  if (!arms.reached) return false;
  // Sines and cosines are the same for angles a whole turn apart.
  for (std::size_t i = 0; i < 3; ++i) {
    if (std::fabs(arms.arm[i].angle - angles[i]) > 0.01) return false;
  }
  tip_ = reached.tip;
  arms_ = arms;
  sample_.pose.translation = tip_ - kCentre;
  return true;
}

}  // namespace palpate::device
