// SPDX-License-Identifier: GPL-3.0-or-later
// Publishes what the driver does on the emulated bus: usb_rate [SECONDS [RATE...]], 60 s at 1 and at 4 kHz by default.
#include "tests/device/usb/usb_rate.hpp"

#include <cstdio>
#include <cstdlib>
#include <vector>

namespace {

void print(const char* what, const palpate::test::Spread& s) {
  std::printf("  %-28s p50 %7.1f  p99 %7.1f  p99.9 %7.1f  most %8.1f us\n", what, 1e6 * s.p50, 1e6 * s.p99,
              1e6 * s.p999, 1e6 * s.most);
}

}  // namespace

int main(int count, char** words) {
  const double seconds = count > 1 ? std::atof(words[1]) : 60;
  std::vector<double> rates;
  for (int k = 2; k < count; ++k) rates.push_back(std::atof(words[k]));
  if (rates.empty()) rates = {1000, 4000};
  if (!(seconds > 0)) {
    std::fprintf(stderr, "usage: usb_rate [SECONDS [RATE...]]\n");
    return 1;
  }
  for (const double rate : rates) {
    const palpate::test::RateResult r = palpate::test::measure_rate(rate, seconds);
    if (!r.error.empty()) {
      std::fprintf(stderr, "usb_rate: %g Hz: %s\n", rate, r.error.c_str());
      return 3;
    }
    std::printf(
        "%g Hz for %.1f s: %.1f commands a second at the device, %.1f samples and %.1f ticks in the force loop\n", rate,
        r.seconds, r.commands, r.samples, r.loop);
    std::printf("  periods passed over %.3f %%, without a command %.3f %%\n", 100 * r.late, 100 * r.blocked);
    print("between commands", r.period);
    print("age of the sample", r.age);
    print("read() and write()", r.call);
    std::printf("  in read() and write(): %ld allocations, %ld locks\n", r.allocations, r.locks);
  }
  return 0;
}
