// SPDX-License-Identifier: MIT
// A simulated glove behind the interface of the real devices: five cables, each a simulated device on one finger.
#pragma once

#include "device/simulation/sim_device.hpp"
#include "device/simulation/sim_hand.hpp"

#include <deque>

namespace palpate::device {

/// "sim-glove". No maker's: its figures are guesses at a glove of cables.
extern const DeviceKind kSimGlove;

struct SimGloveOptions {
  /// A hand of its own proportions, held as well as people hold a pose and measured as well as they measure; sensors of
  /// 12 bits.
  SimHandOptions hand{1, 0.95, 0.03, 1.0 / 16, 1.0 / 32, 0.02, 1e-3};
  /// m, by which each fingertip means to close from rest() and open again, over and over.
  std::array<double, kFingers> way{};
  SimOptions life;
};

/// The wrist stays where the relaxed fingertips are about the device's origin; each finger closes along its tip's way,
/// against its cable, at a time of its own. Driven live or by a caller, as SimDevice is.
class SimGlove final : public Device {
public:
  /// Throws std::invalid_argument where the options are not usable.
  explicit SimGlove(const SimGloveOptions& options = {}, SimDevice::Clock clock = &now);

  /// How it begins: fingers a little bent, their tips at about the same height.
  static HandJoints rest();

  /// The recording of a simulated wearer for calibrate_hand(), before the run.
  std::vector<KeyPose> record() { return hand_.record(); }

  [[nodiscard]] const DeviceKind& kind() const override { return kSimGlove; }
  Sample read() noexcept override;
  void write(const Command& command) noexcept override;
  void close() override;

  /// Moves on to a time on the clock (s; not back).
  void advance(double to_time) noexcept;

  /// The finger's cable: its life and faults, and the plant that it pulls on; closing is along -z.
  [[nodiscard]] SimDevice& cable(std::size_t finger) { return cables_[finger]; }

  /// Poses of the fingertips at rest, and of the wrist, in the device's frame.
  [[nodiscard]] std::array<Pose, kFingers> tips_at_rest() const;
  [[nodiscard]] const Pose& wrist() const { return wrist_; }

private:
  SimHand hand_;
  Pose wrist_;
  std::array<double, kFingers> per_metre_;  ///< rad by which a root joint bends while its tip closes by a metre
  std::deque<SimDevice> cables_;
  std::uint32_t number_ = 0;  ///< of the sample whose
  HandJoints joints_{};       ///< these are
};

}  // namespace palpate::device
