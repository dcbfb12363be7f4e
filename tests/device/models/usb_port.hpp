// SPDX-License-Identifier: GPL-3.0-or-later
// The port of a model: every transfer of a front end goes through it, and so do the faults that tests inject.
#pragma once

#include "tests/device/models/usb_model.hpp"

#include <atomic>
#include <deque>
#include <functional>
#include <mutex>
#include <vector>

namespace palpate::test {

/// How a transfer ends, or that it has not ended yet (the device answers NAK).
enum class Answer { done, pending, stalled, gone };

/// Faults of packets in transit to the host.
struct PacketFault {
  enum class Kind {
    none,
    shorter,  ///< its last bytes are missing
    split,    ///< it comes in two
    garbled,  ///< other bytes, another size
    late      ///< after `delay`
  };
  Kind kind = Kind::none;
  int packets = 1 << 30;  ///< so many of them
  double delay = 0;       ///< s
};

/// A transfer from the host that the device took.
struct Written {
  double time = 0;  ///< s
  Bytes bytes;
};

/// Calls are from any thread; times are s on one clock.
class UsbPort {
public:
  explicit UsbPort(UsbModel& model) : model_(model) {}

  // Faults.
  void packets(const PacketFault& fault);
  void stall_input() { set(halted_in_, true); }  ///< halts the endpoint: until the host clears it
  void stall_output() { set(halted_out_, true); }
  void silence() { set(silent_, true); }           ///< nothing for the host any more
  void deafen(bool on = true) { set(deaf_, on); }  ///< takes nothing: every transfer to it waits
  void unplug() { set(gone_, true); }
  void unplug_in_transfer() { leaving_ = true; }  ///< while the next transfer to it is under way

  /// Plugs the model in, without faults.
  void plug(double time);

  // The front end's side.
  [[nodiscard]] UsbShape shape() const { return model_.shape(); }
  Answer control(double time, const ControlRequest& request, Bytes& reply);
  Answer written(double time, const Bytes& bytes);
  Answer read(double time, Bytes& packet);
  /// CLEAR_FEATURE(ENDPOINT_HALT).
  void clear_halt(std::uint8_t endpoint);
  /// When read() may have something (s).
  [[nodiscard]] double due() const;
  [[nodiscard]] bool gone() const { return gone_; }
  /// Called after every change that may end a pending transfer.
  void on_change(std::function<void()> call);

  // The test's side.
  [[nodiscard]] std::vector<Written> log() const;
  /// Runs `work` while no transfer does.
  template <class Work>
  auto with_model(Work work) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return work();
  }

private:
  void set(std::atomic<bool>& state, bool on);

  struct Waiting {
    double time;
    Bytes bytes;
  };

  UsbModel& model_;
  mutable std::mutex mutex_;
  std::mutex call_mutex_;
  std::function<void()> call_;
  PacketFault fault_;
  std::deque<Waiting> waiting_;  // packets held back
  std::vector<Written> log_;
  std::uint32_t noise_ = 1;
  std::atomic<bool> halted_in_{false}, halted_out_{false}, silent_{false}, deaf_{false}, leaving_{false}, gone_{false};
};

}  // namespace palpate::test
