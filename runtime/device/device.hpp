// SPDX-License-Identifier: MIT
// The interface between the force loop and a haptic device, on a wire or simulated.
#pragma once

#include "device/device_table.hpp"
#include "device/hand_types.hpp"
#include "palpate/math/pose.hpp"

#include <algorithm>
#include <cstdint>

namespace palpate::device {

using runtime::Pose;
using runtime::Vec3;

inline constexpr double kPi = 3.141592653589793;

/// How far a device has come. Only a device that is ready is given a force other than zero.
enum class Phase : std::uint8_t {
  closed,
  starting,  ///< handshake, boot
  homing,    ///< its encoders have no origin yet: the user, or the device, has to move it
  ready,
  stopped  ///< a fault ended it: zero was sent where the link still lived; to be closed
};

/// Why a device stopped.
enum class Fault : std::uint8_t {
  none,
  unplugged,   ///< the link is gone
  refused,     ///< not ours to open: no permission, or another program has it
  stalled,     ///< the endpoint answers with an error
  silent,      ///< nothing has arrived for longer than the device may take
  garbled,     ///< what arrives follows no protocol for longer than resynchronising takes
  impossible,  ///< what arrives is well formed and cannot be: an encoder leaps, a pose is out of reach
  firmware,    ///< the boot failed (file missing, too long, refused or echoed wrongly), or no driver speaks with it
  host_late,   ///< the force loop stopped sending
  reported     ///< the device says so itself
};

/// One sample of a device, in its own frame.
struct Sample {
  double time = 0;            ///< s on the clock of now(): when its last byte arrived
  Pose pose;                  ///< m; no rotation for devices that measure none; of a glove the wrist's
  std::uint32_t number = 0;   ///< samples since opened; 0: none has arrived yet
  std::uint32_t buttons = 0;  ///< one bit each, lowest first
  Phase phase = Phase::closed;
  Fault fault = Fault::none;
  HandJoints joints{};  ///< what a glove's sensors read, in their own unit; 0 for others
};

/// The force that the loop commands, in the device's frame.
struct Command {
  double time = 0;  ///< s on the clock of now(): when it was computed
  Vec3 force;       ///< N
  Vec3 torque;      ///< N m; left out by devices that have none
  Pulls pull{};     ///< N; left out by all but gloves, which leave out the others

  /// N: of the force, or of the strongest pull.
  [[nodiscard]] double strength() const { return std::max(length(force), *std::max_element(pull.begin(), pull.end())); }
};

/// s on a clock that never goes back (std::chrono::steady_clock).
double now();

const char* name(Phase phase);
const char* name(Fault fault);

/// An open device. read() and write() are for one force loop: neither waits, locks, allocates or throws.
class Device {
public:
  virtual ~Device() = default;  ///< closes
  [[nodiscard]] virtual const DeviceKind& kind() const = 0;

  /// The newest sample; phase and fault are of this moment.
  virtual Sample read() noexcept = 0;

  /// Replaces the command. A value that is not finite becomes zero; a force beyond kind().peak_force is shortened along
  /// its line, a pull to it. A command older than kStale is not sent any more: zero is.
  virtual void write(const Command& command) noexcept = 0;

  /// Sends zero, waits until it has left (10 ms at most) and lets go. Again: nothing happens.
  virtual void close() = 0;
};

inline constexpr double kStale = 0.010;  ///< s after which a command is no longer sent

}  // namespace palpate::device
