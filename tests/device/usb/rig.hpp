// SPDX-License-Identifier: GPL-3.0-or-later
// A WoodenHaptics model on an emulated bus, opened by the driver through libusb.
#pragma once

#include "device/wooden_haptics/wooden_protocol.hpp"
#include "tests/device/front/usbfs.hpp"
#include "tests/device/models/usb_port.hpp"
#include "tests/device/models/wooden_model.hpp"
#include "tests/device/usb/driven.hpp"
#include "tests/device/usb/emulated.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

namespace palpate::test {

/// mA in a command's bytes.
inline std::array<int, 3> milliamps(const Bytes& bytes) {
  const auto word = [&](std::size_t at) {
    return static_cast<std::int16_t>(static_cast<std::uint16_t>(bytes.at(at) | bytes.at(at + 1) << 8));
  };
  return {word(0), word(2), word(4)};
}

inline bool is_zero(const Bytes& bytes) {
  return std::all_of(bytes.begin(), bytes.end(), [](std::uint8_t byte) { return byte == 0; });
}

struct Rig : Driven {
  explicit Rig(const device::UsbOptions& options = {}, const device::WoodenOptions& wooden = quick_homing()) {
    plug();
    open(options, wooden);
  }
  ~Rig() { device.reset(); }

  void plug() {
    usbfs = nullptr;  // one after the other: they share the port
    usbfs = std::make_unique<Usbfs>(port);
  }
  void open(const device::UsbOptions& options = {}, const device::WoodenOptions& wooden = quick_homing()) {
    opened = device::UsbDevice::adopt(usbfs->descriptor(), device::kDevices[0],
                                      std::make_unique<device::WoodenProtocol>(wooden), options);
    device = std::move(opened.device);
  }

  /// The last command other than zero; all zero: there was none.
  [[nodiscard]] std::array<int, 3> last_push() const {
    const std::vector<Written> log = port.log();
    const auto last = std::find_if(log.rbegin(), log.rend(), [](const Written& each) { return !is_zero(each.bytes); });
    return last == log.rend() ? std::array<int, 3>{} : milliamps(last->bytes);
  }

  WoodenModel model;
  UsbPort port{model};
  std::unique_ptr<Usbfs> usbfs;
};

}  // namespace palpate::test
