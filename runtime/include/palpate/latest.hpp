// SPDX-License-Identifier: MIT
// The latest value from one thread to another, where neither may wait: poses to a search, searches to a force loop.
#pragma once

#include <atomic>
#include <cstdint>
#include <type_traits>

namespace palpate::runtime {

/// Slots, by their numbers below 4, that go from one writer to one reader and back: the writer owns one, the reader the
/// others, and one lies between them. Both calls take bounded time (one atomic exchange). Slots may be skipped, never
/// go back.
class Exchange {
  static_assert(std::atomic<std::uint8_t>::is_always_lock_free);

public:
  Exchange(std::uint8_t writing, std::uint8_t between) : writing_(writing), between_(between) {}

  /// The writer's own slot.
  [[nodiscard]] std::uint8_t writing() const { return writing_; }

  /// By the writer alone: gives its slot away and gets another.
  void publish() {
    // Release: the reader that takes this slot sees what is in it. Acquire: the slot that comes back is no longer read.
    writing_ = between_.exchange(static_cast<std::uint8_t>(writing_ | kFresh), std::memory_order_acq_rel) & kSlot;
  }

  /// By the reader alone: gives `slot` back for the newest; false, and nothing is changed, where it has that already.
  bool take(std::uint8_t& slot) {
    if ((between_.load(std::memory_order_relaxed) & kFresh) == 0) return false;
    slot = between_.exchange(slot, std::memory_order_acq_rel) & kSlot;
    return true;
  }

private:
  static constexpr std::uint8_t kSlot = 3, kFresh = 4;

  std::uint8_t writing_;  // of the writer's thread
  std::atomic<std::uint8_t> between_;
};

/// One writer, one reader, and a value that is read whole or not at all. Values may be skipped, never go back.
template <class T>
class Latest {
  static_assert(std::is_trivially_copyable_v<T>, "values are copied while another thread runs");

public:
  /// By the writer alone.
  void write(const T& value) {
    slots_[exchange_.writing()] = value;
    exchange_.publish();
  }

  /// By the reader alone: sets `value` to the latest one if it has not been read; false, and nothing is changed, else.
  bool read(T& value) {
    if (!exchange_.take(reading_)) return false;
    value = slots_[reading_];
    return true;
  }

private:
  T slots_[3] = {};
  std::uint8_t reading_ = 1;  // of the reader's thread
  Exchange exchange_{0, 2};
};

}  // namespace palpate::runtime
