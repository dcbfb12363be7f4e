// SPDX-License-Identifier: MIT
// Flags by which any thread, or a signal handler, requests a force loop to stop.
#pragma once

#include "device/loop/safety_controller.hpp"

#include <atomic>

namespace palpate::device {

/// Requests add up and are never taken back: an emergency stop latches.
class StopFlags {
public:
  void stop() noexcept { flags_.fetch_or(TickInput::stop, std::memory_order_relaxed); }
  void emergency_stop() noexcept { flags_.fetch_or(TickInput::emergency_stop, std::memory_order_relaxed); }
  [[nodiscard]] std::uint8_t requests() const noexcept { return flags_.load(std::memory_order_relaxed); }

private:
  std::atomic<std::uint8_t> flags_{0};
  static_assert(std::atomic<std::uint8_t>::is_always_lock_free, "for signal handlers");
};

}  // namespace palpate::device
