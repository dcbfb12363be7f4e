// SPDX-License-Identifier: MIT
// The I/O thread of a USB device: input always queued, commands at absolute times, zero at the end.
#pragma once

#include "device/usb/usb_link.hpp"
#include "palpate/threading/triple_buffer.hpp"

#include <poll.h>

#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace palpate::device {

/// Owns the link and the protocol. All but the mailboxes, stop() and counts() belongs to its thread once that runs.
class UsbLoop {
public:
  UsbLoop(std::unique_ptr<UsbLink> link, std::unique_ptr<Protocol> protocol, const DeviceKind& kind,
          const UsbOptions& options);
  ~UsbLoop();
  UsbLoop(const UsbLoop&) = delete;
  UsbLoop& operator=(const UsbLoop&) = delete;

  /// Begins; false with the cause when the system has no timers or memory left.
  bool start(std::string& error);
  /// Sends zero, lets go, ends the thread. Again: nothing.
  void stop();
  [[nodiscard]] UsbCounts counts() const noexcept;

  runtime::TripleBuffer<Command> commands;  ///< written by the force loop
  runtime::TripleBuffer<Sample> samples;    ///< read by the force loop

private:
  static void LIBUSB_CALL input_ended(libusb_transfer* transfer);
  static void LIBUSB_CALL output_ended(libusb_transfer* transfer);
  static void LIBUSB_CALL zero_ended(libusb_transfer* transfer);

  void run();
  void begin();
  void step(double time);
  void period(double time);
  void issue(double time, const Request& request);
  /// Fills and submits; libusb's error code.
  int submit(libusb_transfer* transfer, unsigned char* bytes, const Request& request, libusb_transfer_cb_fn ended);
  /// Waits for an event of libusb, stop(), or until `time`.
  void wait(double time);
  void pump();
  /// Handles events until `done` or `time`.
  template <class Done>
  void pump_until(double time, Done done);
  void let_go();
  void call_back();
  void note(Fault fault);
  void publish();
  [[nodiscard]] bool ready() const;
  [[nodiscard]] double wake_time() const;
  [[nodiscard]] double write_limit() const;

  static constexpr double kLetGo = 0.010;  // s for a zero to leave
  static constexpr std::size_t kOutput = LIBUSB_CONTROL_SETUP_SIZE + Request::kMost;

  std::unique_ptr<UsbLink> link_;
  std::unique_ptr<Protocol> protocol_;
  DeviceKind kind_;
  UsbOptions options_;
  double period_;

  std::vector<libusb_transfer*> inputs_;
  std::vector<unsigned char> input_bytes_;
  libusb_transfer* output_ = nullptr;
  libusb_transfer* zero_ = nullptr;
  unsigned char output_bytes_[kOutput] = {}, zero_bytes_[kOutput] = {};
  int queued_ = 0;  // transfers of input that libusb has
  int errors_ = 0;  // of input in a row
  bool sending_ = false, called_back_ = false, zeroing_ = false, halted_ = false;
  Outcome zero_outcome_ = Outcome::timed_out;
  bool ending_ = false;  // nothing is submitted any more

  Command command_{-1e9, {}, {}};
  double sent_ = 0, tick_ = 0, until_ = 0;
  bool again_ = false;  // something happened, so the protocol's next() must be called
  Fault fault_ = Fault::none;
  Sample published_;

  std::vector<pollfd> events_;
  int timer_ = -1, wake_ = -1;
  std::atomic<bool> stop_{false};
  std::thread thread_;
  std::atomic<std::uint64_t> periods_{0}, late_{0}, blocked_{0}, stale_{0}, packets_{0};
  std::atomic<bool> zero_left_{false}, realtime_{false};
};

}  // namespace palpate::device
