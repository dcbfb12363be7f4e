// SPDX-License-Identifier: MIT
// The Novint Falcon's packets while its firmware runs: 16 bytes each way, `<`, 14 bytes, `>`.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace palpate::device::falcon {

inline constexpr std::size_t kPacket = 16;

/// A packet from the host.
struct Output {
  static constexpr std::uint8_t kHoming = 1, kGreen = 2, kBlue = 4, kRed = 8;
  std::array<std::int16_t, 3> motors{};
  std::uint8_t bits = kHoming;
};

/// A packet from the Falcon.
struct Input {
  static constexpr std::uint8_t kPlus = 1, kForward = 2, kCentre = 4, kMinus = 8, kButtons = 0x0f;
  static constexpr std::uint8_t kHomed = 0x70;  ///< one bit an arm: its encoder has found its origin
  std::array<std::int16_t, 3> encoders{};
  std::uint8_t bits = 0;
};

std::array<std::uint8_t, kPacket> encode(const Output& output);
std::array<std::uint8_t, kPacket> encode(const Input& input);  ///< for emulated devices

/// Cuts a stream of bytes into packets of either way (they differ in nothing but what the bits mean). No byte inside a
/// packet looks like its first, so that it is in step again at the next packet, wherever the stream was cut.
class Reader {
public:
  /// Takes one byte; true: it ended a packet, which input() holds until the next one ends.
  bool take(std::uint8_t byte);

  [[nodiscard]] const Input& input() const { return last_; }

  /// Bytes found to belong to no packet since the last call.
  std::size_t drain_noise() { return std::exchange(noise_, 0); }

private:
  std::array<std::uint8_t, kPacket> bytes_{};
  std::size_t filled_ = 0, noise_ = 0;
  Input last_;
};

}  // namespace palpate::device::falcon
