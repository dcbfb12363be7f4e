// SPDX-License-Identifier: GPL-3.0-or-later
// Counts instructions on the board.
#pragma once

#include <cstdint>
#include <cstdio>

namespace palpate::test {

/// QEMU's -icount shift=10 executes an instruction in 1024 ns of the board's time, which SysTick counts at 25 MHz in 24
/// bits: 25.6 steps an instruction, up to 655 360 of them.
class Clock {
public:
  Clock() { registers()[1] = kLast, registers()[2] = 0, registers()[0] = 5; }
  template <class Work>
  std::uint32_t operator()(const Work& work) const {
    const std::uint32_t before = registers()[2];
    work();
    return (((before - registers()[2]) & kLast) * 10 + 128) / 256;
  }

  /// Says on standard error if it does not.
  [[nodiscard]] bool counts() const {
    const std::uint32_t hundred = (*this)([] { __asm__ volatile(".rept 100\n nop\n .endr"); });
    if (hundred < 100 || hundred > 103) std::fprintf(stderr, "100 instructions count as %u\n", unsigned(hundred));
    return hundred >= 100 && hundred <= 103;
  }

private:
  static constexpr std::uint32_t kLast = 0xFFFFFF;
  static volatile std::uint32_t* registers() { return reinterpret_cast<volatile std::uint32_t*>(0xE000E010); }
};

}  // namespace palpate::test
