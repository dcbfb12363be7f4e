// SPDX-License-Identifier: MIT
// The haptic devices that Palpate knows, with their limits as data.
#pragma once

#include <cstddef>
#include <cstdint>

namespace palpate::device {

/// One kind of device. Figures are the makers' nominal ones; 0 where none is known.
struct DeviceKind {
  const char* name;
  std::uint16_t vendor;     ///< USB vendor id
  std::uint16_t product;    ///< USB product id
  double peak_force;        ///< N
  double stiffness;         ///< N/m, largest that the maker states as stable
  double workspace_radius;  ///< m
  double watchdog;          ///< s after which the device itself lets go; 0: it has none that is known
};

inline constexpr DeviceKind kDevices[] = {
    {"WoodenHaptics (mbed board)", 0x1234, 0x0006, 5.0, 1000.0, 0.0, 0.5},
    {"WoodenHaptics (Teensy board)", 0x16c0, 0x0486, 5.0, 1000.0, 0.0, 0.5},
    {"Novint Falcon", 0x0403, 0xcb48, 8.0, 3000.0, 0.04, 0.0},
};

/// The kind with these ids, or null.
inline const DeviceKind* find_kind(std::uint16_t vendor, std::uint16_t product) {
  for (const DeviceKind& kind : kDevices) {
    if (kind.vendor == vendor && kind.product == product) return &kind;
  }
  return nullptr;
}

}  // namespace palpate::device
