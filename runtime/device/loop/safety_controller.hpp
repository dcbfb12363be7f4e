// SPDX-License-Identifier: MIT
// Whether a tick of the force loop may give a force, and how much of it: a function of the tick's input and of a few
// numbers of state. It reads no clock and does no input or output, so that a recording replays it bit for bit.
#pragma once

#include "device/device.hpp"
#include "device/loop/force_source.hpp"

namespace palpate::device {

/// Limits of a run, all stated.
struct SafetyLimits {
  double rate = 1000;         ///< Hz, [100, 10000]: of the loop
  double limit = 3;           ///< N, (0, 100]: a longer force is shortened along its line, a pull to it
  double torque_limit = 0;    ///< N m, [0, 10]; 0: no torque
  double ramp_up = 1;         ///< s, [0.01, 60]: from no force to all of it, whenever it (again) may begin
  double ramp_down = 0.05;    ///< s, [0.001, 1]: from all of it to none when a stop is requested
  double stale = 0.005;       ///< s, (0, kStale]: an older sample gives no force
  double gap = kStale;        ///< s, (0, kStale]: no force in a tick that comes later than this after the last one
  double silent = 0.5;        ///< s, [0.01, 60]: without a force that may be given for this long the run is over
  double missed_share = 0.1;  ///< (0, 1]: deadlines missed of those in a second, beyond which the run is over
  std::uint32_t stop_buttons = ~std::uint32_t{0};  ///< buttons that are an emergency stop

  /// Null, or what is wrong.
  [[nodiscard]] const char* validate() const;
};

/// The state of the force.
enum class Mode : std::uint8_t {
  waiting,    ///< none yet: the device is not ready
  ramping,    ///< a share of it that grows
  engaged,    ///< all of it
  suspended,  ///< none for now; it comes back by the ramp
  stopping,   ///< a share of it that shrinks
  stopped     ///< none, for good
};

/// Why there is no force.
enum class Cause : std::uint8_t {
  none,
  not_ready,  ///< the device is not ready: starting, homing
  stale,      ///< the newest sample is too old, or of a time to come
  late,       ///< the tick came too late after the last one
  pose,       ///< the device's pose is no pose
  source,     ///< the force is not usable: fault of the pose in the scene, tracker late or dead, not finite
  asked,      ///< a stop was requested
  emergency,  ///< the emergency stop: a key, a signal, the program
  button,     ///< the emergency stop on the device
  device,     ///< the device stopped; its fault says why
  deadlines   ///< too many deadlines missed
};

const char* name(Mode mode);
const char* name(Cause cause);

/// The input of a tick.
struct TickInput {
  enum Request : std::uint8_t { stop = 1, emergency_stop = 2 };

  std::uint32_t number = 0;  ///< from 1
  std::uint32_t missed = 0;  ///< deadlines missed since the last tick, that of the last tick included
  double due = 0;            ///< s: when it should have begun
  double time = 0;           ///< s: when its sample had been read
  double seconds = 0;        ///< since the last tick's time; the period in the first
  Sample sample;
  std::uint8_t requests = 0;  ///< Request bits
};

/// The result of a tick.
struct TickOutput {
  Command command;
  Answer answer;  ///< of the source; empty where the source was not called
  Mode mode = Mode::waiting;
  Cause cause = Cause::none;
  Fault fault = Fault::none;  ///< of a device that stopped
};

/// The rules, in this order:
///  1. Stopped is for good. An emergency stop, a stopped device and too many missed deadlines stop at once.
///  2. No force while the device is not ready, its sample is stale, the tick late, the pose none, the answer unusable.
///     The source is then reset, so that a depth reached meanwhile gives no force back. Once a force has been given,
///     more than `silent` of this stops the loop, except for a device that is not ready.
///  3. Else the source's force, shortened to the limit along its line, times a share that grows from 0 over `ramp_up`.
///     A requested stop shrinks the share over `ramp_down` and then stops.
///  A sample between fresh and stale is used as it is: an extrapolated pose does work that no hand did.
class SafetyController {
public:
  explicit SafetyController(const SafetyLimits& limits) : limits_(limits) {}

  /// One tick. Allocates nothing, throws nothing.
  TickOutput step(const TickInput& seen, ForceSource& source) noexcept;

private:
  [[nodiscard]] bool too_many_missed(const TickInput& seen);
  [[nodiscard]] Cause ends(const TickInput& seen);
  [[nodiscard]] Cause holds(const TickInput& seen) const;
  TickOutput stop(const TickInput& seen, Cause cause);
  TickOutput hold(const TickInput& seen, Cause cause, ForceSource& source);

  SafetyLimits limits_;
  Mode mode_ = Mode::waiting;
  Cause cause_ = Cause::none;
  Fault fault_ = Fault::none;
  double share_ = 0;   // of the force that is given
  double held_ = 0;    // s without one that may be given
  double missed_ = 0;  // deadlines in the present second
  double second_ = 0;  // s since that began
};

}  // namespace palpate::device
