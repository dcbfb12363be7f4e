// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/device/usb/usb_rate.hpp"

#include "tests/device/usb/lock_counter.hpp"
#include "tests/device/usb/rig.hpp"

#include <ctime>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace palpate::test {

namespace {

Spread spread(std::vector<double>& values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
  };
  return {at(0.5), at(0.99), at(0.999), values.back()};
}

void sleep_until(double time) {
  const auto seconds = static_cast<time_t>(time);
  const timespec when{seconds, static_cast<long>((time - static_cast<double>(seconds)) * 1e9)};
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &when, nullptr);
}

}  // namespace

RateResult measure_rate(double rate, double seconds) {
  using device::now;
  RateResult result;
  Rig rig;
  rig.port.with_model([&] { rig.model.period = 1 / rate; });
  rig.device.reset();
  rig.plug();
  device::UsbOptions options;
  options.rate = rate;
  rig.open(options);
  if (!rig.device) {
    result.error = rig.opened.error;
    return result;
  }
  if (!rig.reach(device::Phase::ready)) {
    result.error = std::string("never ready: ") + device::name(rig.device->read().fault);
    return result;
  }
  const auto most = static_cast<std::size_t>(seconds * rate) + 1;
  std::vector<double> ages, calls;
  ages.reserve(most);
  calls.reserve(most);
  const std::size_t written = rig.port.log().size();
  const double begun = now();
  std::uint32_t last = rig.device->read().number;
  long news = 0, ticks = 0;
  for (double next = begun; next < begun + seconds && ages.size() < most; next += 1 / rate, ++ticks) {
    sleep_until(next);
    const long allocations = mallocs_here(), locks = locks_here();
    const double before = now();
    const device::Sample sample = rig.device->read();
    rig.device->write({before, {0.1, 0, 0.5}, {}});
    const double after = now();
    result.allocations += mallocs_here() - allocations;
    result.locks += locks_here() - locks;
    ages.push_back(before - sample.time);
    calls.push_back(after - before);
    news += sample.number != last;
    last = sample.number;
    if (sample.phase != device::Phase::ready) {
      result.error = std::string("it stopped: ") + device::name(sample.fault);
      return result;
    }
  }
  result.seconds = now() - begun;
  const device::UsbCounts counts = rig.device->counts();
  rig.device->close();
  const std::vector<Written> log = rig.port.log();
  std::vector<double> periods;
  for (std::size_t k = written + 1; k < log.size(); ++k) periods.push_back(log[k].time - log[k - 1].time);
  result.commands = static_cast<double>(periods.size()) / result.seconds;
  result.samples = static_cast<double>(news) / result.seconds;
  result.loop = static_cast<double>(ticks) / result.seconds;
  const auto all = static_cast<double>(std::max<std::uint64_t>(counts.periods, 1));
  result.late = static_cast<double>(counts.late) / all;
  result.blocked = static_cast<double>(counts.blocked) / all;
  result.period = spread(periods);
  result.age = spread(ages);
  result.call = spread(calls);
  return result;
}

}  // namespace palpate::test
