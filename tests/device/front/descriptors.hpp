// SPDX-License-Identifier: GPL-3.0-or-later
// The descriptors by which a model is enumerated: device, configuration, interface, two endpoints.
#pragma once

#include "tests/device/models/usb_model.hpp"

namespace palpate::test {

/// As the kernel gives them to user programs (USB 2.0, section 9.6).
inline Bytes descriptors(const UsbShape& s) {
  const auto low = [](std::uint16_t word) { return static_cast<std::uint8_t>(word & 0xff); };
  const auto high = [](std::uint16_t word) { return static_cast<std::uint8_t>(word >> 8); };
  const std::uint8_t type = s.interrupt ? 3 : 2, interval = s.interrupt ? 1 : 0;
  const bool hid = s.interface_class == 3;
  const std::uint8_t total = hid ? 41 : 32;
  Bytes bytes = {18,
                 1,
                 0x00,
                 0x02,
                 0,
                 0,
                 0,
                 64,
                 low(s.vendor),
                 high(s.vendor),
                 low(s.product),
                 high(s.product),
                 0x00,
                 0x01,
                 0,
                 0,
                 0,
                 1,
                 9,
                 2,
                 total,
                 0,
                 1,
                 1,
                 0,
                 0x80,
                 50,
                 9,
                 4,
                 0,
                 0,
                 2,
                 s.interface_class,
                 0,
                 0,
                 0};
  // A HID interface says where its report descriptor is (HID 1.11, section 6.2.1).
  if (hid) bytes.insert(bytes.end(), {9, 0x21, 0x11, 0x01, 0, 1, 0x22, 27, 0});
  bytes.insert(bytes.end(), {7, 5, s.in, type, low(s.packet), high(s.packet), interval, 7, 5, s.out, type,
                             low(s.packet), high(s.packet), interval});
  return bytes;
}

}  // namespace palpate::test
