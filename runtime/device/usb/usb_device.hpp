// SPDX-License-Identifier: MIT
// A haptic device over libusb 1.0, whatever language it speaks.
#pragma once

#include "device/usb/protocol.hpp"

#include <cstdint>
#include <memory>
#include <string>

namespace palpate::device {

struct UsbOptions {
  double rate = 1000;          ///< Hz of commands once the device is ready, 10 to 20000
  double write_limit = 0.005;  ///< s that a command may take to leave; then it is called back. Above 0, at most kStale
  int inputs = 8;              ///< transfers of input that are always queued, 2 to 64
  int priority = 0;  ///< SCHED_FIFO priority of the I/O thread, 1 to 99, where permitted; 0: an ordinary thread

  /// The first invalid value, with its range, or null.
  [[nodiscard]] const char* validate() const;
};

/// Bus and address of a device; 0, 0: the first of its kind.
struct UsbPlace {
  std::uint8_t bus = 0, address = 0;
};

/// Counts of the I/O thread since the device was opened.
struct UsbCounts {
  std::uint64_t periods = 0;  ///< of the loop since it was ready
  std::uint64_t late = 0;     ///< of those: passed over, for the thread woke too late
  std::uint64_t blocked = 0;  ///< of those: without a command, for the last one had not left
  std::uint64_t stale = 0;    ///< of those: with zero for the force loop's command, which was too old
  std::uint64_t packets = 0;  ///< of input
  bool zero_left = false;     ///< the device took the zero that a fault or close() sends
  bool realtime = false;      ///< the requested priority was granted
};

class UsbLoop;
struct LinkResult;

/// An open device with an I/O thread of its own. Everything libusb does (its locks, its allocations) happens there;
/// read() and write() exchange one value each with it through runtime::Latest. Forces go out at the rate of the
/// options, the newest each time, until the device is closed, a fault ends it, or they are older than kStale: then zero
/// goes out. After a fault close() it and open it again; what was found out about its origin is gone.
class UsbDevice final : public Device {
public:
  struct Opened {
    std::unique_ptr<UsbDevice> device;  ///< null: see below
    Fault fault = Fault::none;          ///< unplugged: there is none; refused: there is one, but
    std::string error;                  ///< what libusb says
  };

  /// Opens the device of this kind at this place; takes it from a kernel driver where one holds it. Not for a force
  /// loop.
  static Opened open(const DeviceKind& kind, UsbPlace place, std::unique_ptr<Protocol> protocol,
                     const UsbOptions& options = {});

  /// The same with a usbfs file descriptor that someone else opened (a broker, Android) and closes after close().
  static Opened adopt(int descriptor, const DeviceKind& kind, std::unique_ptr<Protocol> protocol,
                      const UsbOptions& options = {});

  ~UsbDevice() override;
  UsbDevice(const UsbDevice&) = delete;
  UsbDevice& operator=(const UsbDevice&) = delete;

  [[nodiscard]] const DeviceKind& kind() const override { return kind_; }
  Sample read() noexcept override;
  void write(const Command& command) noexcept override;
  void close() override;

  /// At any time, from any thread.
  [[nodiscard]] UsbCounts counts() const noexcept;

private:
  UsbDevice(const DeviceKind& kind, std::unique_ptr<UsbLoop> loop);
  static Opened run(LinkResult link, const DeviceKind& kind, std::unique_ptr<Protocol> protocol,
                    const UsbOptions& options);

  DeviceKind kind_;
  std::unique_ptr<UsbLoop> loop_;
  Sample seen_;
};

}  // namespace palpate::device
