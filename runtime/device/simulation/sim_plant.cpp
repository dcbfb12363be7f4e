// SPDX-License-Identifier: MIT
#include "device/simulation/sim_plant.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace palpate::device {
namespace {

double stepped(double value, double step) { return step > 0 ? step * std::floor(value / step + 0.5) : value; }

}  // namespace

Intent Probing::operator()(double time) const {
  constexpr double kTwoPi = 6.283185307179586;
  const double stroke_rate = kTwoPi * frequency, sway_rate = kTwoPi * swaying;
  const double a = stroke_rate * time, b = sway_rate * time;
  return {from + 0.5 * (1 - std::cos(a)) * stroke + std::sin(b) * sway,
          0.5 * stroke_rate * std::sin(a) * stroke + sway_rate * std::cos(b) * sway};
}

std::optional<std::string> PlantOptions::validate() const {
  const struct {
    const char* name;
    double value, low, high;
    const char* unit;
  } ranges[] = {{"mass", mass, 1e-6, 1e3, "kg"},
                {"damping", damping, 0, 1e6, "N s/m"},
                {"friction", friction, 0, 1e6, "N"},
                {"resolution", resolution, 0, 1, "m"},
                {"delay_in", delay_in, 0, 0.1, "s"},
                {"delay_out", delay_out, 0, 0.1, "s"},
                {"peak_force", peak_force, 1e-6, 1e6, "N"},
                {"substep", substep, 1e-7, 1e-3, "s"},
                {"hand.mass", hand.mass, 0, 1e3, "kg"},
                {"hand.stiffness", hand.stiffness, 0, 1e6, "N/m"},
                {"hand.damping", hand.damping, 0, 1e6, "N s/m"}};
  for (const auto& r : ranges) {
    if (r.value >= r.low && r.value <= r.high) continue;
    char text[160];
    std::snprintf(text, sizeof text, "%s is %g %s, allowed %g to %g", r.name, r.value, r.unit, r.low, r.high);
    return text;
  }
  if (!finite(start)) return "start is not finite";
  // The spring is integrated explicitly.
  if (substep * std::sqrt(hand.stiffness / (mass + hand.mass)) > 0.5) {
    return "substep is too long for the hand's stiffness and the mass";
  }
  return std::nullopt;
}

SimPlant::SimPlant(const PlantOptions& options) : options_(options), position_(options.start) {
  if (const auto wrong = options.validate()) throw std::invalid_argument("simulated device: " + *wrong);
}

Vec3 SimPlant::seen(double time) {
  advance(time - options_.delay_in);
  const double q = options_.resolution;
  return {stepped(position_.x, q), stepped(position_.y, q), stepped(position_.z, q)};
}

void SimPlant::command(double time, const Vec3& force) {
  const double size = runtime::length(force), most = options_.peak_force;
  Pending next{time + options_.delay_out, {}};
  if (std::isfinite(size)) next.force = size > most ? (most / size) * force : force;
  // Nobody sends so often that the ring fills; who does loses all but the newest.
  if (count_ == pending_.size()) --count_;
  pending_[(first_ + count_++) % pending_.size()] = next;
}

void SimPlant::advance(double to) {
  while (count_ > 0 && pending_[first_].at <= to) {
    run(pending_[first_].at);
    force_ = pending_[first_].force;
    first_ = (first_ + 1) % pending_.size();
    --count_;
  }
  run(to);
}

void SimPlant::place(const Vec3& position, const Vec3& velocity) {
  given_ += runtime::dot(force_, position - position_);
  position_ = position;
  velocity_ = velocity;
}

// The spring is taken where the handle is after half a substep, the position moves with the mean of both velocities: of
// second order, the swing of the spring is kept, and the work of a constant force is exactly what becomes of it.
// Coulomb friction is what it can take of the velocity at most, the implicit step of its inclusion (Moreau): the handle
// rests where friction holds, and no sign of a small velocity ever chatters.
void SimPlant::run(double to) {
  if (!(to > time_)) return;
  const PlantOptions& o = options_;
  const double mass = o.mass + o.hand.mass, damping = o.damping + o.hand.damping;
  const double steps = std::ceil((to - time_) / o.substep), h = (to - time_) / steps;
  const double kept = std::exp(-h * damping / mass);
  const double gain = damping > 0 ? -std::expm1(-h * damping / mass) / damping : h / mass;
  const Vec3 before = position_;
  for (double k = 0; k < steps; ++k) {
    Intent intent;
    if (o.hand.intended) intent = o.hand.intended(time_ + (k + 0.5) * h);
    const Vec3 pull = force_ + o.hand.stiffness * (intent.position - position_ - 0.5 * h * velocity_) +
                      o.hand.damping * intent.velocity;
    const Vec3 free = kept * velocity_ + gain * pull;
    const double speed = runtime::length(free), taken = gain * o.friction;
    const Vec3 next = speed > taken ? (1 - taken / speed) * free : Vec3{};
    const Vec3 moved = 0.5 * h * (velocity_ + next);
    position_ = position_ + moved;
    lost_ += o.damping * runtime::dot(moved, moved) / h + o.friction * runtime::length(moved);
    velocity_ = next;
  }
  given_ += runtime::dot(force_, position_ - before);
  time_ = to;
}

}  // namespace palpate::device
