// SPDX-License-Identifier: MIT
// Writes the recording of a run while it goes on, in a thread of its own.
#pragma once

#include "device/loop/ring.hpp"
#include "device/loop/tick_sink.hpp"
#include "device/recording/run_hand.hpp"
#include "device/recording/run_record.hpp"

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <thread>

namespace palpate::device {

/// The result of a recording.
struct RunWritten {
  std::uint64_t ticks = 0;    ///< given to put()
  std::uint64_t dropped = 0;  ///< of these not in the file: the disk was too slow, or refused
  std::string error;          ///< why the disk refused; empty: it did not
};

/// put() is for the force loop, everything else for the thread that made the writer.
class RunWriter : public TickSink {
public:
  /// Creates or replaces the file, unless another writer has it, and starts the thread; error() says whether that went
  /// well. `hand`: of a glove's run. `capacity`: ticks that wait for a slow disk.
  RunWriter(const std::string& path, RunHeader header, const std::optional<RunHand>& hand = {},
            std::size_t capacity = std::size_t{1} << 14);
  ~RunWriter() override;  ///< finishes
  RunWriter(const RunWriter&) = delete;
  RunWriter& operator=(const RunWriter&) = delete;

  /// Why the file could not be made; empty: it was.
  [[nodiscard]] const std::string& error() const { return open_error_; }

  /// Never waits: what finds no room is dropped and counted.
  void put(const RunTick& tick) noexcept;
  void put(const TickInput& seen, const TickOutput& out) noexcept override { put(to_tick(seen, out)); }

  /// Counted so far.
  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }

  /// After the last put(): writes what waits and the end, and closes. Again: the same answer.
  const RunWritten& finish();

private:
  void drain();
  std::size_t write(const void* bytes, std::size_t size);

  Ring<RunTick> ring_;
  bool glove_;
  int file_ = -1;
  std::string open_error_;
  RunWritten result_;  // error: of the thread until it is joined
  std::atomic<std::uint64_t> ticks_{0}, dropped_{0};
  std::atomic<bool> finishing_{false};
  std::thread thread_;
};

}  // namespace palpate::device
