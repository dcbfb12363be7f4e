// SPDX-License-Identifier: MIT
// Compiler differences in one place: inlining, and the arithmetic that the runtime needs.
#pragma once

// Validity tests compare with NaN and infinity, and sums keep their order.
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__) || defined(__ASSOCIATIVE_MATH__)
#error "Palpate needs IEEE arithmetic: no -ffast-math, -Ofast, -ffinite-math-only or -funsafe-math-optimizations"
#endif

/// Functions that are large and called from many places stay functions; without it a tick grows by half.
#if defined(__GNUC__) || defined(__clang__)
#define PALPATE_NOINLINE [[gnu::noinline]]
#elif defined(_MSC_VER)
#define PALPATE_NOINLINE __declspec(noinline)
#else
#define PALPATE_NOINLINE
#endif
