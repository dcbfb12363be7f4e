// SPDX-License-Identifier: GPL-3.0-or-later
// Stands before the C library's own functions; in a file of its own, for nothing else may see them replaced.
#include "tests/device/usb/lock_counter.hpp"

#include <dlfcn.h>
#include <pthread.h>

#include <cstddef>

namespace {

// No constructor and no allocation of their own: they are counted in the middle of both.
__thread long locks = 0, mallocs = 0;

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

}  // namespace

// glibc's own allocator under its other names: dlsym() may itself allocate.
extern "C" void* __libc_malloc(std::size_t size);
extern "C" void* __libc_calloc(std::size_t count, std::size_t size);
extern "C" void* __libc_realloc(void* old, std::size_t size);

extern "C" void* malloc(std::size_t size) noexcept {
  ++mallocs;
  return __libc_malloc(size);
}

extern "C" void* calloc(std::size_t count, std::size_t size) noexcept {
  ++mallocs;
  return __libc_calloc(count, size);
}

extern "C" void* realloc(void* old, std::size_t size) noexcept {
  ++mallocs;
  return __libc_realloc(old, size);
}

extern "C" int pthread_mutex_lock(pthread_mutex_t* mutex) noexcept {
  static const auto real = next<int (*)(pthread_mutex_t*)>("pthread_mutex_lock");
  ++locks;
  return real(mutex);
}

extern "C" int pthread_cond_wait(pthread_cond_t* condition, pthread_mutex_t* mutex) {
  static const auto real = next<int (*)(pthread_cond_t*, pthread_mutex_t*)>("pthread_cond_wait");
  ++locks;
  return real(condition, mutex);
}

long palpate::test::locks_here() { return locks; }
long palpate::test::mallocs_here() { return mallocs; }
