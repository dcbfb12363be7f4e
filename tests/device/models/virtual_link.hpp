// SPDX-License-Identifier: GPL-3.0-or-later
// A protocol and a model of its device with nothing between them but virtual time: a transport without threads or wire.
#pragma once

#include "device/usb/protocol.hpp"
#include "tests/device/models/usb_model.hpp"

#include <functional>

namespace palpate::test {

class VirtualLink {
public:
  VirtualLink(device::Protocol& protocol, UsbModel& model) : protocol_(protocol), model_(model) {
    model_.plugged(time);
    protocol_.start(time);
  }

  double time = 0;        ///< s
  double period = 0.001;  ///< s of the force loop
  device::Command command;
  device::Outcome outcome = device::Outcome::done;  ///< of every transfer to the device; others than done do not arrive
  std::size_t chop = 0;                             ///< bytes of input lost at the end of each packet

  /// When, and what, was written last.
  double written_at = -1;
  Bytes written;
  int writes = 0;

  /// Runs for so long (s), or until `enough` says so; whether it did.
  bool run(double seconds, const std::function<bool()>& enough = {}) {
    constexpr double kQuantum = 0.000125;
    for (const double end = time + seconds; time < end; time += kQuantum) {
      if (enough && enough()) return true;
      receive();
      send();
    }
    return enough && enough();
  }

  /// Runs until the protocol is in this phase.
  bool run_until(device::Phase phase, double seconds) {
    return run(seconds, [&] { return protocol_.sample().phase == phase; });
  }

private:
  void receive() {
    Bytes packet;
    while (model_.read(time, packet)) {
      if (chop > 0) packet.resize(packet.size() > chop ? packet.size() - chop : 0);
      protocol_.received(time, packet.data(), packet.size());
      if (protocol_.sample().phase != device::Phase::ready) ask_at_ = time;
    }
  }

  void send() {
    using device::Request;
    const bool stopped = protocol_.sample().phase == device::Phase::stopped;
    if (stopped && !told_) ask_at_ = time;  // at once
    told_ = stopped;
    if (time < ask_at_) return;
    device::Command now = command;
    now.time = time;
    const Request request = protocol_.next(time, now);
    const bool looping = protocol_.sample().phase == device::Phase::ready || stopped;
    if (request.kind == Request::Kind::none) {
      ask_at_ = request.until;
    } else if (looping) {
      ask_at_ = ask_at_ + period > time ? ask_at_ + period : time + period;  // what was missed is not made up for
    } else {
      ask_at_ = time;
    }
    if (request.kind == Request::Kind::none) return;
    device::Outcome end = outcome;
    if (request.kind == Request::Kind::control) {
      Bytes none;
      if (end == device::Outcome::done &&
          !model_.control(time, {request.request_type, request.request, request.value, request.index, {}}, none)) {
        end = device::Outcome::stalled;
      }
    } else {
      written.assign(request.bytes, request.bytes + request.size);
      written_at = time;
      ++writes;
      if (end == device::Outcome::done) model_.written(time, written);
    }
    protocol_.ended(time, end);
  }

  device::Protocol& protocol_;
  UsbModel& model_;
  double ask_at_ = 0;
  bool told_ = false;
};

}  // namespace palpate::test
