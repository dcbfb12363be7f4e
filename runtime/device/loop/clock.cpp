// SPDX-License-Identifier: MIT
#include "device/loop/clock.hpp"

#include "device/device.hpp"

#include <time.h>

#include <cerrno>
#include <cmath>

namespace palpate::device {
namespace {

class SystemClock : public Clock {
public:
  double now() noexcept override { return device::now(); }

  void sleep_until(double seconds) noexcept override {
    const double whole = std::floor(seconds);
    const timespec until{static_cast<time_t>(whole), static_cast<long>(1e9 * (seconds - whole))};
    while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
    }
  }
};

}  // namespace

Clock& system_clock() {
  static SystemClock clock;
  return clock;
}

}  // namespace palpate::device
