// SPDX-License-Identifier: MIT
// The arithmetic that the runtime needs.
#pragma once

#include "palpate/format/config.hpp"

// Validity tests compare with NaN and infinity, and sums keep their order. Clang has no macro for reordered sums alone.
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__) || defined(__ASSOCIATIVE_MATH__)
#error "Palpate needs IEEE arithmetic: no -ffast-math, -Ofast, -ffinite-math-only or -funsafe-math-optimizations"
#endif
