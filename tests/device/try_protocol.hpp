// SPDX-License-Identifier: GPL-3.0-or-later
// Any bytes as what happens to a protocol: packets, time, ends of requests. For fuzzers and tests of every language.
#pragma once

#include "device/clamp_command.hpp"
#include "device/usb/protocol.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace palpate::test {

/// Plays the transport's part with `bytes` as its script. Returns the broken invariant, or null.
inline const char* try_protocol(device::Protocol& protocol, const device::DeviceKind& kind, const std::uint8_t* bytes,
                                std::size_t size) {
  using device::Fault;
  using device::Outcome;
  using device::Phase;
  using device::Request;
  const auto same = [](const Request& a, const Request& b) {
    return a.kind == b.kind && a.size == b.size && std::memcmp(a.bytes, b.bytes, a.size) == 0;
  };
  double time = 1000;
  protocol.start(time);
  Phase before = protocol.sample().phase;
  std::uint32_t number = 0;
  bool sending = false;
  for (std::size_t at = 0; at < size;) {
    const std::uint8_t event = bytes[at++];
    time += 1e-4 * (event >> 3);
    switch (event & 7) {
      case 0:
      case 1:
      case 2:
      case 3: {  // a packet: its length, then its bytes
        if (at == size) break;
        std::size_t length = bytes[at++] % 65;
        if (length > size - at) length = size - at;
        protocol.received(time, bytes + at, length);
        at += length;
        break;
      }
      case 4:
      case 5:
      case 6: {
        if (sending) protocol.ended(time, Outcome::done);
        const double push = event - 128.0;
        const Request request = protocol.next(time, device::clamp_command({time, {push, 1, -push}, {}}, kind, time));
        sending = request.kind != Request::Kind::none;
        if (request.kind == Request::Kind::none && !(request.until > time - 1))
          return "the request has no time of the next call";
        if (request.size > Request::kMost) return "a request is longer than it may be";
        if (protocol.sample().phase == Phase::stopped && request.kind == Request::Kind::write &&
            !same(request, protocol.zero())) {
          return "a force after it stopped";
        }
        break;
      }
      default:
        if (sending) protocol.ended(time, static_cast<Outcome>((event >> 3) & 3));
        sending = false;
    }
    const device::Sample& sample = protocol.sample();
    if (sample.phase < before) return "its phase went back";
    if ((sample.phase == Phase::stopped) != (sample.fault != Fault::none))
      return "stopped without a fault, or a fault without";
    if (sample.number < number) return "its samples are counted backwards";
    if (!sample.pose.valid()) return "its pose is none";
    if (sample.time > time) return "a sample of the future";
    before = sample.phase;
    number = sample.number;
  }
  return nullptr;
}

}  // namespace palpate::test
