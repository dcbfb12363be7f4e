// SPDX-License-Identifier: MIT
#include "device/falcon/falcon_codec.hpp"

namespace palpate::device::falcon {
namespace {

constexpr std::uint8_t kFirst = '<', kLast = '>', kBase = 0x41;
constexpr std::size_t kBits = 13, kPadding = 14;

std::array<std::uint8_t, kPacket> packet(const std::array<std::int16_t, 3>& values, std::uint8_t bits) {
  std::array<std::uint8_t, kPacket> bytes{};
  bytes[0] = kFirst;
  for (std::size_t i = 0; i < 12; ++i) {
    const unsigned value = static_cast<std::uint16_t>(values[i / 4]);
    bytes[1 + i] = static_cast<std::uint8_t>(kBase + ((value >> (4 * (i % 4))) & 0xf));
  }
  bytes[kBits] = static_cast<std::uint8_t>(kBase + (bits & 0x7f));
  bytes[kPadding] = kBase;
  bytes[15] = kLast;
  return bytes;
}

// Whether a byte can stand at this place.
bool fits(std::size_t place, std::uint8_t byte) {
  if (place == 0) return byte == kFirst;
  if (place < kBits) return byte >= kBase && byte <= kBase + 0xf;
  if (place == kBits) return byte >= kBase && byte <= kBase + 0x7f;
  return byte == (place == kPadding ? kBase : kLast);
}

}  // namespace

std::array<std::uint8_t, kPacket> encode(const Output& output) { return packet(output.motors, output.bits); }
std::array<std::uint8_t, kPacket> encode(const Input& input) { return packet(input.encoders, input.bits); }

bool Reader::take(std::uint8_t byte) {
  if (!fits(filled_, byte)) {
    // The gathered bytes have no `<` after the first: only this byte may begin a packet.
    noise_ += filled_;
    filled_ = 0;
    if (byte != kFirst) {
      ++noise_;
      return false;
    }
  }
  bytes_[filled_++] = byte;
  if (filled_ < kPacket) return false;
  for (std::size_t i = 0; i < 3; ++i) {
    unsigned value = 0;
    for (std::size_t k = 0; k < 4; ++k) value |= static_cast<unsigned>(bytes_[1 + 4 * i + k] - kBase) << (4 * k);
    last_.encoders[i] = static_cast<std::int16_t>(static_cast<std::uint16_t>(value));
  }
  last_.bits = static_cast<std::uint8_t>(bytes_[kBits] - kBase);
  filled_ = 0;
  return true;
}

}  // namespace palpate::device::falcon
