// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/device/models/usb_port.hpp"

#include <algorithm>
#include <utility>

namespace palpate::test {

void UsbPort::packets(const PacketFault& fault) {
  const std::lock_guard<std::mutex> lock(mutex_);
  fault_ = fault;
}

void UsbPort::plug(double time) {
  const std::lock_guard<std::mutex> lock(mutex_);
  halted_in_ = halted_out_ = silent_ = deaf_ = leaving_ = gone_ = false;
  fault_ = {};
  waiting_.clear();
  log_.clear();
  model_.plugged(time);
}

void UsbPort::on_change(std::function<void()> call) {
  const std::lock_guard<std::mutex> lock(call_mutex_);
  call_ = std::move(call);
}

void UsbPort::set(std::atomic<bool>& state, bool on) {
  state = on;
  const std::lock_guard<std::mutex> lock(call_mutex_);
  if (call_) call_();
}

Answer UsbPort::control(double time, const ControlRequest& request, Bytes& reply) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (gone_) return Answer::gone;
  return model_.control(time, request, reply) ? Answer::done : Answer::stalled;
}

Answer UsbPort::written(double time, const Bytes& bytes) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (gone_) return Answer::gone;
  if (halted_out_) return Answer::stalled;
  if (leaving_) gone_ = true;
  if (deaf_ || leaving_) return Answer::pending;
  log_.push_back({time, bytes});
  model_.written(time, bytes);
  return Answer::done;
}

Answer UsbPort::read(double time, Bytes& packet) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (gone_) return Answer::gone;
  if (halted_in_) return Answer::stalled;
  Bytes next;
  if (model_.read(time, next) && !silent_) {
    const PacketFault::Kind kind = fault_.packets > 0 ? fault_.kind : PacketFault::Kind::none;
    if (fault_.packets > 0) --fault_.packets;
    switch (kind) {
      case PacketFault::Kind::none:
        waiting_.push_back({time, next});
        break;
      case PacketFault::Kind::shorter:
        next.resize(next.size() - std::min<std::size_t>(next.size(), 3));
        waiting_.push_back({time, next});
        break;
      case PacketFault::Kind::split: {
        const auto middle = next.begin() + static_cast<std::ptrdiff_t>(next.size() / 2);
        waiting_.push_back({time, Bytes(next.begin(), middle)});
        waiting_.push_back({time, Bytes(middle, next.end())});
        break;
      }
      case PacketFault::Kind::garbled: {
        next.resize(next.size() + 1 + noise_ % 16);
        for (std::uint8_t& byte : next) {
          noise_ = noise_ * 1664525u + 1013904223u;  // Numerical Recipes' generator
          byte = static_cast<std::uint8_t>(noise_ >> 24 | 1);
        }
        waiting_.push_back({time, next});
        break;
      }
      case PacketFault::Kind::late:
        waiting_.push_back({time + fault_.delay, next});
        break;
    }
  }
  if (waiting_.empty() || waiting_.front().time > time || silent_) return Answer::pending;
  packet = std::move(waiting_.front().bytes);
  waiting_.pop_front();
  return Answer::done;
}

void UsbPort::clear_halt(std::uint8_t endpoint) { ((endpoint & 0x80) != 0 ? halted_in_ : halted_out_) = false; }

double UsbPort::due() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return waiting_.empty() ? model_.due() : std::min(waiting_.front().time, model_.due());
}

std::vector<Written> UsbPort::log() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return log_;
}

}  // namespace palpate::test
