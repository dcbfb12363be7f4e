// SPDX-License-Identifier: MIT
// Values in their order from one thread to another, where the writer may not wait: what finds no room is refused.
#pragma once

#include <atomic>
#include <cstddef>
#include <type_traits>
#include <vector>

namespace palpate::device {

/// One writer, one reader; both calls take bounded time. Allocates when it is made.
template <class T>
class Ring {
  static_assert(std::is_trivially_copyable_v<T>);
  static_assert(std::atomic<std::size_t>::is_always_lock_free);

public:
  /// Room for `capacity` values, at least 1.
  explicit Ring(std::size_t capacity) : slots_(capacity) {}

  /// By the writer alone: false, and nothing is kept, where there is no room.
  bool put(const T& value) {
    const std::size_t end = end_.load(std::memory_order_relaxed);
    if (end - begin_.load(std::memory_order_acquire) == slots_.size()) return false;
    slots_[end % slots_.size()] = value;
    end_.store(end + 1, std::memory_order_release);
    return true;
  }

  /// By the reader alone: takes up to `most` values; how many.
  std::size_t take(T* values, std::size_t most) {
    const std::size_t begin = begin_.load(std::memory_order_relaxed);
    const std::size_t there = end_.load(std::memory_order_acquire) - begin;
    const std::size_t count = there < most ? there : most;
    for (std::size_t k = 0; k < count; ++k) values[k] = slots_[(begin + k) % slots_.size()];
    begin_.store(begin + count, std::memory_order_release);
    return count;
  }

private:
  std::vector<T> slots_;
  // Counts that only grow, each on a cache line of its own.
  alignas(64) std::atomic<std::size_t> begin_{0};
  alignas(64) std::atomic<std::size_t> end_{0};
};

}  // namespace palpate::device
