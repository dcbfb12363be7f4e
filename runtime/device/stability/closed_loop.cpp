// SPDX-License-Identifier: MIT
#include "device/stability/closed_loop.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
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

/// From 0 to 1 between two times, at rest at both.
struct Fade {
  double share = 0, rate = 0;  ///< 1, 1/s
};

Fade fade_in(double time, double from, double to) {
  const double s = std::clamp((time - from) / (to - from), 0.0, 1.0);
  return {s * s * (3 - 2 * s), 6 * s * (1 - s) / (to - from)};
}

}  // namespace

Swing run_trial(const Trial& trial) {
  if (const auto wrong = trial.timing.validate()) throw std::invalid_argument("force loop: " + *wrong);
  if (!(trial.arrive > 0 && trial.swing > trial.arrive && trial.swing < 3600 && trial.frequency > 0.01)) {
    throw std::invalid_argument("trial: arrive above 0, swing above arrive and frequency above 0.01 Hz are wanted");
  }
  PlantOptions options = trial.plant;
  options.hand.intended = [&trial](double time) -> Intent {
    const Fade fade = fade_in(time, 0, trial.arrive);
    const Vec3 way = trial.pressed - trial.plant.start;
    return {trial.plant.start + fade.share * way, fade.rate * way};
  };
  SimPlant plant(options);
  constexpr double kTwoPi = 6.283185307179586, kSettle = 0.05, kWindow = 0.25, kLater = 2.0;
  const double period = trial.timing.period, free = trial.swing + 2 / trial.frequency;
  const double take = 0.5 * (trial.arrive + trial.swing);
  const double end = free + kSettle + kLater + kWindow, omega = kTwoPi * trial.frequency;
  Swing swing;
  Box early, late;
  std::optional<Vec3> taken;
  const auto ticks = static_cast<int>(std::ceil(end / period));
  for (int k = 0; k < ticks; ++k) {
    const double time = k * period;
    const Vec3 seen = plant.seen(time);
    if (time >= take && time < free) {
      if (!taken) taken = plant.position();
      // The handle's angle at the plant's time, which is the sample's time.
      const double angle = omega * (plant.time() - trial.swing);
      const Fade fade = fade_in(plant.time(), take, trial.swing);
      const Vec3 swung = trial.rest + std::sin(angle) * trial.amplitude - *taken;
      plant.place(*taken + fade.share * swung,
                  fade.rate * swung + (fade.share * omega * std::cos(angle)) * trial.amplitude);
    }
    plant.command(time + trial.timing.computing, trial.response(seen, period));
    const double after = time - free - kSettle;
    if (after >= 0 && after < kWindow) early.add(plant.position());
    if (after >= kLater) late.add(plant.position());
    swing.given = std::max(swing.given, plant.given());
    swing.to_hand = std::max(swing.to_hand, plant.given() - plant.lost());
  }
  swing.early = early.amplitude();
  swing.late = late.amplitude();
  return swing;
}

}  // namespace palpate::device
