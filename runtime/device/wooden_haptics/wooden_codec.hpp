// SPDX-License-Identifier: MIT
// The reports of the WoodenHaptics with three degrees of freedom: 8 bytes each way, little-endian.
#pragma once

#include "device/wooden_haptics/wooden_kinematics.hpp"

#include <cstddef>
#include <cstdint>

namespace palpate::device {

inline constexpr std::size_t kWoodenReport = 8;

/// Device to host.
struct WoodenReport {
  std::int16_t encoder[3] = {};
  std::uint16_t number = 0;  ///< one more with each report, wrapping
};

/// Reads one whole report; false, and nothing changed, for any other size. Reports have no frame: a transfer is a
/// report. Boards whose packets have a fixed size pad with zeros: those are let pass, other bytes behind a report are
/// not.
bool decode(const std::uint8_t* bytes, std::size_t size, WoodenReport& report);

/// Whether this is what the arm with a wrist sends (six encoders, 14 bytes), which no driver here speaks with. Padded,
/// one whose wrist has not moved looks like decode()'s.
bool is_six_joint_report(const std::uint8_t* bytes, std::size_t size);

/// Host to device: mA in each motor.
void encode(const std::array<std::int16_t, 3>& milliamps, std::uint8_t (&bytes)[kWoodenReport]);

/// mA for these currents (A), all of them smaller by one factor where one is beyond `most` (A, at most 32.767): the
/// force keeps its direction and nothing wraps. A value that is not finite becomes zero.
std::array<std::int16_t, 3> milliamps(const Joints& currents, double most);

/// Counts of an encoder since start() or restart(); it wraps at 16 bits.
class Unwrapped {
public:
  void start(std::int16_t value) {
    last_ = value;
    total_ = 0;
  }
  /// How far `value` is from the last one, the shorter way round.
  [[nodiscard]] int step(std::int16_t value) const {
    return static_cast<std::int16_t>(static_cast<std::uint16_t>(value) - static_cast<std::uint16_t>(last_));
  }
  void follow(std::int16_t value) {
    total_ += step(value);
    last_ = value;
  }
  /// Counts from the last value on.
  void restart() { total_ = 0; }
  [[nodiscard]] std::int64_t total() const { return total_; }

private:
  std::int16_t last_ = 0;
  std::int64_t total_ = 0;
};

}  // namespace palpate::device
