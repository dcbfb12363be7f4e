// SPDX-License-Identifier: MIT
// The language of the WoodenHaptics arm: reports that flow by themselves, currents that it obeys for half a second.
//
// Its encoders count from wherever the arm was when its power came on. So the origin is taken from the user: while
// homing, the arm is to be brought into a known pose (by default the column facing along x, the upper body upright, the
// lower one level, at a right angle) and held still there. The reports do not show whether that pose was the right
// one, but a later pose in which the arm would be folded through itself shows that it was not. No current flows before.
#pragma once

#include "device/usb/protocol.hpp"
#include "device/wooden_haptics/wooden_codec.hpp"

namespace palpate::device {

struct WoodenOptions {
  WoodenGeometry geometry;
  Joints home{0, 0, 1.5707963267948966};  ///< rad, where the arm is held still while homing
  double hold = 1.0;                      ///< s that it is seen held still, above 0
  int still = 30;                         ///< counts that it may move meanwhile (2.6 mm at the tip)
  double most_current = 3.0;              ///< A, where the motors' amplifiers saturate; up to 32.767
  double fastest = 20.0;                  ///< rad/s of a joint: what is faster cannot be
  double fold = 0.2;                      ///< rad that B + C may lie outside 0 to pi
  double boot = 2.0;                      ///< s from opening to the first report, at most
  double doubtful = 0.005;                ///< s without a good report after which no force is given
  double silence = 0.020;                 ///< s without a good report that end it
  double period = 0.001;                  ///< s between zeros before it is ready: they keep some boards reporting

  /// The first invalid value, with its range, or null.
  [[nodiscard]] const char* validate() const;
};

class WoodenProtocol final : public Protocol {
public:
  explicit WoodenProtocol(const WoodenOptions& options = {}) : options_(options) {}

  [[nodiscard]] Wiring wiring() const override { return {0, 0, 0, true, 64}; }
  void start(double time) override;
  Request next(double time, const Command& command) override;
  void ended(double time, Outcome outcome) override;
  void received(double time, const std::uint8_t* bytes, std::size_t size) override;
  [[nodiscard]] const Sample& sample() const override { return sample_; }
  [[nodiscard]] Request zero() const override;

private:
  void stop(Fault fault);
  Request ask(double time, const std::array<std::int16_t, 3>& milliamps);
  /// Whether an encoder can have come this far.
  [[nodiscard]] bool possible(double time, const WoodenReport& report) const;
  /// A report that came `passed` s after the last one.
  void home(double passed);
  /// Sets the angles and the pose from the encoders.
  void locate();

  WoodenOptions options_;
  Sample sample_;
  Unwrapped encoders_[3];
  Joints angles_{};
  double heard_ = 0;  // s, last good report
  double asked_ = 0;  // s, first report that the device has not taken
  double still_ = 0;  // s that it has been seen still while homing
  double write_ = 0;  // s, next zero before it is ready
  std::uint16_t last_ = 0;
  bool asking_ = false;  // there is such a report
  bool noise_ = false;   // what is no report came after the last good one
};

}  // namespace palpate::device
