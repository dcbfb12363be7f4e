// SPDX-License-Identifier: GPL-3.0-or-later
// Debian's OpenBLAS 0.3.21 runs recent Xeons with kernels for a Prescott: six times slower.
#include "tools/blas.hpp"

#include <dlfcn.h>
#include <unistd.h>
#include <cstdlib>
#include <cstring>
#include <string_view>

namespace palpate::cli {

namespace {

// Set in the second start, so that there is never a third.
constexpr const char* kGuard = "PALPATE_BLAS_CHOSEN";

#if defined(__x86_64__)

bool has_avx2() { return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"); }

bool has_avx512() {
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
         __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
}

#else

bool has_avx2() { return false; }
bool has_avx512() { return false; }

#endif

bool set_unless_given(const char* name, const char* value) {
  if (std::getenv(name) != nullptr) return false;
  return setenv(name, value, 0) == 0;
}

}  // namespace

const char* better_core_type(std::string_view chosen, bool avx2, bool avx512) {
  if (!avx2) return nullptr;
  for (const std::string_view modern : {"Haswell", "Zen", "SkylakeX", "Cooperlake", "SapphireRapids", "Excavator"}) {
    if (chosen == modern) return nullptr;
  }
  return avx512 ? "SkylakeX" : "Haswell";
}

std::string blas_kernels() {
  void* symbol = dlsym(RTLD_DEFAULT, "openblas_get_corename");
  if (symbol == nullptr) return "";
  char* (*core_name)() = nullptr;
  std::memcpy(&core_name, &symbol, sizeof core_name);
  const char* name = core_name();
  return name == nullptr ? "" : name;
}

void use_right_blas_kernels(char** argv) {
  if (std::getenv(kGuard) != nullptr) return;
  // OpenBLAS and the OpenMP library read these only while they are loaded, before main.
  const bool loaded =
      dlsym(RTLD_DEFAULT, "openblas_get_corename") != nullptr || dlsym(RTLD_DEFAULT, "omp_get_max_threads") != nullptr;
  bool changed = set_unless_given("OPENBLAS_NUM_THREADS", "1");
  changed = set_unless_given("OMP_NUM_THREADS", "1") || changed;
  // CHOLMOD opens OpenMP regions with a thread count of its own: only the limit stops them.
  changed = set_unless_given("OMP_THREAD_LIMIT", "1") || changed;
  const std::string kernels = blas_kernels();
  const char* core = kernels.empty() ? nullptr : better_core_type(kernels, has_avx2(), has_avx512());
  if (core != nullptr) changed = set_unless_given("OPENBLAS_CORETYPE", core) || changed;
  if (!loaded || !changed || setenv(kGuard, "1", 1) != 0) return;
  execv("/proc/self/exe", argv);
  // Not possible here (no /proc): the right answer, only slower.
}

}  // namespace palpate::cli
