// SPDX-License-Identifier: MIT
// Which driver speaks which device's language, and a device opened by what it is called.
#pragma once

#include "device/usb/enumerate.hpp"
#include "device/usb/usb_device.hpp"
#include "device/wooden_haptics/wooden_protocol.hpp"

#include <memory>
#include <string>
#include <string_view>

namespace palpate::device {

/// Options of the drivers; each reads its own part.
struct DriverOptions {
  WoodenOptions wooden;
  std::string falcon_firmware;  ///< path of the maker's file, for Falcons on which none runs yet; may be empty
};

struct Driver {
  const char* name;  ///< DeviceKind::driver of the kinds it speaks with
  /// Null with the cause where the options are wrong.
  std::unique_ptr<Protocol> (*make)(const DeviceKind& kind, const DriverOptions& options, std::string& error);
};

/// The driver of a kind, or null.
const Driver* find_driver(const DeviceKind& kind);

/// Opens the first plugged-in device that `name` may mean (is_called()); an empty name means any known one.
UsbDevice::Opened open_device(std::string_view name, const DriverOptions& drivers = {}, const UsbOptions& options = {});

}  // namespace palpate::device
