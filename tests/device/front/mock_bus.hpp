// SPDX-License-Identifier: GPL-3.0-or-later
// Front end A: a mock /sys and /dev by umockdev, where libusb finds devices, opens them, and sees them come and go.
// Under umockdev-wrapper only. Its polls always say ready, so the driver's thread never rests: no place for figures of
// speed.
#pragma once

#include "tests/device/models/usb_port.hpp"

#include <memory>

namespace palpate::test {

/// Programs have closed their devices before it ends; its ports live longer.
class MockBus {
public:
  /// Whether this process runs under umockdev-wrapper.
  static bool possible();

  MockBus();
  ~MockBus();
  MockBus(const MockBus&) = delete;
  MockBus& operator=(const MockBus&) = delete;

  /// Plugs the port in at an address of bus 1 that no other had: its device file, then the event.
  void plug(UsbPort& port, int address);
  /// Pulls it out: what is pending ends, the file answers ENODEV, the event, no file.
  void unplug(int address);

  /// UsbfsCalls::take() and claimed(), of what is plugged in there.
  void take(int address);
  [[nodiscard]] bool claimed(int address) const;

private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace palpate::test
