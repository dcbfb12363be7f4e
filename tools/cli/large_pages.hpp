// SPDX-License-Identifier: GPL-3.0-or-later
// Memory for what is read at random: a large file's responses are far apart, and each page costs a walk of its own.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdlib>
#include <limits>
#include <new>

namespace palpate::cli {

/// Allocates large blocks in pages of 2 MiB where the system has them (Linux: transparent huge pages, by madvise), else
/// as usual.
template <class T>
struct LargePages {
  using value_type = T;
  static constexpr std::size_t kPage = std::size_t{1} << 21;  ///< bytes

  LargePages() = default;
  template <class Other>
  LargePages(const LargePages<Other>& /*other*/) {}  // NOLINT(google-explicit-constructor): as allocators do

  [[nodiscard]] T* allocate(std::size_t count) {
    if (count > (std::numeric_limits<std::size_t>::max() - kPage) / sizeof(T)) throw std::bad_alloc();
    std::size_t bytes = count * sizeof(T), alignment = alignof(std::max_align_t);
    if (bytes >= kPage) alignment = kPage;
    bytes = (bytes + alignment - 1) / alignment * alignment;
    void* const memory = std::aligned_alloc(alignment, bytes > 0 ? bytes : alignment);
    if (memory == nullptr) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
    if (alignment == kPage) ::madvise(memory, bytes, MADV_HUGEPAGE);  // a wish: without it all is as before
#endif
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t /*count*/) { std::free(memory); }

  friend bool operator==(const LargePages&, const LargePages&) { return true; }
  friend bool operator!=(const LargePages&, const LargePages&) { return false; }
};

}  // namespace palpate::cli
