// SPDX-License-Identifier: MIT
// A device's language apart from the wire: bytes in, bytes out. It does no input or output, reads no clock and
// allocates nothing, so that tests, fuzzers and simulations drive it as the transport does.
#pragma once

#include "device/device.hpp"

#include <cstddef>
#include <cstdint>

namespace palpate::device {

/// The transport's next action, chosen by a protocol.
struct Request {
  enum class Kind : std::uint8_t {
    none,     ///< nothing before `until`, unless something arrives
    control,  ///< a control transfer to the device without a data stage
    write     ///< `bytes` to the endpoint for output
  };
  static constexpr std::size_t kMost = 64;

  Kind kind = Kind::none;
  std::uint8_t request_type = 0, request = 0;  ///< of a control transfer
  std::uint16_t value = 0, index = 0;
  std::uint8_t bytes[kMost] = {};
  std::uint8_t size = 0;
  double until = 0;  ///< s: the latest time of the next call of next()
};

/// How a request ended.
enum class Outcome : std::uint8_t { done, stalled, timed_out, gone };

/// The endpoints and the interface a protocol speaks through.
struct Wiring {
  std::uint8_t interface = 0;
  std::uint8_t in = 0x81, out = 0x02;  ///< endpoint addresses; 0: the interface's first one that way
  bool interrupt = false;              ///< interrupt transfers; bulk otherwise
  std::uint16_t packet = 64;           ///< bytes of a transfer of input
};

/// A state machine from opened to ready to stopped. One thread calls it, with times that never go back (s).
class Protocol {
public:
  virtual ~Protocol() = default;
  [[nodiscard]] virtual Wiring wiring() const = 0;

  /// Begins anew: the link has just been opened.
  virtual void start(double time) = 0;

  /// The next request, given the loop's current command (finite, within the limits, zero when stale). Called once the
  /// last request has ended and, once ready, each period of the loop: then always the command of this period.
  virtual Request next(double time, const Command& command) = 0;

  /// The last request ended so.
  virtual void ended(double time, Outcome outcome) = 0;

  /// A transfer of input brought these bytes: any number, cut anywhere.
  virtual void received(double time, const std::uint8_t* bytes, std::size_t size) = 0;

  /// The newest sample, with phase and fault.
  [[nodiscard]] virtual const Sample& sample() const = 0;

  /// The request that makes the device let go, whatever state this is in.
  [[nodiscard]] virtual Request zero() const = 0;
};

}  // namespace palpate::device
