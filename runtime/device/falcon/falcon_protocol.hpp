// SPDX-License-Identifier: MIT
// The Novint Falcon's language: boot, homing, positions in, forces out. See falcon.md.
#pragma once

#include "device/falcon/falcon_boot.hpp"
#include "device/falcon/falcon_kinematics.hpp"
#include "device/usb/input_watch.hpp"

namespace palpate::device {

/// Poses are relative to the middle of the workspace: x to the right, y up, z towards the user. Until it is homed the
/// pose stays where it began: the encoders' origin is not known.
class FalconProtocol final : public Protocol {
public:
  static constexpr double kHomingPeriod = 0.001;  ///< s between packets while the user homes it
  static constexpr int kSteady = 8;               ///< samples after homing before it is ready
  static constexpr double kFastest = 30;          ///< rad/s: no hand turns an arm faster
  static constexpr double kFarthest = 0.09;       ///< m from the middle: no grip gets there
  static constexpr double kSlack = 0.002;         ///< s that a packet may have waited on its way
  static constexpr int kUntaken = 3;              ///< writes that time out one after the other and are a fault

  /// `firmware` is loaded where none runs already; may be empty.
  explicit FalconProtocol(std::vector<std::uint8_t> firmware = {}) : firmware_(std::move(firmware)) {}

  [[nodiscard]] Wiring wiring() const override { return {0, 0x81, 0x02, false, 64}; }
  void start(double time) override;
  Request next(double time, const Command& command) override;
  void ended(double time, Outcome outcome) override;
  void received(double time, const std::uint8_t* bytes, std::size_t size) override;
  [[nodiscard]] const Sample& sample() const override { return sample_; }
  [[nodiscard]] Request zero() const override;

private:
  void stop(Fault fault);
  void take(double time, const falcon::Input& input);
  bool placed(double time, const falcon::Input& input);

  std::vector<std::uint8_t> firmware_;
  falcon::Boot boot_;
  falcon::Reader reader_;
  InputWatch watch_;
  Sample sample_;
  falcon::Input last_;    // the last accepted packet
  double last_time_ = 0;  // s
  falcon::Arms arms_;
  Vec3 tip_ = falcon::kCentre;
  double write_at_ = 0;  // s, while homing
  int steady_ = 0;
  int untaken_ = 0;  // writes that timed out, one after the other
};

}  // namespace palpate::device
