// SPDX-License-Identifier: MIT
// Features of compilers beyond C++17 that these headers use, each with a fallback.
#pragma once

#ifndef PALPATE_ALWAYS_INLINE
/// Inlines a function into every caller, because a call in a tick costs more than the function.
/// Without GCC, Clang or MSVC it is an ordinary inline function.
#if defined(__GNUC__) || defined(__clang__)
#define PALPATE_ALWAYS_INLINE [[gnu::always_inline]] inline
#elif defined(_MSC_VER)
#define PALPATE_ALWAYS_INLINE __forceinline
#else
#define PALPATE_ALWAYS_INLINE inline
#endif
#endif

#ifndef PALPATE_NOINLINE
/// Keeps a function out of its callers, because the rare path would make the usual one slower.
/// Without GCC, Clang or MSVC the compiler decides.
#if defined(__GNUC__) || defined(__clang__)
#define PALPATE_NOINLINE [[gnu::noinline]]
#elif defined(_MSC_VER)
#define PALPATE_NOINLINE __declspec(noinline)
#else
#define PALPATE_NOINLINE
#endif
#endif
