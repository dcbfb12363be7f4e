// SPDX-License-Identifier: GPL-3.0-or-later
// From reset to the C library's start: vector table, floating-point unit, initialised data.
#include <unistd.h>

#include <cstdint>

extern "C" {

extern std::uint32_t stack_end[], data_begin[], data_end[], data_in_flash[];
[[noreturn]] void _start();  // newlib's, with semihosting: clears .bss, runs constructors and main

[[noreturn]] void reset() {
  *reinterpret_cast<volatile std::uint32_t*>(0xE000ED88) |= 0xFu << 20;  // CPACR: full access to the FPU
  const std::uint32_t* from = data_in_flash;
  for (std::uint32_t* to = data_begin; to != data_end; ++to, ++from) *to = *from;
  _start();
}

[[noreturn]] void fault() { _exit(1); }

using Handler = void();
struct Vectors {
  std::uint32_t* stack;
  Handler* handlers[15];
};
[[gnu::section(".vectors")]] extern const Vectors vectors;
const Vectors vectors = {stack_end, {reset, fault, fault, fault, fault, fault}};

}  // extern "C"
