// SPDX-License-Identifier: GPL-3.0-or-later
// Debian's OpenBLAS 0.3.21 runs recent Xeons with kernels for a Prescott: six times slower.
#include "tools/cli/blas.hpp"

#include <dlfcn.h>
#include <unistd.h>
#include <cstdlib>
#include <cstring>
#include <string_view>

namespace palpate::cli {

namespace {

// Names the variables that the first start has set. Set in the second, so that there is never a third.
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

/// Adds the name to `set` where it was not given.
void set_unless_given(const char* name, const char* value, std::string& set) {
  if (std::getenv(name) != nullptr || setenv(name, value, 0) != 0) return;
  set += std::string(set.empty() ? "" : " ") + name;
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

std::string variables_set_here() {
  const char* names = std::getenv(kGuard);
  return names == nullptr ? "" : names;
}

void use_right_blas_kernels(char** argv) {
  if (std::getenv(kGuard) != nullptr) return;
  // OpenBLAS and the OpenMP library read these only while they are loaded, before main.
  const bool loaded =
      dlsym(RTLD_DEFAULT, "openblas_get_corename") != nullptr || dlsym(RTLD_DEFAULT, "omp_get_max_threads") != nullptr;
  std::string set;
  set_unless_given("OPENBLAS_NUM_THREADS", "1", set);
  set_unless_given("OMP_NUM_THREADS", "1", set);
  // CHOLMOD opens OpenMP regions with a thread count of its own: only the limit stops them.
  set_unless_given("OMP_THREAD_LIMIT", "1", set);
  const std::string kernels = blas_kernels();
  const char* core = kernels.empty() ? nullptr : better_core_type(kernels, has_avx2(), has_avx512());
  if (core != nullptr) set_unless_given("OPENBLAS_CORETYPE", core, set);
  if (set.empty() || setenv(kGuard, (set + " " + kGuard).c_str(), 1) != 0 || !loaded) return;
  execv("/proc/self/exe", argv);
  // Not possible here (no /proc): the right answer, only slower.
}

}  // namespace palpate::cli
