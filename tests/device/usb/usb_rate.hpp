// SPDX-License-Identifier: GPL-3.0-or-later
// How a driver keeps time on the emulated bus: a force loop at absolute times, and what arrived at the device.
#pragma once

#include <string>

namespace palpate::test {

/// Seconds at the 50th, 99th and 99.9th percentile, and the largest.
struct Spread {
  double p50 = 0, p99 = 0, p999 = 0, most = 0;
};

struct RateResult {
  std::string error;                ///< empty: usable
  double seconds = 0;               ///< measured
  double commands = 0;              ///< Hz at the device
  double samples = 0;               ///< Hz of new samples in the force loop
  double loop = 0;                  ///< Hz of the force loop itself
  Spread period;                    ///< between two commands at the device
  Spread age;                       ///< of the sample that the force loop reads
  Spread call;                      ///< of one read() and one write()
  double late = 0, blocked = 0;     ///< shares of the driver's periods passed over, and without a command
  long allocations = 0, locks = 0;  ///< in read() and write()
};

/// A WoodenHaptics model that reports at `rate` (Hz), driven at `rate` for `seconds`.
RateResult measure_rate(double rate, double seconds);

}  // namespace palpate::test
