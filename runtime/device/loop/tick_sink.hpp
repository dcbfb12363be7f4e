// SPDX-License-Identifier: MIT
// The receiver of every tick of the force loop.
#pragma once

#include "device/loop/safety_controller.hpp"

namespace palpate::device {

class TickSink {
public:
  virtual ~TickSink() = default;

  /// Called by the force loop after each tick; never waits, locks or allocates.
  virtual void put(const TickInput& seen, const TickOutput& out) noexcept = 0;
};

}  // namespace palpate::device
