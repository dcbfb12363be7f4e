// SPDX-License-Identifier: GPL-3.0-or-later
// The driver keeps its rate on the emulated bus, and the force loop's calls neither lock nor allocate.
#include "tests/device/usb/usb_rate.hpp"

#include "tests/device/usb/lock_counter.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <mutex>
#include <vector>

namespace palpate::test {
namespace {

// The counters count: without this their zeros would say nothing.
TEST(UsbRate, CountersSeeLocksAndAllocations) {
  const long locks = locks_here(), mallocs = mallocs_here();
  std::mutex mutex;
  mutex.lock();
  mutex.unlock();
  const auto some = std::make_unique<std::vector<int>>(static_cast<std::size_t>(mallocs + 10));
  EXPECT_EQ(locks_here() - locks, 1);
  EXPECT_GE(mallocs_here() - mallocs, 2);
  EXPECT_NE(some, nullptr);
}

void check(double rate) {
  const RateResult result = measure_rate(rate, 1.0);
  ASSERT_EQ(result.error, "");
  EXPECT_EQ(result.allocations, 0);
  EXPECT_EQ(result.locks, 0);
  // No test of speed: a machine with nothing else to do keeps the rate to a per mille.
  EXPECT_GT(result.commands, 0.3 * rate);
  EXPECT_GT(result.samples, 0.1 * rate);
}

TEST(UsbRate, AtOneKilohertz) { check(1000); }
TEST(UsbRate, AtFourKilohertz) { check(4000); }

}  // namespace
}  // namespace palpate::test
