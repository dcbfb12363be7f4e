// SPDX-License-Identifier: MIT
// Decides whether a device's input is plausible. One doubtful input takes the force away; lasting doubt is a fault.
#pragma once

#include "device/device.hpp"

#include <algorithm>
#include <cstddef>

namespace palpate::device {

/// A protocol reports to it what its codec and its kinematics found in the input.
class InputWatch {
public:
  struct Limits {
    double hold = 0.006;    ///< s: on a sample older than this no force is given
    double silent = 0.100;  ///< s without a sample that are a fault
    double noise = 64;      ///< bytes of no packet that are a fault, less `forgiven` for every packet since
    double forgiven = 4;
    int impossible = 3;  ///< samples that cannot be, one after the other, that are a fault
  };

  InputWatch() = default;
  explicit InputWatch(const Limits& limits) : limits_(limits) {}

  /// Input is expected from now on.
  void start(double time) {
    asked_ = time;
    quiet_ = noise_ = 0;
    impossible_ = 0;
    doubtful_ = true;
  }

  /// A sample came in that can be.
  void good(double time) {
    asked_ = std::max(asked_, time);
    noise_ = std::max(0.0, noise_ - limits_.forgiven);
    quiet_ = 0;
    impossible_ = 0;
    doubtful_ = false;
  }

  void noise(std::size_t bytes) {
    noise_ += static_cast<double>(bytes);
    doubtful_ = doubtful_ || bytes > 0;
  }

  void impossible() {
    ++impossible_;
    doubtful_ = true;
  }

  /// Call each time the host polls. A gap between two polls counts as at most `hold` of silence, because the host may
  /// itself have been late.
  void ask(double time) {
    quiet_ += std::min(std::max(time - asked_, 0.0), limits_.hold);
    asked_ = time;
  }

  /// A force may be given on the newest sample.
  [[nodiscard]] bool believed() const { return !doubtful_ && quiet_ < limits_.hold; }

  [[nodiscard]] Fault fault() const {
    if (impossible_ >= limits_.impossible) return Fault::impossible;
    if (noise_ > limits_.noise) return Fault::garbled;
    return quiet_ > limits_.silent ? Fault::silent : Fault::none;
  }

private:
  Limits limits_;
  double asked_ = 0, quiet_ = 0, noise_ = 0;
  int impossible_ = 0;
  bool doubtful_ = true;
};

}  // namespace palpate::device
