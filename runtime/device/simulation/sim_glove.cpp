// SPDX-License-Identifier: MIT
#include "device/simulation/sim_glove.hpp"

#include "device/clamp_command.hpp"

#include <algorithm>

namespace palpate::device {

const DeviceKind kSimGlove{"sim-glove", 0, 0, 5, 0, 0.1, 0.5, 0, 0, "sim-glove", "", {0, 0, 1}, true};

namespace {

constexpr double kRoot = 0.2, kMiddle = 0.15;  // rad, of a relaxed finger
constexpr double kFollows = 0.4;               // rad by which the middle joint bends for one of the root

/// A cable's spool, its friction in the sheath, and the fingertip that it pulls.
PlantOptions cable(double way, double lag) {
  PlantOptions plant;
  plant.mass = 0.03;
  plant.friction = 0.15;
  plant.resolution = 0;  // the sensors have steps of their own
  plant.delay_in = plant.delay_out = 0.5e-3;
  plant.peak_force = kSimGlove.peak_force;
  plant.substep = 50e-6;
  Probing motion;
  motion.stroke = {0, 0, -way};
  plant.hand.intended = [motion, lag](double time) { return motion(time - lag); };
  return plant;
}

/// A tip that has closed by `way` m.
std::array<double, kJoints> closed(std::size_t finger, double way, double per_metre) {
  std::array<double, kJoints> angles = SimGlove::rest()[finger];
  angles[Joint::root] += per_metre * way;
  angles[Joint::middle] += kFollows * per_metre * way;
  return angles;
}

}  // namespace

HandJoints SimGlove::rest() {
  HandJoints angles{};
  for (std::size_t f = 0; f < kFingers; ++f) {
    angles[f] = {f == 2 ? 0 : 0.1, f == 0 ? 0.1 : kRoot, f == 0 ? 0.1 : kMiddle};
  }
  return angles;
}

SimGlove::SimGlove(const SimGloveOptions& options, SimDevice::Clock clock) : hand_(options.hand) {
  SimOptions life = options.life;
  life.unhomed = {};
  Vec3 middle;
  for (std::size_t f = 0; f < kFingers; ++f) {
    constexpr double kTurn = 1e-4;  // rad
    HandJoints turned = rest();
    turned[f] = closed(f, kTurn, 1);
    const Vec3 at = hand_.tip(f, rest()).translation;
    per_metre_[f] = kTurn / length(hand_.tip(f, turned).translation - at);
    middle = middle + (1.0 / kFingers) * at;
    constexpr double kLag = 0.15;  // s
    cables_.emplace_back(kSimGlove, device::cable(options.way[f], kLag * static_cast<double>(f)), life, clock);
  }
  wrist_.translation = -1.0 * middle;
}

std::array<Pose, kFingers> SimGlove::tips_at_rest() const {
  std::array<Pose, kFingers> tips;
  for (std::size_t f = 0; f < kFingers; ++f) tips[f] = wrist_ * hand_.tip(f, rest());
  return tips;
}

// As one device: no further than the finger that is least far, and stopped with the first that stops.
Sample SimGlove::read() noexcept {
  Sample sample = cables_.front().read();
  HandJoints angles{};
  for (std::size_t f = 0; f < kFingers; ++f) {
    const Sample each = f == 0 ? sample : cables_[f].read();
    angles[f] = closed(f, -each.pose.translation.z, per_metre_[f]);
    const bool ended = each.phase == Phase::stopped || each.phase == Phase::closed;
    if (sample.fault == Fault::none && (ended || each.phase < sample.phase)) {
      sample.phase = each.phase;
      sample.fault = each.fault;
    }
    sample.time = std::min(sample.time, each.time);
    sample.number = std::min(sample.number, each.number);
  }
  // The sensors are read once a sample.
  if (sample.number > number_) joints_ = hand_.read(angles);
  number_ = sample.number;
  sample.joints = joints_;
  sample.pose = wrist_;
  return sample;
}

void SimGlove::write(const Command& command) noexcept {
  const Command given =
      clamp_command(command, kSimGlove, command.time);  // how old it is each cable judges by its own clock
  for (std::size_t f = 0; f < kFingers; ++f) cables_[f].write({command.time, {0, 0, given.pull[f]}, {}});
}

void SimGlove::close() {
  for (SimDevice& each : cables_) each.close();
}

void SimGlove::advance(double to_time) noexcept {
  for (SimDevice& each : cables_) each.advance(to_time);
}

}  // namespace palpate::device
