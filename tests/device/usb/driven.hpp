// SPDX-License-Identifier: GPL-3.0-or-later
// An open device of any kind, and the force loop above it.
#pragma once

#include "device/usb/usb_device.hpp"

#include <chrono>
#include <memory>
#include <thread>

namespace palpate::test {

inline void pause(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

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

  /// The force loop, at about 1 kHz for so long (s), or until the device stops, or until `enough` says so.
  template <class Enough>
  device::Sample drive(double seconds, const device::Vec3& force, const Enough& enough) {
    device::Sample sample = device->read();
    const double end = device::now() + seconds;
    while (device::now() < end && sample.phase != device::Phase::stopped && !enough()) {
      device->write({device::now(), force, {}});
      pause(0.001);
      sample = device->read();
    }
    return sample;
  }
  device::Sample drive(double seconds, const device::Vec3& force) {
    return drive(seconds, force, [] { return false; });
  }

  device::UsbDevice::Opened opened;
  std::unique_ptr<device::UsbDevice> device;
};

}  // namespace palpate::test
