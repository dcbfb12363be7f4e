// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/fem/matrix/ordering.hpp"

#include <cholmod.h>
#include <csetjmp>
#include <cstdlib>
#include <mutex>

// METIS returns from its errors by a jump out of a handler of SIGABRT and SIGTERM, which each call installs for the
// whole process. A SIGTERM of the user would take another thread to a place that it never was at. These definitions
// come before those of the shared library: errors jump without a signal, and handlers stay.
extern "C" {
#pragma GCC visibility push(default)
constexpr int kMostTraps = 128;  // METIS's own
__thread int gk_cur_jbufs = -1;
__thread jmp_buf gk_jbufs[kMostTraps];
int gk_sigtrap() {
  if (gk_cur_jbufs + 1 >= kMostTraps) return 0;
  ++gk_cur_jbufs;
  return 1;
}
int gk_siguntrap() {
  if (gk_cur_jbufs < 0) return 0;
  --gk_cur_jbufs;
  return 1;
}
void gk_errexit(int cause, char*, ...) {
  if (gk_cur_jbufs < 0) std::abort();
  std::longjmp(gk_jbufs[gk_cur_jbufs], cause);
}
#pragma GCC visibility pop
}

namespace palpate::fem {

cholmod_factor* order_and_analyse(cholmod_sparse& lower, cholmod_common& common) {
  // METIS seeds and draws from the process's one rand(): two threads ordering at once would mix their draws, and the
  // order of elimination (so the last bits of every solve) would depend on the scheduler.
  static std::mutex mutex;
  const std::scoped_lock lock(mutex);
  return cholmod_analyze(&lower, &common);
}

}  // namespace palpate::fem
