// SPDX-License-Identifier: GPL-3.0-or-later
// A device that says what a script says, a clock that a test moves, and a source whose force is known.
#pragma once

#include "device/loop/clock.hpp"
#include "device/loop/loop.hpp"

#include <algorithm>
#include <functional>
#include <vector>

namespace palpate::test {

using device::Command;
using device::Phase;
using device::Sample;
using runtime::Pose;
using runtime::Vec3;

/// Sleeps take no time; each ends `oversleep(number)` s late, and each tick's work takes `work(number)` s.
class FakeClock : public device::Clock {
public:
  double now() noexcept override { return time_; }
  void sleep_until(double seconds) noexcept override {
    ++sleeps_;
    time_ = std::max(time_, seconds) + (oversleep ? oversleep(sleeps_) : 0);
  }
  void pass(double seconds) { time_ += seconds; }
  [[nodiscard]] int sleeps() const { return sleeps_; }

  std::function<double(int)> oversleep;

private:
  double time_ = 1000;
  int sleeps_ = 0;
};

/// Ready from the first sample on unless the script says otherwise; keeps every command.
class ScriptedDevice : public device::Device {
public:
  explicit ScriptedDevice(FakeClock& clock) : clock_(clock) { commands.reserve(1 << 17); }

  [[nodiscard]] const device::DeviceKind& kind() const override { return kind_; }
  Sample read() noexcept override {
    Sample sample;
    sample.number = ++number_;
    sample.time = clock_.now();
    sample.phase = Phase::ready;
    if (script) script(static_cast<int>(number_), sample);
    return sample;
  }
  void write(const Command& command) noexcept override {
    if (commands.size() < commands.capacity()) commands.push_back(command);
    if (work > 0) clock_.pass(work);
  }
  void close() override {}

  std::function<void(int tick, Sample&)> script;
  std::vector<Command> commands;
  double work = 0;  ///< s that a write takes

private:
  device::DeviceKind kind_{"scripted", 0, 0, 5, 1000, 0.1, 0.5};
  FakeClock& clock_;
  std::uint32_t number_ = 0;
};

/// The same force wherever the tool is, but for what a test has it do; counts its resets.
class KnownSource : public device::ForceSource {
public:
  device::Answer answer(const Sample&, double) noexcept override { return next; }
  void reset() noexcept override { ++resets; }

  device::Answer next = forceful({0, 0, 2});
  int resets = 0;

  static device::Answer forceful(const Vec3& force) {
    device::Answer answer;
    answer.force = force;
    answer.usable = true;
    return answer;
  }
};

}  // namespace palpate::test
