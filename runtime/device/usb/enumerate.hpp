// SPDX-License-Identifier: MIT
// Which known haptic devices are plugged in.
#pragma once

#include "device/device_table.hpp"

#include <string>
#include <vector>

namespace palpate::device {

struct FoundDevice {
  const DeviceKind* kind = nullptr;
  std::uint8_t bus = 0, address = 0;
};

struct Enumeration {
  bool ok = false;
  std::string error;               ///< libusb's own words when not ok
  std::vector<FoundDevice> found;  ///< in bus order
};

/// Asks libusb for the devices on every bus. Opens none of them; allocates; not for the force loop.
Enumeration enumerate();

}  // namespace palpate::device
