// SPDX-License-Identifier: MIT
// The force loop: at each tick the device's newest sample in, a command out, by absolute time. SAFETY.md says what
// happens when something goes wrong.
#pragma once

#include "device/loop/clock.hpp"
#include "device/loop/histogram.hpp"
#include "device/loop/realtime.hpp"
#include "device/loop/safety_controller.hpp"
#include "device/loop/stop_flags.hpp"
#include "device/loop/tick_sink.hpp"
#include "palpate/threading/triple_buffer.hpp"

#include <atomic>
#include <thread>

namespace palpate::device {

struct LoopOptions {
  SafetyLimits safety;
  RealtimeOptions realtime;
  double seconds = 0;  ///< s after which a stop is requested; 0: none

  /// Null, or what is wrong.
  [[nodiscard]] const char* validate() const;
};

/// The state of a loop, and its counts since it began. Copied as it is.
struct LoopReport {
  TickInput seen;  ///< of the last tick
  TickOutput out;
  double elapsed = 0;     ///< s
  double peak_force = 0;  ///< N, of a command (Command::strength())
  std::uint64_t ticks = 0;
  std::uint64_t missed = 0;       ///< deadlines
  std::uint64_t late_ticks = 0;   ///< that came later after the last one than the safety controller's gap
  std::uint64_t stale_ticks = 0;  ///< without force because the sample was too old
  std::uint64_t suspensions = 0;  ///< times that a force was taken away without a requested stop
  Histogram period;               ///< between two ticks
  Histogram late;                 ///< from when a tick was due to when its sample had been read
  Histogram age;                  ///< of the sample, while the device was ready

  /// Hz over the whole run.
  [[nodiscard]] double rate() const { return elapsed > 0 ? static_cast<double>(ticks) / elapsed : 0; }
};

/// A command is due by the time that the next tick is; one that comes later has missed its deadline, and the ticks that
/// were due meanwhile are left out, not made up for. In a tick the loop itself allocates nothing, takes no lock and
/// makes no system call but the sleep (reading CLOCK_MONOTONIC is none where the kernel's vDSO has it).
class ForceLoop {
public:
  /// All references must outlive the loop. The options must be valid. `record`: null for none.
  ForceLoop(Device& device, ForceSource& source, const LoopOptions& options, StopFlags& stop,
            TickSink* record = nullptr, Clock& clock = system_clock());
  ~ForceLoop();  ///< requests an emergency stop if it still runs, and waits
  ForceLoop(const ForceLoop&) = delete;
  ForceLoop& operator=(const ForceLoop&) = delete;

  /// Runs in a thread of its own; what the system granted it. Once.
  Realtime start();

  /// The same in the calling thread, without a request to the system; returns when the loop has stopped.
  void run() noexcept;

  [[nodiscard]] bool running() const noexcept { return running_.load(std::memory_order_acquire); }

  /// Waits for the thread's end.
  void join();

  /// By one thread at a time: the newest report, 32 ticks old at most while the loop runs; the last one after.
  const LoopReport& report();

private:
  static constexpr std::uint32_t kPublish = 32;  // ticks between two reports

  void account(const TickInput& seen, const TickOutput& out, std::uint32_t missed, double elapsed) noexcept;

  Device& device_;
  ForceSource& source_;
  LoopOptions options_;
  StopFlags& stop_;
  TickSink* record_;
  Clock& clock_;
  SafetyController controller_;
  double period_;        // s
  LoopReport counted_;   // of the loop's thread
  LoopReport reported_;  // of the thread that calls report()
  runtime::TripleBuffer<LoopReport> latest_;
  std::atomic<bool> running_{false};
  std::thread thread_;
};

}  // namespace palpate::device
