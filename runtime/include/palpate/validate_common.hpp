// SPDX-License-Identifier: MIT
// What the checks of a file's records share: the message that opening ends with, and what numbers may be.
#pragma once

#include "palpate/math3.hpp"
#include "palpate/view.hpp"

#include <cmath>
#include <cstdarg>
#include <cstdio>

namespace palpate::runtime::detail {

/// Collects the one message that opening ends with.
struct Fault {
  char* text;
  std::size_t capacity;

#if defined(__GNUC__)
  __attribute__((format(printf, 2, 3)))
#endif
  bool
  say(const char* format, ...) {
    std::va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(text, capacity, format, arguments);
    va_end(arguments);
    return false;
  }
};

inline bool in_range(const float (&p)[3]) {
  for (const float v : p) {
    if (!(std::fabs(v) < 1e5f)) return false;
  }
  return true;
}

inline bool is_frame(const float (&normal)[3], const float (&tangent)[3]) {
  const Vec3 n = to_vec(normal), t = to_vec(tangent);
  return std::fabs(dot(n, n) - 1) < 1e-3 && std::fabs(dot(t, t) - 1) < 1e-3 && std::fabs(dot(n, t)) < 1e-3;
}

inline bool is_limit(float limit, double scale) { return limit > 0 && limit <= scale * (1 + 1e-5); }

}  // namespace palpate::runtime::detail
