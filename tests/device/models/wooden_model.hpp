// SPDX-License-Identifier: GPL-3.0-or-later
// A WoodenHaptics board: it reports its encoders by itself, obeys currents, and lets go after half a second without
// any.
#pragma once

#include "device/wooden_haptics/wooden_kinematics.hpp"
#include "tests/device/models/usb_model.hpp"

#include <cstdint>
#include <functional>

namespace palpate::test {

class WoodenModel final : public UsbModel {
public:
  static constexpr double kWatchdog = 0.5;  // s

  device::WoodenGeometry geometry;
  double period = 0.001;  ///< s between two reports
  /// rad, where the arm is at a time (s) since the board was plugged in.
  std::function<device::Joints(double)> motion = [](double) { return device::Joints{0, 0, 1.5707963267948966}; };
  bool six = false;     ///< has the firmware for six degrees of freedom: reports of 14 bytes
  bool frozen = false;  ///< says its last report again and again
  /// Counts of the encoders at the angles of zero: they wrap soon from here.
  std::int16_t offset[3] = {32700, -32760, 100};

  [[nodiscard]] UsbShape shape() const override { return {0x1234, 0x0006, 3, 0x81, 0x01, true, 64}; }
  void plugged(double time) override;
  bool control(double time, const ControlRequest& request, Bytes& reply) override;
  void written(double time, const Bytes& bytes) override;
  bool read(double time, Bytes& packet) override;
  [[nodiscard]] double due() const override { return next_; }

  /// All encoders are so many counts further from now on.
  void leap(int counts);
  /// mA in each motor at `time` (s): none after the watchdog.
  [[nodiscard]] std::array<int, 3> milliamps(double time) const;
  [[nodiscard]] device::Joints angles(double time) const { return motion(time - plugged_); }

private:
  std::array<int, 3> asked_{};
  double plugged_ = 0, next_ = 0, heard_ = -1e9;
  int leap_ = 0;
  std::uint16_t number_ = 0;
  Bytes last_;  // report
};

}  // namespace palpate::test
