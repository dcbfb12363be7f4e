// SPDX-License-Identifier: GPL-3.0-or-later
// Plugs in an emulated device and opens its driver: the common interface of the two front ends.
#pragma once

#include "device/registry/registry.hpp"
#include "tests/device/models/usb_port.hpp"

#include <memory>

namespace palpate::test {

/// One socket. An opened device is closed before the next plug() and before the socket's end.
class Front {
public:
  virtual ~Front() = default;
  virtual void plug(UsbPort& port) = 0;
  /// Pulls out what was plugged in last.
  virtual void unplug() = 0;
  /// Opens it with the driver that the registry has for its kind; found by name where the front end is found at all.
  virtual device::UsbDevice::Opened open(const device::DeviceKind& kind, const device::DriverOptions& drivers,
                                         const device::UsbOptions& options) = 0;

  /// Another program has the interface of what is plugged in.
  virtual void take() = 0;
  /// Whether the driver has it.
  [[nodiscard]] virtual bool claimed() const = 0;

  /// Transfers take no longer than on a bus: times mean something.
  [[nodiscard]] virtual bool is_prompt() const = 0;
};

/// The front end that this executable is linked with; null where it cannot be here: tests are skipped.
std::unique_ptr<Front> make_front();

}  // namespace palpate::test
