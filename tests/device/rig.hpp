// SPDX-License-Identifier: GPL-3.0-or-later
// A WoodenHaptics model on an emulated bus, opened by the driver through libusb.
#pragma once

#include "device/usb_device.hpp"
#include "device/wooden_protocol.hpp"
#include "tests/device/front/usbfs.hpp"
#include "tests/device/models/usb_port.hpp"
#include "tests/device/models/wooden_model.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <thread>

namespace palpate::test {

inline void pause(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

/// Homes in 50 ms: tests have no hands to wait for. Patient with a machine that has other things to do, where
/// `patient`.
inline device::WoodenOptions quick_homing(bool patient = true) {
  device::WoodenOptions options;
  options.hold = 0.05;
  if (patient) {
    options.doubtful = 0.5;
    options.silence = 1;
  }
  return options;
}

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

/// A device of any kind and the force loop above it.
struct Driven {
  /// Until the device is in this phase, or stopped; false: not within `seconds`.
  bool reach(device::Phase phase, double seconds = 5) {
    const double end = device::now() + seconds;
    while (device::now() < end) {
      const device::Phase now = device->read().phase;
      if (now == phase) return true;
      if (now == device::Phase::stopped) return false;
      pause(0.001);
    }
    return false;
  }

  /// The force loop, at about 1 kHz for so long (s), or until the device stops.
  device::Sample drive(double seconds, const device::Vec3& force) {
    device::Sample sample = device->read();
    const double end = device::now() + seconds;
    while (device::now() < end && sample.phase != device::Phase::stopped) {
      device->write({device::now(), force, {}});
      pause(0.001);
      sample = device->read();
    }
    return sample;
  }

  device::UsbDevice::Opened opened;
  std::unique_ptr<device::UsbDevice> device;
};

struct Rig : Driven {
  explicit Rig(const device::UsbOptions& options = {}, const device::WoodenOptions& wooden = quick_homing()) {
    plug();
    open(options, wooden);
  }
  ~Rig() { device.reset(); }

  void plug() { usbfs = std::make_unique<Usbfs>(port); }
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
