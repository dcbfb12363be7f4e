// SPDX-License-Identifier: MIT
#include "device/closed_loop.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace palpate::device {
namespace {

/// Largest half width, over the axes, of what it was shown.
class Box {
public:
  void add(const Vec3& p) {
    low_ = {std::min(low_.x, p.x), std::min(low_.y, p.y), std::min(low_.z, p.z)};
    high_ = {std::max(high_.x, p.x), std::max(high_.y, p.y), std::max(high_.z, p.z)};
  }
  [[nodiscard]] double amplitude() const {
    return 0.5 * std::max({high_.x - low_.x, high_.y - low_.y, high_.z - low_.z, 0.0});
  }

private:
  Vec3 low_{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high_{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
};

}  // namespace

Swing run_trial(const Trial& trial) {
  if (const auto wrong = trial.timing.validate()) throw std::invalid_argument("force loop: " + *wrong);
  if (!(trial.arrive > 0 && trial.swing > trial.arrive && trial.swing < 3600 && trial.frequency > 0.01)) {
    throw std::invalid_argument("trial: arrive above 0, swing above arrive and frequency above 0.01 Hz are wanted");
  }
  PlantOptions options = trial.plant;
  options.hand.intended = [&trial](double time) -> Intent {
    const double share = std::min(1.0, time / trial.arrive);
    const Vec3 way = trial.pressed - trial.plant.start;
    const Vec3 speed = share < 1 ? (6 * share * (1 - share) / trial.arrive) * way : Vec3{};
    return {trial.plant.start + (share * share * (3 - 2 * share)) * way, speed};
  };
  SimPlant plant(options);
  constexpr double kTwoPi = 6.283185307179586, kSettle = 0.05, kWindow = 0.25, kLater = 2.0;
  const double period = trial.timing.period, free = trial.swing + 2 / trial.frequency;
  const double end = free + kSettle + kLater + kWindow, omega = kTwoPi * trial.frequency;
  Swing swing;
  Box early, late;
  double fastest = 0, strongest = 0;
  const auto ticks = static_cast<int>(std::ceil(end / period));
  for (int k = 0; k < ticks; ++k) {
    const double time = k * period;
    const Vec3 seen = plant.seen(time);
    if (time >= trial.swing && time < free) {
      // Where the handle is in the plant's time, which is that of the sample.
      const double angle = omega * (plant.time() - trial.swing);
      plant.place(trial.rest + std::sin(angle) * trial.amplitude, omega * std::cos(angle) * trial.amplitude);
    }
    plant.command(time + trial.timing.computing, trial.response(seen, period));
    const double after = time - free - kSettle;
    if (after >= 0 && after < kWindow) early.add(plant.position());
    if (after >= kLater) late.add(plant.position());
    fastest = std::max(fastest, runtime::length(plant.velocity()));
    strongest = std::max(strongest, runtime::length(plant.force()));
    swing.given = std::max(swing.given, plant.given());
    swing.to_hand = std::max(swing.to_hand, plant.given() - plant.lost());
  }
  const double late_by = options.delay_in + options.delay_out + trial.timing.computing;
  swing.on_its_way = strongest * fastest * (late_by + 2 * period);
  swing.early = early.amplitude();
  swing.late = late.amplitude();
  return swing;
}

}  // namespace palpate::device
