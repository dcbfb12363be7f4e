// SPDX-License-Identifier: MIT
// The latest value from one thread to another, where neither may wait: poses to a search, searches to a force loop.
#pragma once

#include <atomic>
#include <cstdint>
#include <type_traits>

namespace palpate::runtime {

/// One writer, one reader. Of three copies the writer owns one, the reader one, and the third goes back and forth, so
/// both calls take bounded time (one atomic exchange), and a value is read whole or not at all. Values may be skipped,
/// never go back.
template <class T>
class Latest {
  static_assert(std::is_trivially_copyable_v<T>, "values are copied while another thread runs");
  static_assert(std::atomic<std::uint8_t>::is_always_lock_free);

public:
  /// By the writer alone.
  void write(const T& value) {
    slots_[writing_] = value;
    // Release: the reader that takes this slot sees the value. Acquire: the slot that comes back is no longer read.
    writing_ = between_.exchange(static_cast<std::uint8_t>(writing_ | kFresh), std::memory_order_acq_rel) & kSlot;
  }

  /// By the reader alone: sets `value` to the latest one if it has not been read; false, and nothing is changed, else.
  bool read(T& value) {
    if ((between_.load(std::memory_order_relaxed) & kFresh) == 0) return false;
    reading_ = between_.exchange(reading_, std::memory_order_acq_rel) & kSlot;
    value = slots_[reading_];
    return true;
  }

private:
  static constexpr std::uint8_t kSlot = 3, kFresh = 4;

  T slots_[3] = {};
  std::uint8_t writing_ = 0, reading_ = 1;  // of one thread each
  std::atomic<std::uint8_t> between_{2};
};

}  // namespace palpate::runtime
