// SPDX-License-Identifier: MIT
// The supported haptic devices, with their limits as data.
#pragma once

#include "palpate/math/pose.hpp"

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace palpate::device {

/// One kind of device. Figures are the makers' nominal ones; 0 where none is known.
struct DeviceKind {
  const char* name;
  std::uint16_t vendor;         ///< USB vendor id
  std::uint16_t product;        ///< USB product id
  double peak_force;            ///< N
  double stiffness;             ///< N/m, largest that the maker states as stable
  double workspace_radius;      ///< m
  double watchdog;              ///< s after which the device itself lets go; 0: it has none that is known
  double continuous_force = 0;  ///< N that its motors stand for ever
  double rate = 0;              ///< Hz, most commands that the link takes
  const char* key = "";         ///< what a command line calls it; one of its own
  const char* driver = "";      ///< whose language it speaks: see registry.hpp
  runtime::Vec3 up{0, 0, 1};    ///< unit; its upward axis as it stands on a table, in its own frame
  bool glove = false;           ///< five fingers with a cable each instead of a handle with a force
};

inline constexpr runtime::Vec3 kYUp{0, 1, 0};  ///< of devices whose z axis comes towards the user

inline constexpr DeviceKind kDevices[] = {
    {"WoodenHaptics (mbed board)", 0x1234, 0x0006, 5.0, 1000.0, 0.1, 0.5, 0.0, 1000.0, "wooden-mbed", "wooden"},
    {"WoodenHaptics (Teensy board)", 0x16c0, 0x0486, 5.0, 1000.0, 0.1, 0.5, 0.0, 1000.0, "wooden-teensy", "wooden"},
    {"Novint Falcon", 0x0403, 0xcb48, 8.0, 3000.0, 0.04, 0.0, 0.0, 1000.0, "falcon", "falcon", kYUp},
    // Devices on the open link announce their limits, and the driver keeps to them; these are the link's own.
    {"Open link (test id)", 0x1209, 0x0001, 1000.0, 0.0, 0.0, 0.1, 0.0, 20000.0, "open-link", "open-link"},
};

/// The kind with these ids, or null.
inline const DeviceKind* find_kind(std::uint16_t vendor, std::uint16_t product) {
  for (const DeviceKind& kind : kDevices) {
    if (kind.vendor == vendor && kind.product == product) return &kind;
  }
  return nullptr;
}

/// Whether someone who writes `word` may mean this kind: its name, its key, or its driver.
inline bool is_called(const DeviceKind& kind, std::string_view word) {
  return !word.empty() && (word == kind.name || word == kind.key || word == kind.driver);
}

}  // namespace palpate::device
