// SPDX-License-Identifier: GPL-3.0-or-later
// The drivers, each with the model of its device, as tests see them that are the same for all: what a hand does with
// the device, what can go wrong in it, and what its motors do.
#pragma once

#include "device/registry/registry.hpp"
#include "tests/device/models/usb_model.hpp"

#include <memory>
#include <string>
#include <vector>

namespace palpate::test {

/// Homes in 50 ms: tests have no hands to wait for. Patient with a machine that has other things to do, where
/// `patient`.
device::WoodenOptions quick_homing(bool patient = true);

/// While it is plugged in, change or read its model only while no transfer runs (UsbPort::with_model).
class Emulated {
public:
  virtual ~Emulated() = default;
  [[nodiscard]] virtual const device::DeviceKind& kind() const = 0;
  virtual UsbModel& model() = 0;
  /// Options of its driver; patient as in quick_homing().
  [[nodiscard]] virtual device::DriverOptions options(bool patient) const = 0;
  /// m: where the grip is once it is homed, in the device's frame.
  [[nodiscard]] virtual device::Vec3 tip() const = 0;

  // Actions of a hand.
  virtual void lose() = 0;    ///< as after its power came on: its origin is not known, and nobody homes it
  virtual void home() = 0;    ///< homes it
  virtual void settle() = 0;  ///< as it is between two programs: whoever opens it is soon ready

  // Faults of the device.
  virtual void mute() = 0;            ///< it says nothing new any more; the wire goes on
  virtual void wrap_encoder() = 0;    ///< a counter of 16 bits is half a turn off
  virtual void lose_origin() {}       ///< it says that it has lost it
  virtual void overheat() {}          ///< it says that its motors must not be driven
  virtual void wrong_firmware() = 0;  ///< from when it is next plugged in: another one than the driver's

  // State of its motors.
  /// Whether these bytes, written to it, are a command with a force.
  [[nodiscard]] virtual bool pushes(const Bytes& written) const = 0;
  /// Whether they say this force (N), where the grip is now.
  [[nodiscard]] virtual bool says(const Bytes& written, const device::Vec3& force) const = 0;
  /// Whether its motors have a force at `time` (s, not before its last command) if nothing else reaches it until then.
  virtual bool holds_a_force(double time) = 0;
};

/// By the names of the registry: wooden, falcon, open-link.
std::unique_ptr<Emulated> emulated(const std::string& driver);

/// All of them.
inline constexpr const char* kDrivers[] = {"wooden", "falcon", "open-link"};

}  // namespace palpate::test
