// SPDX-License-Identifier: MIT
// The clock that a force loop ticks by; a seam, so that hours of ticks can be tested in a second.
#pragma once

namespace palpate::device {

class Clock {
public:
  virtual ~Clock() = default;
  virtual double now() noexcept = 0;  ///< s, of the same clock as device::now()
  virtual void sleep_until(
      double seconds) noexcept = 0;  ///< no longer than that but for lateness; past: returns at once
};

/// CLOCK_MONOTONIC, which steady_clock and device::now() are on Linux; sleeps to an absolute time, so that lateness
/// does not add up.
Clock& system_clock();

}  // namespace palpate::device
