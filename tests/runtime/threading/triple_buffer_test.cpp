// SPDX-License-Identifier: GPL-3.0-or-later
// Triple buffer in one thread, and between two threads that race (built with the thread sanitizer).
#include "palpate/threading/triple_buffer.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

namespace palpate {
namespace {

using runtime::SlotExchange;
using runtime::TripleBuffer;

TEST(TripleBuffer, ValueIsReadOnceAndTheNewestWins) {
  TripleBuffer<int> buffer;
  int value = -1;
  EXPECT_FALSE(buffer.read(value));
  EXPECT_EQ(value, -1);
  buffer.write(1);
  EXPECT_TRUE(buffer.read(value));
  EXPECT_FALSE(buffer.read(value));
  EXPECT_EQ(value, 1);
  for (int i = 2; i < 10; ++i) buffer.write(i);
  EXPECT_TRUE(buffer.read(value));
  EXPECT_EQ(value, 9);
}

TEST(TripleBuffer, SlotsOfWriterAndReaderDifferInAnyOrderOfCalls) {
  for (unsigned order = 0; order < 1024; ++order) {
    SlotExchange exchange(0, 2);
    std::uint8_t reading = 1;
    for (unsigned bits = order | 1024; bits > 1; bits /= 2) {
      if (bits % 2 == 1) {
        exchange.publish();
      } else {
        exchange.take(reading);
      }
      ASSERT_NE(exchange.writing(), reading) << order;
      ASSERT_LT(exchange.writing(), 3);
      ASSERT_LT(reading, 3);
    }
  }
}

TEST(TripleBuffer, ReadValueIsOfOneWriteWhileThreadsRace) {
  struct Value {
    int parts[40] = {};
  };
  constexpr int kLast = 20000, kReads = 1000;
  TripleBuffer<Value> buffer;
  std::atomic<bool> enough{false};  // on a busy machine either thread may run alone for long
  std::thread writer([&] {
    Value value;
    for (int i = 1; !enough; ++i) {
      for (int& part : value.parts) part = i;
      buffer.write(value);
    }
  });
  int before = 0, reads = 0;
  while (before < kLast || reads < kReads) {
    Value value;
    if (!buffer.read(value)) continue;
    ++reads;
    EXPECT_GT(value.parts[0], before);
    for (const int part : value.parts) EXPECT_EQ(part, value.parts[0]);
    before = value.parts[0];
  }
  enough = true;
  writer.join();
}

}  // namespace
}  // namespace palpate
