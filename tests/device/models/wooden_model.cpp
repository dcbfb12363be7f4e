// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/device/models/wooden_model.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::test {

void WoodenModel::plugged(double time) {
  plugged_ = next_ = time;
  heard_ = -1e9;
  asked_ = {};
  leap_ = 0;
  number_ = 0;
}

bool WoodenModel::control(double, const ControlRequest& request, Bytes&) {
  constexpr std::uint8_t kClassOut = 0x21, kSetIdle = 0x0a;
  return request.request_type == kClassOut && request.request == kSetIdle;
}

void WoodenModel::written(double time, const Bytes& bytes) {
  if (bytes.size() != (six ? 14 : 8)) return;  // the board looks at whole reports only
  constexpr int kSaturated = 3000;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto value = static_cast<std::int16_t>(static_cast<std::uint16_t>(bytes[2 * k] | bytes[2 * k + 1] << 8));
    asked_[k] = std::clamp<int>(value, -kSaturated, kSaturated);
  }
  heard_ = time;
}

bool WoodenModel::read(double time, Bytes& packet) {
  if (time < next_) return false;
  // One report waits in the endpoint at most: those of a host that was away are never made.
  next_ = std::max(next_ + period, time);
  if (frozen) {
    packet = last_;
    return true;
  }
  ++number_;
  const device::Joints at = device::counts(geometry, angles(time));
  packet.clear();
  const auto put = [&](std::uint16_t word) {
    packet.push_back(static_cast<std::uint8_t>(word & 0xff));
    packet.push_back(static_cast<std::uint8_t>(word >> 8));
  };
  for (std::size_t k = 0; k < 3; ++k) {
    put(static_cast<std::uint16_t>(std::lround(at[k]) + offset[k] + leap_));
  }
  if (six) {
    constexpr std::uint16_t kWrist[] = {10, 20, 30};
    for (const std::uint16_t encoder : kWrist) put(encoder);
    put(0);
  } else {
    put(number_);
  }
  last_ = packet;
  return true;
}

void WoodenModel::leap(int counts) { leap_ += counts; }

std::array<int, 3> WoodenModel::milliamps(double time) const {
  return time - heard_ > kWatchdog ? std::array<int, 3>{} : asked_;
}

}  // namespace palpate::test
