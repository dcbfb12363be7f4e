// SPDX-License-Identifier: MIT
#include "device/wooden_haptics/wooden_codec.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::device {

namespace {

std::uint16_t word(const std::uint8_t* bytes) { return static_cast<std::uint16_t>(bytes[0] | bytes[1] << 8); }

}  // namespace

bool decode(const std::uint8_t* bytes, std::size_t size, WoodenReport& report) {
  if (size < kWoodenReport) return false;
  if (!std::all_of(bytes + kWoodenReport, bytes + size, [](std::uint8_t byte) { return byte == 0; })) return false;
  for (std::size_t k = 0; k < 3; ++k) report.encoder[k] = static_cast<std::int16_t>(word(bytes + 2 * k));
  report.number = word(bytes + 6);
  return true;
}

bool is_six_joint_report(const std::uint8_t* bytes, std::size_t size) {
  constexpr std::size_t kLength = 14;
  const auto zero = [](std::uint8_t byte) { return byte == 0; };
  if (size < kLength || !std::all_of(bytes + kLength, bytes + size, zero)) return false;
  return size == kLength || !std::all_of(bytes + kWoodenReport, bytes + kLength, zero);
}

void encode(const std::array<std::int16_t, 3>& milliamps, std::uint8_t (&bytes)[kWoodenReport]) {
  for (std::size_t k = 0; k < 3; ++k) {
    const auto value = static_cast<std::uint16_t>(milliamps[k]);
    bytes[2 * k] = static_cast<std::uint8_t>(value & 0xff);
    bytes[2 * k + 1] = static_cast<std::uint8_t>(value >> 8);
  }
  bytes[6] = bytes[7] = 0;
}

std::array<std::int16_t, 3> milliamps(const Joints& currents, double most) {
  double largest = 0;
  for (const double current : currents) {
    if (!std::isfinite(current)) return {};
    largest = std::max(largest, std::fabs(current));
  }
  const double scale = 1000 * (largest > most ? most / largest : 1);
  std::array<std::int16_t, 3> result{};
  for (std::size_t k = 0; k < 3; ++k) result[k] = static_cast<std::int16_t>(std::lround(scale * currents[k]));
  return result;
}

}  // namespace palpate::device
