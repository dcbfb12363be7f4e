// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/device/models/open_link_model.hpp"

#include <algorithm>
#include <limits>

namespace palpate::test {

using device::openlink::Capabilities;

namespace {

constexpr double kStep = 0.0002;  // s of the firmware's loop

}  // namespace

Capabilities OpenLinkModel::usual() {
  Capabilities c;
  c.measures = 0x3f;
  c.drives = 0x0f;  // three forces and the torque about x
  c.buttons = 2;
  c.peak_force = 6;
  c.continuous_force = 2;
  c.peak_torque = 0.2F;
  c.stiffness = 2000;
  c.radius = 0.1F;
  c.rate = 4000;
  c.watchdog = 0.02F;
  std::copy_n("modelled handle", 15, c.name);
  return c;
}

void OpenLinkModel::plugged(double time) {
  time_ = next_step_ = time;
  force = torque = {};
  force_until = 0;
  clock_ = -500000;  // just below where it wraps
  received_.clear();
  queue_.clear();
  firmware_.emplace(board_, capabilities);
}

void OpenLinkModel::advance(double time) {
  for (; next_step_ <= time; next_step_ += kStep) {
    time_ = next_step_;
    clock_ += 1e6 * clock_rate * kStep;
    if (!faults.frozen) firmware_->step();
  }
}

void OpenLinkModel::written(double time, const Bytes& bytes) {
  advance(time);
  received_.insert(received_.end(), bytes.begin(), bytes.end());
}

bool OpenLinkModel::read(double time, Bytes& packet) {
  advance(time);
  packet.clear();
  while (!queue_.empty() && packet.size() < faults.most && queue_.front().first <= time) {
    packet.push_back(queue_.front().second);
    queue_.pop_front();
  }
  return !packet.empty();
}

std::uint32_t OpenLinkModel::Board::microseconds() const {
  return static_cast<std::uint32_t>(static_cast<std::int64_t>(model.clock_));
}

void OpenLinkModel::Board::actuate(const float* force, const float* torque) {
  std::copy_n(force, 3, model.force.begin());
  std::copy_n(torque, 3, model.torque.begin());
  constexpr double kOn = std::numeric_limits<double>::infinity();
  if (model.force != std::array<float, 3>{}) {
    model.force_until = kOn;
  } else if (model.force_until == kOn) {
    model.force_until = model.time_;
  }
}

std::size_t OpenLinkModel::Board::receive(std::uint8_t* bytes, std::size_t most) {
  const std::size_t count = std::min(most, model.received_.size());
  std::copy_n(model.received_.begin(), count, bytes);
  model.received_.erase(model.received_.begin(), model.received_.begin() + static_cast<std::ptrdiff_t>(count));
  return count;
}

void OpenLinkModel::Board::send(const std::uint8_t* bytes, std::size_t size) {
  if (model.faults.mute) return;
  for (std::size_t i = 0; i < size; ++i) {
    if (model.faults.drop_every > 0 && ++model.said_ % model.faults.drop_every == 0) continue;
    const std::uint8_t flip = i == device::openlink::kHead ? model.faults.flip : 0;
    model.queue_.emplace_back(model.time_ + model.faults.late, static_cast<std::uint8_t>(bytes[i] ^ flip));
  }
}

}  // namespace palpate::test
