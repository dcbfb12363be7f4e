// SPDX-License-Identifier: GPL-3.0-or-later
// A driver and its emulated device at the front end that this executable is linked with: what tests of every driver do.
#pragma once

#include "tests/device/front/front.hpp"
#include "tests/device/usb/driven.hpp"
#include "tests/device/usb/emulated.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace palpate::test {

struct Station : Driven {
  explicit Station(const std::string& driver) : subject(emulated(driver)) {}
  ~Station() { device.reset(); }

  /// Power comes on: settled as between two programs, or unknown to itself.
  void plug(bool settled) {
    device.reset();
    front->plug(port);
    port.with_model([&] { settled ? subject->settle() : subject->lose(); });
  }

  bool open(bool patient = true) {
    device::UsbOptions options;
    // As prompt as is permitted, but where the thread never rests.
    options.priority = front->is_prompt() ? 80 : 0;
    opened = front->open(subject->kind(), subject->options(patient), options);
    device = std::move(opened.device);
    return device != nullptr;
  }

  /// Drives until the motors have a force (or for `seconds`); its sample.
  device::Sample push(const device::Vec3& force, double seconds = 5) {
    return drive(seconds, force, [&] { return holds_a_force(device::now()); });
  }

  bool holds_a_force(double time) {
    return port.with_model([&] { return subject->holds_a_force(time); });
  }

  /// How many commands with a force the device has taken since `time` (s).
  [[nodiscard]] int pushes_since(double time) const {
    const std::vector<Written> log = port.log();
    return static_cast<int>(std::count_if(
        log.begin(), log.end(), [&](const Written& each) { return each.time > time && subject->pushes(each.bytes); }));
  }

  /// Whether it stopped for no other reason than that the machine, with other things to do, held this program up.
  bool held_up(const device::Sample& sample) {
    using device::Fault;
    was_held_up =
        sample.phase == device::Phase::stopped && (sample.fault == Fault::silent || sample.fault == Fault::host_late);
    return was_held_up;
  }

  std::unique_ptr<Emulated> subject;
  UsbPort port{subject->model()};
  std::unique_ptr<Front> front = make_front();
  bool was_held_up = false;
};

/// Tests of every driver; skipped where there is no front end.
class UsbDrivers : public testing::TestWithParam<const char*> {
protected:
  void SetUp() override {
    if (!make_front()) GTEST_SKIP() << "runs under umockdev-wrapper only";
  }

  /// Runs `trial` at new stations until the machine holds one up no more.
  template <class Trial>
  static void once_undisturbed(const Trial& trial) {
    constexpr int kTrials = 20;
    for (int k = 0; k < kTrials; ++k) {
      Station station(GetParam());
      trial(station);
      if (!station.was_held_up || HasFailure()) return;
    }
    ADD_FAILURE() << "the machine held up each of " << kTrials << " trials";
  }
};

inline std::string test_name(std::string driver) {
  std::replace(driver.begin(), driver.end(), '-', '_');
  return driver;
}

}  // namespace palpate::test
