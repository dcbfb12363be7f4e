// SPDX-License-Identifier: GPL-3.0-or-later
// Any bytes as what devices say, or hear: refused with a reason, or harmless.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "device/falcon/falcon_protocol.hpp"
#include "device/open_link/firmware/open_link_firmware.hpp"
#include "device/open_link/open_link_protocol.hpp"
#include "device/wooden_haptics/wooden_protocol.hpp"
#include "tests/device/try_protocol.hpp"
#include "tests/fuzz/invariant.hpp"

namespace palpate::test {

/// The fuzzer's bytes, one after the other; zeros behind their end.
class Dice {
public:
  Dice(const std::uint8_t* data, std::size_t size) : at_(data), end_(data + size) {}

  [[nodiscard]] bool more() const { return at_ != end_; }
  std::uint8_t byte() { return more() ? *at_++ : std::uint8_t{0}; }
  int small() { return static_cast<std::int8_t>(byte()); }
  template <class T>
  T any() {
    std::uint8_t bytes[sizeof(T)];
    for (std::uint8_t& each : bytes) each = byte();
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return value;
  }

private:
  const std::uint8_t* at_;
  const std::uint8_t* end_;
};

/// A script for try_protocol() with packets as `packet` makes them: without, no fuzzer comes past a checksum.
template <class Packet>
std::vector<std::uint8_t> script_of(Dice& dice, const Packet& packet) {
  std::vector<std::uint8_t> script;
  while (dice.more() && script.size() < 16384) {
    const std::uint8_t event = dice.byte();
    script.push_back(event);
    if ((event & 7) > 3) continue;
    const std::vector<std::uint8_t> bytes = packet(dice);
    script.push_back(static_cast<std::uint8_t>(bytes.size()));
    script.insert(script.end(), bytes.begin(), bytes.end());
  }
  return script;
}

inline void try_script(device::Protocol& protocol, const device::DeviceKind& kind,
                       const std::vector<std::uint8_t>& script) {
  const char* broken = try_protocol(protocol, kind, script.data(), script.size());
  expect(broken == nullptr, broken == nullptr ? "" : broken);
}

/// Packets of a Falcon whose grip wanders, behind FTDI's status; now and then the loader's words, or cut ones.
inline std::vector<std::uint8_t> falcon_script(Dice& dice) {
  device::falcon::Input input;
  input.encoders = {336, 336, 336};  // the middle
  return script_of(dice, [&](Dice& d) {
    std::vector<std::uint8_t> bytes = {0x01, 0x60};
    const std::uint8_t what = d.byte();
    if (what % 16 == 0) {
      bytes.insert(bytes.end(), {0x0a, 0x44, 0x2c, 0x0d});
    } else if (what % 16 == 1) {
      bytes.push_back(d.byte());
    } else {
      for (auto& encoder : input.encoders) {
        // Wraps as the device's own does.
        const int moved = what % 16 == 2 ? 256 * d.small() : d.small() / 8;
        encoder = static_cast<std::int16_t>(static_cast<std::uint16_t>(encoder + moved));
      }
      input.bits = what % 16 == 3 ? d.byte() : device::falcon::Input::kHomed;
      const auto packet = encode(input);
      bytes.insert(bytes.end(), packet.begin(), packet.end());
      if (what % 16 == 4) bytes.resize(2 + d.byte() % packet.size());
    }
    return bytes;
  });
}

/// Reports of a WoodenHaptics whose arm wanders from where it was held; now and then one of another size or number.
inline std::vector<std::uint8_t> wooden_script(Dice& dice) {
  device::WoodenReport report;
  return script_of(dice, [&](Dice& d) {
    const std::uint8_t what = d.byte() % 16;
    for (std::int16_t& encoder : report.encoder) {
      // Wraps as the device's own does.
      const int moved = what == 0 ? 256 * d.small() : d.small() / 16;
      encoder = static_cast<std::int16_t>(static_cast<std::uint16_t>(encoder + moved));
    }
    report.number = what == 1 ? d.any<std::uint16_t>() : static_cast<std::uint16_t>(report.number + 1);
    std::vector<std::uint8_t> bytes;
    for (const std::int16_t encoder : report.encoder) {
      bytes.push_back(static_cast<std::uint8_t>(encoder));
      bytes.push_back(static_cast<std::uint8_t>(static_cast<std::uint16_t>(encoder) >> 8));
    }
    bytes.push_back(static_cast<std::uint8_t>(report.number));
    bytes.push_back(static_cast<std::uint8_t>(report.number >> 8));
    if (what == 2) bytes.resize(d.byte() % 65);
    return bytes;
  });
}

/// Frames with a right checksum: a device that introduces itself and wanders, or anything else in their payload.
inline std::vector<std::uint8_t> open_link_script(Dice& dice) {
  using namespace device::openlink;
  Capabilities capabilities;
  capabilities.peak_force = capabilities.continuous_force = 5;
  capabilities.radius = 0.1F;
  capabilities.rate = 1000;
  capabilities.watchdog = 0.02F;
  State state;
  state.flags = State::kHomed;
  std::uint8_t sequence = 0, heard = 0;
  return script_of(dice, [&](Dice& d) {
    const std::uint8_t what = d.byte() % 16;
    Frame frame;
    ++sequence;
    if (what == 0) sequence = d.byte();
    if (what <= 1) {
      frame = encode(sequence, capabilities);
    } else if (what == 2) {
      Capabilities other;
      for (float* value :
           {&other.peak_force, &other.continuous_force, &other.peak_torque, &other.radius, &other.rate}) {
        *value = d.any<float>();
      }
      other.drives = d.byte();
      other.watchdog = 0.01F;
      frame = encode(sequence, other);
    } else {
      state.clock += what == 3 ? d.any<std::uint32_t>() : 4U * d.byte();
      for (float& value : state.position) {
        value = what == 4 ? d.any<float>() : value + 1e-5F * static_cast<float>(d.small());
      }
      for (float& value : state.orientation) {
        if (what == 5) value = d.any<float>();
      }
      state.flags = what == 6 ? d.byte() : State::kHomed;
      state.fault = what == 6 ? d.byte() : std::uint8_t{0};
      state.heard = what == 7 ? d.byte() : ++heard;
      frame = encode(sequence, state);
    }
    if (what == 8) frame.bytes[d.byte() % kMostFrame] ^= d.byte();
    std::vector<std::uint8_t> bytes(frame.bytes, frame.bytes + std::min(frame.size(), kMostFrame));
    if (what == 9) bytes.resize(d.byte() % bytes.size());
    return bytes;
  });
}

/// The open link's firmware with the bytes as a host's, hardware that measures anything, and a clock that jumps.
inline void try_firmware(Dice& dice) {
  using namespace device::openlink;
  struct Board {
    std::vector<std::uint8_t> received;
    Measured now;
    std::uint32_t clock = 0;
    float force[3] = {};
    std::uint32_t microseconds() const { return clock; }
    void measure(Measured& measured) const { measured = now; }
    void actuate(const float* f, const float*) { std::memcpy(force, f, sizeof force); }
    std::size_t receive(std::uint8_t* bytes, std::size_t most) {
      const std::size_t count = std::min(most, received.size());
      std::copy_n(received.begin(), count, bytes);
      received.erase(received.begin(), received.begin() + static_cast<std::ptrdiff_t>(count));
      return count;
    }
    void send(const std::uint8_t* bytes, std::size_t size) {
      Reader reader;
      Frame frame;
      for (std::size_t i = 0; i < size; ++i) reader.put(bytes[i]);
      expect(reader.get(frame) && frame.size() == size, "the firmware sends whole frames");
    }
  } board;
  Capabilities capabilities;
  capabilities.peak_force = 5;
  capabilities.watchdog = 0.02F;
  Firmware<Board> firmware(board, capabilities);
  double driven = -1;  // us since the last frame that came
  while (dice.more()) {
    const std::uint8_t what = dice.byte();
    board.now.homed = what % 16 != 0;
    board.now.fault = what % 16 == 1 ? dice.byte() : std::uint8_t{0};
    const std::uint32_t passed = (what >> 4) * 1000U;
    board.clock += passed;
    driven = driven < 0 ? driven : driven + passed;
    if (what % 16 >= 4) {
      Drive drive;
      drive.on = what % 2 == 0;
      for (float& value : drive.force) value = what % 16 < 8 ? dice.any<float>() : static_cast<float>(dice.small());
      const std::uint8_t sequence = dice.byte();
      const Frame frame = what % 16 == 5 ? encode(sequence, Hello{}) : encode(sequence, drive);
      board.received.assign(frame.bytes, frame.bytes + frame.size());
      driven = 0;
    } else if (what % 16 == 3) {
      for (std::uint8_t count = dice.byte(); count > 0; --count) board.received.push_back(dice.byte());
      driven = 0;
    }
    do {
      firmware.step();
      const double force = std::sqrt(static_cast<double>(board.force[0]) * board.force[0] +
                                     static_cast<double>(board.force[1]) * board.force[1] +
                                     static_cast<double>(board.force[2]) * board.force[2]);
      expect(force <= 5.00001, "the firmware keeps its limit");
      expect(force == 0 || (board.now.homed && board.now.fault == 0), "it drives only what is homed and sound");
      expect(force == 0 || (driven >= 0 && driven <= 20000), "its watchdog lets go");
    } while (!board.received.empty());
  }
}

/// Kinematics of any numbers: what is reached is where it was looked for.
inline void try_wooden_kinematics(Dice& dice) {
  const device::WoodenGeometry arm;
  while (dice.more()) {
    const bool far = dice.byte() % 2 == 0;
    const auto number = [&] { return far ? dice.any<double>() : 1e-4 * dice.any<std::int16_t>(); };
    const device::Vec3 place{number(), number(), number()}, force{number(), number(), number()};
    device::Joints found{};
    if (!device::reach(arm, place, found)) continue;
    const device::Vec3 there = device::position(arm, found);
    expect(length(there - place) < 1e-9, "the arm's angles bring its tip to the place that they were found for");
    const device::Joints counted = device::counts(arm, found), again = device::angles(arm, counted);
    for (std::size_t k = 0; k < 3; ++k) expect(std::abs(again[k] - found[k]) < 1e-12, "angles have their counts");
    for (const std::int16_t current : device::milliamps(device::currents(arm, found, force), 3)) {
      expect(std::abs(current) <= 3000, "currents are limited");
    }
  }
}

/// Kinematics of any numbers: finite, or refused; what is found is where it was looked for.
inline void try_falcon_kinematics(Dice& dice) {
  using namespace device::falcon;
  while (dice.more()) {
    const bool far = dice.byte() % 2 == 0;
    const auto number = [&] { return far ? dice.any<double>() : 1e-4 * dice.any<std::int16_t>(); };
    const Triple angles{number(), number(), number()};
    const device::Vec3 start{number(), number(), number()}, force{number(), number(), number()};
    const Reached reached = forward(angles, start);
    if (reached.ok) {
      const Arms arms = inverse(reached.tip);
      expect(std::isfinite(length(reached.tip)), "a place is finite");
      for (std::size_t i = 0; arms.reached && i < 3; ++i) {
        // Each by itself: the difference from an angle of 1e20 says nothing.
        const double found = arms.arm[i].angle, given = angles[i];
        expect(std::hypot(std::cos(found) - std::cos(given), std::sin(found) - std::sin(given)) < 1e-4,
               "a place has the angles that it was found by");
      }
    }
    const Arms arms = inverse(start);
    for (std::size_t i = 0; arms.reached && i < 3; ++i) {
      expect(std::isfinite(arms.arm[i].angle) && arms.arm[i].lever >= 0, "angles are numbers");
    }
    for (const int count : motors(arms.reached ? torques(arms, force) : angles)) {
      expect(std::abs(count) <= kMostCounts, "motors are limited");
    }
  }
}

inline constexpr int kTrials = 9;  ///< that the first byte chooses from

inline void try_device(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return;
  Dice dice(data + 1, size - 1);
  const std::vector<std::uint8_t> raw(data + 1, data + size);  // no byte more: what is read beyond them is seen
  const device::DeviceKind kind{"any", 0, 0, 5, 0, 0, 0};
  device::FalconProtocol falcon({0x41, 0x0a, 0x99});
  device::OpenLinkProtocol open_link;
  device::WoodenOptions still;
  still.hold = 0.01;
  device::WoodenProtocol wooden(still);
  switch (data[0] % kTrials) {
    case 0:
      return try_script(falcon, kind, raw);
    case 1:
      return try_script(falcon, kind, falcon_script(dice));
    case 2:
      return try_script(open_link, kind, raw);
    case 3:
      return try_script(open_link, kind, open_link_script(dice));
    case 4:
      return try_script(wooden, kind, raw);
    case 5:
      return try_firmware(dice);
    case 6:
      return try_script(wooden, kind, wooden_script(dice));
    case 7:
      return try_wooden_kinematics(dice);
    default:
      return try_falcon_kinematics(dice);
  }
}

}  // namespace palpate::test
