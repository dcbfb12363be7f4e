// SPDX-License-Identifier: MIT
// The frames of the open link (open_link.md), for both of its ends: it needs a C++17 compiler and no library, so that
// microcontrollers share it.
#pragma once

#include <stddef.h>
#include <stdint.h>

namespace palpate::device::openlink {

inline constexpr uint8_t kMajor = 1, kMinor = 0;
inline constexpr uint8_t kSync = 0xa7;
inline constexpr size_t kHead = 4, kCheck = 2, kMostPayload = 58, kMostFrame = kHead + kMostPayload + kCheck;

/// CRC-16/CCITT-FALSE.
constexpr uint16_t crc(const uint8_t* bytes, size_t size) {
  unsigned sum = 0xffff;
  for (size_t i = 0; i < size; ++i) {
    sum ^= static_cast<unsigned>(bytes[i]) << 8;
    for (int bit = 0; bit < 8; ++bit) sum = ((sum << 1) ^ ((sum & 0x8000U) != 0 ? 0x1021U : 0U)) & 0xffffU;
  }
  return static_cast<uint16_t>(sum);
}

enum Type : uint8_t { kHello = 0x01, kDrive = 0x02, kCapabilities = 0x81, kState = 0x82 };

/// A frame as it goes over the wire: size() bytes.
struct Frame {
  uint8_t bytes[kMostFrame] = {};

  [[nodiscard]] uint8_t type() const { return bytes[1]; }
  [[nodiscard]] uint8_t sequence() const { return bytes[3]; }
  [[nodiscard]] size_t payload_size() const { return bytes[2]; }
  [[nodiscard]] const uint8_t* payload() const { return bytes + kHead; }
  [[nodiscard]] size_t size() const { return kHead + payload_size() + kCheck; }
};

/// Whether sequence a is newer than b: 1 to 127 further, modulo 256.
constexpr bool newer(uint8_t a, uint8_t b) {
  const auto ahead = static_cast<uint8_t>(a - b);
  return ahead >= 1 && ahead <= 127;
}

struct Hello {
  uint8_t major = kMajor, minor = kMinor;
};

struct Drive {
  bool on = false;
  float force[3] = {}, torque[3] = {};  ///< N, N m
};

struct Capabilities {
  uint8_t major = kMajor, minor = kMinor;
  uint8_t measures = 0x07, drives = 0x07;  ///< bits: x, y, z, then about x, y, z
  uint8_t buttons = 0;
  float peak_force = 0, continuous_force = 0;  ///< N
  float peak_torque = 0;                       ///< N m
  float stiffness = 0;                         ///< N/m
  float radius = 0;                            ///< m
  float rate = 0;                              ///< 1/s
  float watchdog = 0;                          ///< s
  char name[17] = {};                          ///< ends with a zero
};

struct State {
  static constexpr uint8_t kHomed = 1, kDriving = 2, kTripped = 4;
  uint32_t clock = 0;  ///< us
  uint8_t flags = 0, fault = 0;
  uint8_t heard = 0;  ///< sequence of the last frame taken
  uint32_t buttons = 0;
  float position[3] = {};               ///< m
  float orientation[4] = {1, 0, 0, 0};  ///< w, x, y, z
};

Frame encode(uint8_t sequence, const Hello& hello);
Frame encode(uint8_t sequence, const Drive& drive);
Frame encode(uint8_t sequence, const Capabilities& capabilities);
Frame encode(uint8_t sequence, const State& state);

/// False, and nothing is changed, where the frame is of another type or too short.
bool decode(const Frame& frame, Hello& hello);
bool decode(const Frame& frame, Drive& drive);
bool decode(const Frame& frame, Capabilities& capabilities);
bool decode(const Frame& frame, State& state);

/// The first invalid value in capabilities of our own major version, or null.
const char* wrong(const Capabilities& capabilities);

/// Cuts a stream into frames: put() a byte, then get() until it has none. Behind noise it is in step at the next frame.
class Reader {
public:
  void put(uint8_t byte);
  bool get(Frame& frame);

  /// Bytes found to belong to no frame since the last call.
  size_t drain_noise() {
    const size_t noise = noise_;
    noise_ = 0;
    return noise;
  }

private:
  void drop(size_t count);

  uint8_t bytes_[kMostFrame] = {};
  size_t filled_ = 0, noise_ = 0;
};

}  // namespace palpate::device::openlink
