// SPDX-License-Identifier: GPL-3.0-or-later
// A device on the open link: the example firmware's core, as it goes onto a microcontroller, above hardware of memory.
#pragma once

#include "device/open_link/firmware/open_link_firmware.hpp"
#include "tests/device/models/usb_model.hpp"

#include <array>
#include <deque>
#include <optional>
#include <utility>

namespace palpate::test {

class OpenLinkModel final : public UsbModel {
public:
  /// Faults, from the moment they are set.
  struct Faults {
    bool frozen = false;    ///< the loop of the firmware is stuck: motors stay as they are
    bool mute = false;      ///< what it sends is lost
    double late = 0;        ///< s that each byte waits longer on its way to the host
    std::size_t most = 64;  ///< bytes in a packet
    std::uint8_t flip = 0;  ///< bits turned over in the first byte of each frame's payload
    int drop_every = 0;     ///< every so many bytes to the host one is lost; 0: none
  };

  static device::openlink::Capabilities usual();

  explicit OpenLinkModel(const device::openlink::Capabilities& announced = usual()) : capabilities(announced) {}

  device::openlink::Capabilities capabilities;  ///< announced from when it is next plugged in
  Faults faults;
  device::openlink::Measured measured{{}, {1, 0, 0, 0}, 0, true, 0};  ///< what its hardware measures
  double clock_rate = 1;                                              ///< of its clock, times true
  std::array<float, 3> force{}, torque{};                             ///< N, N m, last command of its motors
  double force_until = 0;  ///< s: when the last force ended; infinity: there is one

  /// The firmware's loop, up to `time` (s).
  void advance(double time);

  // UsbModel
  [[nodiscard]] UsbShape shape() const override { return {0x1209, 0x0001, 0xff, 0x81, 0x01, false, 64}; }
  void plugged(double time) override;
  bool control(double, const ControlRequest&, Bytes&) override { return false; }
  void written(double time, const Bytes& bytes) override;
  bool read(double time, Bytes& packet) override;
  [[nodiscard]] double due() const override { return next_step_; }

private:
  // The five functions of the hardware that the firmware calls.
  struct Board {
    OpenLinkModel& model;
    std::uint32_t microseconds() const;
    void measure(device::openlink::Measured& into) const { into = model.measured; }
    void actuate(const float* force, const float* torque);
    std::size_t receive(std::uint8_t* bytes, std::size_t most);
    void send(const std::uint8_t* bytes, std::size_t size);
  };

  Board board_{*this};
  std::optional<device::openlink::Firmware<Board>> firmware_;
  double clock_ = 0;                                   // us
  double time_ = 0, next_step_ = 0;                    // s
  std::deque<std::uint8_t> received_;                  // not read by the firmware yet
  std::deque<std::pair<double, std::uint8_t>> queue_;  // for the host: when, what
  int said_ = 0;
};

}  // namespace palpate::test
