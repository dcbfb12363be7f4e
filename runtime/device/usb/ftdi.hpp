// SPDX-License-Identifier: MIT
// FTDI's USB-to-serial chips, as far as a device behind one needs them: control requests, and the status in front of
// what comes in.
#pragma once

#include "device/usb/protocol.hpp"

#include <algorithm>

namespace palpate::device::ftdi {

/// A control request without data: its number and value (FTDI's application note AN232R-01 and libftdi name them).
struct Setting {
  std::uint8_t request = 0;
  std::uint16_t value = 0;
};

inline constexpr Setting kPurgeInput{0, 1}, kPurgeOutput{0, 2};
inline constexpr Setting kDtrLow{1, 0x100}, kDtrHigh{1, 0x101}, kRtsLow{1, 0x200};
inline constexpr Setting kNoFlowControl{2, 0};
inline constexpr Setting kBaud9600{3, 0x4138}, kBaud143k{3, 0x15}, kBaud1500k{3, 0x02};
inline constexpr Setting k8N1{4, 8};

/// How long the chip may wait for more before it sends what it has, in ms.
constexpr Setting latency(std::uint16_t ms) { return {9, ms}; }

inline Request control(const Setting& setting) {
  Request request;
  request.kind = Request::Kind::control;
  request.request_type = 0x40;
  request.request = setting.request;
  request.value = setting.value;
  return request;
}

/// Calls use(bytes, size) with what a transfer of input carries, without the two bytes of status at the head of each
/// packet of `packet` bytes.
template <class Use>
void for_payload(const std::uint8_t* bytes, std::size_t size, std::size_t packet, const Use& use) {
  constexpr std::size_t kStatus = 2;
  for (std::size_t at = 0; at < size; at += packet) {
    const std::size_t here = std::min(packet, size - at);
    if (here > kStatus) use(bytes + at + kStatus, here - kStatus);
  }
}

}  // namespace palpate::device::ftdi
