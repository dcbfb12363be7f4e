// SPDX-License-Identifier: MIT
#include "device/simulation/sim_device.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace palpate::device {
namespace {

/// Mass (kg), damping (N s/m), Coulomb friction (N), encoder step (m), delay there and back (s).
struct Mechanics {
  double mass, damping, friction, resolution, delay;
};

SimKind simulated(const DeviceKind& kind, const Mechanics& m) {
  SimKind result{kind, {}};
  result.plant.mass = m.mass;
  result.plant.damping = m.damping;
  result.plant.friction = m.friction;
  result.plant.resolution = m.resolution;
  result.plant.delay_in = result.plant.delay_out = 0.5 * m.delay;
  result.plant.peak_force = kind.peak_force;
  return result;
}

}  // namespace

// Force, stiffness and encoder steps are what makers and designers state (a WoodenHaptics' step: 2 pi / 2000 / 12 turns
// of 0.205 m), and so are mass and friction of "sim-touch" and "sim-premium". Other masses, friction and all viscous
// damping are estimates, for nobody states them; delays are those of the links. None was measured on a device.
const std::vector<SimKind>& sim_kinds() {
  static const std::vector<SimKind> kinds = {
      simulated({"sim", 0, 0, 5, 1000, 0.10, 0.5}, {0.10, 0.5, 0.10, 50e-6, 0.4e-3}),
      simulated({"sim-woody", 0, 0, 5, 1000, 0.10, 0.5}, {0.20, 0.5, 0.15, 54e-6, 1.0e-3}),
      simulated({"sim-falcon", 0, 0, 8, 3000, 0.04, 0}, {0.25, 1.0, 0.40, 60e-6, 1.5e-3}),
      simulated({"sim-touch", 0, 0, 3.3, 1260, 0.06, 0}, {0.045, 0.1, 0.26, 55e-6, 1.0e-3}),
      simulated({"sim-premium", 0, 0, 8.5, 3500, 0.10, 0}, {0.075, 0.05, 0.04, 30e-6, 0.2e-3}),
  };
  return kinds;
}

const SimKind* find_sim_kind(std::string_view name) {
  for (const SimKind& kind : sim_kinds()) {
    if (name == kind.kind.name) return &kind;
  }
  return nullptr;
}

const SimKind* find_stand_in(const DeviceKind& kind) {
  const std::string_view driver = kind.driver;
  return find_sim_kind(driver == "falcon" ? "sim-falcon" : driver == "wooden" ? "sim-woody" : kind.name);
}

std::optional<std::string> SimOptions::validate() const {
  if (!(starting >= 0 && starting < 3600 && homing >= 0 && homing < 3600)) {
    return "starting and homing take 0 to 3600 s";
  }
  if (!(runtime::length(unhomed) < 1e3)) return "unhomed is not finite, or beyond 1000 m";
  if (!(silent_after > 0 && silent_after <= kStale)) return "silent_after is above 0 and at most 0.01 s";
  if (!(longest_gap > 0 && longest_gap < 3600)) return "longest_gap is above 0 and below 3600 s";
  return std::nullopt;
}

SimDevice::SimDevice(const DeviceKind& kind, const PlantOptions& plant, const SimOptions& options, Clock clock)
    : kind_(kind), options_(options), clock_(clock), plant_(plant) {
  if (const auto wrong = options.validate()) throw std::invalid_argument("simulated device: " + *wrong);
  kind_.peak_force = plant.peak_force;
  opened_ = time_ = heard_ = sent_ = clock != nullptr ? clock() : 0;
  sample_.phase = phase_at(time_);
}

Phase SimDevice::phase_at(double time) const {
  if (sample_.phase == Phase::stopped) return Phase::stopped;
  const double open = plant_time(time);
  if (open < options_.starting) return Phase::starting;
  return open < options_.starting + options_.homing ? Phase::homing : Phase::ready;
}

void SimDevice::move_on() noexcept {
  if (clock_ == nullptr) return;
  const double time = clock_();
  // A program that was stopped for long must not wait for all that has not happened.
  skipped_ += std::max(0.0, time - time_ - options_.longest_gap);
  advance(time);
}

void SimDevice::advance(double to_time) noexcept {
  if (!(to_time > time_) || sample_.phase == Phase::closed) return;
  const Injected injected = injected_;
  if (injected == Injected::none) {
    heard_ = to_time;
  } else if (sample_.phase != Phase::stopped && injected == Injected::unplugged) {
    end(Phase::stopped, Fault::unplugged);
  } else if (sample_.phase != Phase::stopped && to_time > heard_ + options_.silent_after) {
    send(heard_ + options_.silent_after, {});
    end(Phase::stopped, Fault::silent);
  }
  if (pushing_ && to_time > commanded_ + kStale) send(commanded_ + kStale, {});
  // The device itself: without a message it lets go, where it has a watchdog.
  if (kind_.watchdog > 0 && to_time > sent_ + kind_.watchdog) plant_.command(plant_time(sent_ + kind_.watchdog), {});
  time_ = to_time;
  sample_.phase = phase_at(time_);
  plant_.advance(plant_time(time_) - plant_.options().delay_in);
}

void SimDevice::send(double time, const Vec3& force) noexcept {
  if (injected_ == Injected::unplugged) return;
  plant_.command(plant_time(time), force);
  sent_ = time;
  pushing_ = runtime::dot(force, force) > 0;
}

Sample SimDevice::read() noexcept {
  move_on();
  const bool measures = sample_.phase == Phase::homing || sample_.phase == Phase::ready;
  if (measures && injected_ == Injected::none && (sample_.number == 0 || time_ > sample_.time)) {
    sample_.time = time_;
    sample_.pose.translation = plant_.seen(plant_time(time_));
    if (sample_.phase == Phase::homing) sample_.pose.translation = sample_.pose.translation + options_.unhomed;
    sample_.buttons = buttons_;
    ++sample_.number;
  }
  return sample_;
}

void SimDevice::write(const Command& command) noexcept {
  move_on();
  if (sample_.phase == Phase::closed || sample_.phase == Phase::stopped) return;
  const bool believed = sample_.phase == Phase::ready && time_ - command.time <= kStale;
  commanded_ = command.time;
  send(time_, believed ? command.force : Vec3{});
}

void SimDevice::close() {
  if (sample_.phase == Phase::closed) return;
  move_on();
  send(time_, {});
  plant_.advance(plant_time(time_) + plant_.options().delay_out);
  end(Phase::closed, sample_.fault);
}

}  // namespace palpate::device
