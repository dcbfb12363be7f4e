// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/device/models/falcon_model.hpp"

namespace palpate::test {

void FalconModel::plugged(double time) {
  stage_ = Stage::off;
  motors_ = {};
  homed = 0;
  queue_.clear();
  next_status_ = time;
}

bool FalconModel::control(double time, const ControlRequest& request, Bytes& /*reply*/) {
  if (faults.refuse_control || request.request_type != 0x40 || request.index != 0) return false;
  switch (request.request) {
    case 0:
      if (request.value == 1) queue_.clear();
      return request.value <= 2;
    case 1:
      if (request.value == 0x100) {
        dtr_ = false;
      } else if (request.value == 0x101) {
        if (!dtr_) reset();
        dtr_ = true;
      }
      return true;
    case 2:
    case 4:
      return true;
    case 3:
      baud_ = request.value;
      if (baud_ == kFast && stage_ == Stage::loading) {
        stage_ = loaded_ == right_ ? Stage::running : Stage::crashed;
        motors_ = {};
      }
      return true;
    case 9:
      latency_ = 1e-3 * request.value;
      next_status_ = time + latency_;
      return request.value >= 1 && request.value <= 255;
    default:
      return false;
  }
}

void FalconModel::written(double time, const Bytes& bytes) {
  for (const std::uint8_t byte : bytes) hear(time, byte);
}

bool FalconModel::read(double time, Bytes& packet) {
  std::size_t ready = 0;
  while (ready < queue_.size() && ready < faults.most && queue_[ready].first <= time) ++ready;
  if (ready < faults.most && time < next_status_) return false;
  packet = {0x01, 0x60};
  for (std::size_t i = 0; i < ready; ++i) packet.push_back(queue_[i].second);
  queue_.erase(queue_.begin(), queue_.begin() + static_cast<std::ptrdiff_t>(ready));
  next_status_ = time + latency_;
  return true;
}

void FalconModel::reset() {
  stage_ = Stage::off;
  motors_ = {};
  heard_.clear();
}

void FalconModel::say(double time, std::uint8_t byte) {
  if (faults.mute || (faults.drop_every > 0 && ++said_ % faults.drop_every == 0)) return;
  queue_.emplace_back(time + faults.late, byte);
}

void FalconModel::hear(double time, std::uint8_t byte) {
  switch (stage_) {
    case Stage::off:
      if (baud_ != kSlow || !dtr_) return;
      heard_.push_back(byte);
      if (heard_.size() > 3) heard_.erase(heard_.begin());
      if (heard_ != Bytes{0x0a, 0x43, 0x0d} || faults.deaf_greetings-- > 0) return;
      if (faults.leading_zero) say(time, 0x00);
      for (const std::uint8_t answer : Bytes{0x0a, 0x44, 0x2c, 0x0d}) say(time, answer);
      stage_ = Stage::greeted;
      return;
    case Stage::greeted:
      if (baud_ != kMiddle || dtr_ || byte != 0x41) return;
      say(time, 0x41);
      loaded_.clear();
      ++loads_;
      stage_ = Stage::loading;
      return;
    case Stage::loading:
      if (baud_ != kMiddle) return;
      loaded_.push_back(byte);
      if (loaded_.size() == 100 && faults.bad_echoes-- > 0) byte ^= 0x10;
      say(time, byte);
      return;
    case Stage::running:
      if (baud_ == kFast && reader_.take(byte)) obey(time);
      return;
    case Stage::crashed:
      return;
  }
}

void FalconModel::obey(double time) {
  // Packets of the host have the same form as those of the device.
  motors_ = reader_.input().encoders;
  lights_ = reader_.input().bits;
  const bool homing = (lights_ & device::falcon::Output::kHoming) != 0;
  if (homing && !faults.lose_home) shown_ = homed;
  if (faults.lose_home) shown_ = 0;
  device::falcon::Input input;
  const device::falcon::Triple angles = device::falcon::inverse(tip).angles();
  for (std::size_t i = 0; i < 3; ++i) {
    // An arm that is not homed counts from where it was when its power came on.
    const int origin = (shown_ & (0x10 << i)) != 0 ? 0 : 700 * (static_cast<int>(i) - 1) + 111;
    input.encoders[i] = static_cast<std::int16_t>(
        static_cast<std::uint16_t>(device::falcon::encoder_of(angles[i]) + origin + faults.shift[i]));
  }
  input.bits = static_cast<std::uint8_t>(buttons | shown_);
  for (const std::uint8_t byte : encode(input)) say(time, byte ^ faults.flip);
}

}  // namespace palpate::test
