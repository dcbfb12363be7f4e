// SPDX-License-Identifier: MIT
// Triple buffer: the newest value from one thread to another, without locks.
#pragma once

#include <atomic>
#include <cstdint>
#include <type_traits>

namespace palpate::runtime {

/// Exchanges slot numbers (0 to 3) between one writer and one reader, with one atomic exchange a call at most. The
/// writer owns one slot, one is in between, the reader owns the others. The reader may miss slots; their order is kept.
class SlotExchange {
  static_assert(std::atomic<std::uint8_t>::is_always_lock_free);

public:
  /// `writing`: the writer's first slot. `between`: the slot in between, which holds no value yet.
  SlotExchange(std::uint8_t writing, std::uint8_t between) : writing_(writing), between_(between) {}

  /// The writer's own slot.
  [[nodiscard]] std::uint8_t writing() const { return writing_; }

  /// Writer only: publishes the own slot and takes the slot in between.
  void publish() {
    // Release shows the contents to the reader. Acquire orders its reads of the returned slot before the next write.
    writing_ = between_.exchange(static_cast<std::uint8_t>(writing_ | kFresh), std::memory_order_acq_rel) & kSlot;
  }

  /// Reader only: replaces `slot` by the newest published slot. Returns false, and keeps `slot`, where none is new.
  bool take(std::uint8_t& slot) {
    if ((between_.load(std::memory_order_relaxed) & kFresh) == 0) return false;
    slot = between_.exchange(slot, std::memory_order_acq_rel) & kSlot;
    return true;
  }

private:
  static constexpr std::uint8_t kSlot = 3, kFresh = 4;

  std::uint8_t writing_;  ///< of the writer's thread
  std::atomic<std::uint8_t> between_;
};

/// Passes values from one writer thread to one reader thread. A value is read whole. The reader may miss values; their
/// order is kept.
template <class T>
class TripleBuffer {
  static_assert(std::is_trivially_copyable_v<T>, "T is not trivially copyable: values are copied between threads");

public:
  /// Writer only: makes `value` the newest.
  void write(const T& value) {
    slots_[exchange_.writing()] = value;
    exchange_.publish();
  }

  /// Reader only: copies the newest value. Returns false, and keeps `value`, where the newest was read before.
  bool read(T& value) {
    if (!exchange_.take(reading_)) return false;
    value = slots_[reading_];
    return true;
  }

private:
  T slots_[3] = {};
  std::uint8_t reading_ = 1;  ///< of the reader's thread
  SlotExchange exchange_{0, 2};
};

}  // namespace palpate::runtime
