// SPDX-License-Identifier: MIT
// Shared by the checks of a file's records: the message of a refusal, and the allowed ranges of numbers.
#pragma once

#include "palpate/format/response_view.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace palpate::runtime::detail {

/// Bits, printed in hexadecimal.
struct Bits {
  std::uint32_t bits;
};

/// Writes the message of a refusal. Every % in it stands for the next value: a text, a whole number or bits.
/// It does without printf, whose length modifiers differ between machines and whose code a microcontroller would carry.
class Fault {
public:
  Fault(char* text, std::size_t capacity) : text_(text), capacity_(capacity) {}

  template <class... Values>
  bool fail(const char* message, const Values&... values) {
    const Value all[] = {Value(values)..., Value("")};
    write(message, all, all + sizeof...(values));
    return false;
  }

private:
  struct Value {
    const char* text = nullptr;
    std::uint64_t number = 0;
    unsigned base = 10;
    explicit Value(const char* t) : text(t) {}
    explicit Value(std::uint64_t n) : number(n) {}
    explicit Value(const Bits& b) : number(b.bits), base(16) {}
  };

  void put(char c) {
    if (used_ + 1 < capacity_) text_[used_++] = c;
  }
  void put(const char* text) {
    while (*text != 0) put(*text++);
  }
  void put(std::uint64_t number, unsigned base) {
    if (number >= base) put(number / base, base);
    put("0123456789abcdef"[number % base]);
  }
  void write(const char* message, const Value* value, const Value* end) {
    for (; *message != 0; ++message) {
      if (*message != '%' || value == end) {
        put(*message);
        continue;
      }
      if (value->base == 16) put("0x");
      value->text != nullptr ? put(value->text) : put(value->number, value->base);
      ++value;
    }
    text_[used_] = 0;
  }

  char* text_;
  std::size_t capacity_, used_ = 0;
};

inline bool in_range(const float (&p)[3]) {
  for (const float v : p) {
    if (!(std::fabs(v) < 1e5f)) return false;
  }
  return true;
}

inline double dot3(const float (&a)[3], const float (&b)[3]) {
  return double{a[0]} * double{b[0]} + double{a[1]} * double{b[1]} + double{a[2]} * double{b[2]};
}

/// True when both vectors are unit and orthogonal within 1e-3.
inline bool is_frame(const float (&normal)[3], const float (&tangent)[3]) {
  return std::fabs(dot3(normal, normal) - 1) < 1e-3 && std::fabs(dot3(tangent, tangent) - 1) < 1e-3 &&
         std::fabs(dot3(normal, tangent)) < 1e-3;
}

inline bool is_limit(float limit, double scale) { return limit > 0 && limit <= scale * (1 + 1e-5); }

}  // namespace palpate::runtime::detail
