// SPDX-License-Identifier: GPL-3.0-or-later
// Which registers the machine has. The program itself is built for the least of them; a kernel is compiled once more
// for each wider kind, from one inlined body, and chosen when the program starts.
#pragma once

namespace palpate::fem {

#if defined(__x86_64__)

#define PALPATE_AVX2 [[gnu::target("avx2,fma")]]
#define PALPATE_AVX512 [[gnu::target("avx512f,avx512dq,avx512vl,avx512bw,fma,prefer-vector-width=512")]]

/// The one of three kernels that this machine runs best.
template <class Kernel>
Kernel widest(Kernel plain, Kernel avx2, Kernel avx512) {
  __builtin_cpu_init();
  const auto has_avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                          __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw");
  if (has_avx512) return avx512;
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? avx2 : plain;
}

#else

#define PALPATE_AVX2
#define PALPATE_AVX512

template <class Kernel>
Kernel widest(Kernel plain, Kernel, Kernel) {
  return plain;
}

#endif

}  // namespace palpate::fem
