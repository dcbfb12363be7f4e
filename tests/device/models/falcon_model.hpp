// SPDX-License-Identifier: GPL-3.0-or-later
// An emulated Novint Falcon: FTDI chip, loader, firmware, three encoders. It follows the public statements that the
// driver was written from and none of the driver's code but its kinematics and its packets.
#pragma once

#include "device/falcon/falcon_codec.hpp"
#include "device/falcon/falcon_kinematics.hpp"
#include "tests/device/models/usb_model.hpp"

#include <array>
#include <deque>
#include <utility>

namespace palpate::test {

class FalconModel final : public UsbModel {
public:
  /// Faults, from the moment they are set.
  struct Faults {
    bool mute = false;            ///< answers nothing any more
    bool refuse_control = false;  ///< stalls control requests
    bool lose_home = false;       ///< reports no arm homed
    int bad_echoes = 0;           ///< loads during which one byte comes back wrong
    int deaf_greetings = 0;       ///< greetings that go unanswered
    bool leading_zero = false;    ///< a 00 in front of the loader's answer
    double late = 0;              ///< s that each byte waits longer
    std::size_t most = 62;        ///< bytes of payload in a packet
    std::uint8_t flip = 0;        ///< bits turned over in each byte from the firmware
    int drop_every = 0;           ///< every so many bytes one is lost; 0: none
    std::array<int, 3> shift{};   ///< counts added to the encoders, wrapping at 16 bits
  };

  explicit FalconModel(Bytes right_firmware) : right_(std::move(right_firmware)) {}

  Faults faults;
  runtime::Vec3 tip = device::falcon::kCentre;  ///< m: where the hand holds the grip; within the arms' reach
  std::uint8_t buttons = 0;
  std::uint8_t homed = 0;  ///< bits of device::falcon::Input that are set as soon as homing is requested

  [[nodiscard]] bool running() const { return stage_ == Stage::running; }
  [[nodiscard]] int loads() const { return loads_; }
  [[nodiscard]] const std::array<std::int16_t, 3>& motors() const { return motors_; }
  [[nodiscard]] std::uint8_t lights() const { return lights_; }

  /// As a program before this one may have left it.
  void leave_running(const std::array<std::int16_t, 3>& motors) {
    stage_ = Stage::running;
    motors_ = motors;
  }

  // UsbModel
  [[nodiscard]] UsbShape shape() const override { return {0x0403, 0xcb48, 0xff, 0x81, 0x02, false, 64}; }

  void plugged(double time) override;
  bool control(double time, const ControlRequest& request, Bytes& reply) override;
  void written(double time, const Bytes& bytes) override;
  bool read(double time, Bytes& packet) override;
  /// The chip shows its status each latency period, with or without payload.
  [[nodiscard]] double due() const override { return next_status_; }

private:
  enum class Stage : std::uint8_t { off, greeted, loading, running, crashed };
  static constexpr std::uint16_t kSlow = 0x4138, kMiddle = 0x15, kFast = 0x02;

  void reset();
  void say(double time, std::uint8_t byte);
  void hear(double time, std::uint8_t byte);
  void obey(double time);

  Bytes right_, loaded_, heard_;
  Stage stage_ = Stage::off;
  std::uint16_t baud_ = 0;
  double latency_ = 0.016, next_status_ = 0;
  bool dtr_ = false;
  int loads_ = 0, said_ = 0;
  std::uint8_t lights_ = 0, shown_ = 0;
  std::array<std::int16_t, 3> motors_{};
  device::falcon::Reader reader_;
  std::deque<std::pair<double, std::uint8_t>> queue_;  // when, what
};

}  // namespace palpate::test
