// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/device/stability_cases.hpp"

#include "device/file_stiffness.hpp"
#include "palpate/output.hpp"
#include "palpate/passivity.hpp"
#include "palpate/runtime.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::test {
namespace {

using runtime::Pose;
using runtime::View;

constexpr double kTrace = 1e-4;  // J
constexpr double kEdge = 1.3;

/// A law of the depth alone.
ContactLaw plain(const char* name, double most_depth, double (*force)(double), double (*slope)(double)) {
  ContactLaw law;
  law.name = name;
  law.most_depth = most_depth;
  law.force = force;
  law.slope = slope;
  law.amplitude = [](double depth) { return 0.5 * depth; };
  law.direction = [](double) { return Vec3{0, 0, -1}; };
  law.make = [force](double scale) -> Response {
    return [force, scale](const Vec3& p, double) { return Vec3{0, 0, p.z < 0 ? scale * force(-p.z) : 0}; };
  };
  return law;
}

device::PlantOptions plant_of(const StabilityCase& c) {
  device::PlantOptions plant = c.kind->plant;
  plant.hand = c.hand->hand;
  plant.delay_in = plant.delay_out = 0.5 * c.delay;
  plant.substep = 25e-6;
  return plant;
}

double held_force(const StabilityCase& c) { return 0.45 * c.kind->plant.peak_force; }

/// Depth (m) at which the scaled law carries the hand's force.
double resting_depth(const StabilityCase& c, double scale) {
  double low = 0, high = c.law->most_depth;
  if (scale * c.law->force(high) <= held_force(c)) return high;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (scale * c.law->force(middle) < held_force(c) ? low : high) = middle;
  }
  return high;
}

double stiffness_at(const StabilityCase& c, double scale) { return scale * c.law->slope(resting_depth(c, scale)); }

/// Beyond it a swing of three encoder steps takes more than the device has.
double largest_scale(const StabilityCase& c) {
  double low = 1e-6, high = 1e12;
  for (int i = 0; i < 80; ++i) {
    const double middle = std::sqrt(low * high);
    (c.law->amplitude(resting_depth(c, middle)) > 3 * c.kind->plant.resolution ? low : high) = middle;
  }
  return low;
}

device::Onset onset_at(const StabilityCase& c, double scale) {
  const double amplitude = c.law->amplitude(resting_depth(c, scale));
  return device::onset_of_oscillation(plant_of(c), {1 / c.rate, 0}, amplitude);
}

}  // namespace

std::vector<ContactLaw> plain_laws() {
  std::vector<ContactLaw> laws = {plain(
                                      "wall", 0.02, [](double z) { return 1000 * z; }, [](double) { return 1000.0; }),
                                  plain(
                                      "Hertz", 0.02, [](double z) { return 1e4 * z * std::sqrt(z); },
                                      [](double z) { return 1.5e4 * std::sqrt(z); }),
                                  plain(
                                      "stiffening", 0.004, [](double z) { return 0.1 * std::expm1(z / 8e-4); },
                                      [](double z) { return 0.1 / 8e-4 * std::exp(z / 8e-4); })};
  laws[2].amplitude = [](double depth) { return 0.3 * depth; };
  ContactLaw spring = laws[0];
  spring.name = "spring";
  spring.height = 0;
  spring.make = [](double scale) -> Response { return [scale](const Vec3& p, double) { return -1000 * scale * p; }; };
  laws.push_back(spring);
  return laws;
}

ContactLaw file_law(const std::string& name, const View& view) {
  const runtime::BodyPoint at{0, {1.0 / 3, 1.0 / 3, 1.0 / 3}};
  const Vec3 c = position(view, at), n = normal(view, at);
  Pose frame = Pose::from_quaternion(1.000001 + n.z, -n.y, n.x, 0, c);
  frame.translation = c - find_touch(view, 0, frame).clearance * n;
  const auto field = std::make_shared<runtime::Field>(view, 0, at, runtime::ToolPoint{});
  const double step = 1e-5 * view.meta->depth_scale;
  ContactLaw law;
  law.name = name;
  law.most_depth = 0.8 * field->depth_limit();
  law.force = [field, n](double depth) { return dot(field->force(-depth * n).force, n); };
  law.slope = [field, n, step](double depth) { return device::slope(*field, -depth * n, step).norm; };
  law.amplitude = [field, n, step](double depth) {
    const device::Slope slope = device::slope(*field, -depth * n, step);
    const double sideways = slope.norm * length(tangential(slope.direction, n));
    const double most = 0.7 * field->force(-depth * n).limit;
    return sideways * 0.25 * depth < most ? 0.25 * depth : most / sideways;
  };
  law.direction = [field, n, step, frame](double depth) {
    return inverse(frame).rotate(device::slope(*field, -depth * n, step).direction);
  };
  law.make = [&view, frame](double scale) -> Response {
    const auto contact = std::make_shared<runtime::Contact>(view, 0);
    return [contact, frame, scale](const Vec3& p, double) {
      Pose pose = frame;
      pose.translation = frame.apply(p);
      return scale * inverse(frame).rotate(contact->tick(pose).force);
    };
  };
  return law;
}

std::vector<NamedHand> hands() {
  const auto hand = [](const char* name, double mass, double stiffness, double damping) {
    NamedHand h{name, {}};
    h.hand.mass = mass;
    h.hand.stiffness = stiffness;
    h.hand.damping = damping;
    return h;
  };
  return {hand("light", 0.005, 150, 1), hand("firm", 0.03, 500, 3), hand("undamped", 0.02, 200, 0)};
}

double scale_of(const StabilityCase& c, double stiffness) {
  double low = 1e-6, high = 1e12;
  for (int i = 0; i < 80; ++i) {
    const double middle = std::sqrt(low * high);
    (stiffness_at(c, middle) < stiffness ? low : high) = middle;
  }
  return low;
}

device::Swing swing(const StabilityCase& c, double scale, const Response& response) {
  device::Trial trial;
  trial.plant = plant_of(c);
  trial.timing.period = 1 / c.rate;
  trial.plant.start = {0, 0, c.law->height};
  const double depth = resting_depth(c, scale), force = scale * c.law->force(depth);
  trial.pressed = {0, 0, -depth - force / c.hand->hand.stiffness};
  trial.rest = {0, 0, -depth};
  constexpr double kTwoPi = 6.283185307179586;
  trial.amplitude = c.law->amplitude(depth) * c.law->direction(depth);
  // That of the contact's and the hand's springs, as good as the loop's own.
  const device::Hand& hand = trial.plant.hand;
  trial.frequency = std::sqrt((stiffness_at(c, scale) + hand.stiffness) / (trial.plant.mass + hand.mass)) / kTwoPi;
  trial.response = response;
  return device::run_trial(trial);
}

Response controlled(const StabilityCase& c, const Response& response) {
  runtime::output::PassivityOptions options;
  options.delay = c.delay;
  options.damping = c.kind->plant.damping;
  options.friction = 0.5 * c.kind->plant.friction;
  options.trace = kTrace;
  using Out = runtime::Output<runtime::output::Limit, runtime::output::Passivity>;
  const auto out =
      std::make_shared<Out>(runtime::output::Limit{c.kind->plant.peak_force}, runtime::output::Passivity(options));
  return [out, response](const Vec3& p, double seconds) { return (*out)(response(p, seconds), seconds, p); };
}

StabilityResult examine(const StabilityCase& c) {
  StabilityResult result;
  // Both are looked for a little farther than the device can show, so that none is lost at the edge by being there a
  // little later than the other.
  const double showing = largest_scale(c), most = kEdge * showing;
  // The smallest scale that is as stiff as the onset at its own amplitude.
  double scale = 1e-4, below = scale;
  while (scale < most && stiffness_at(c, scale) < onset_at(c, scale).stiffness) {
    below = scale;
    scale *= 1.2;
  }
  const bool predicted = scale < most;
  for (int i = 0; predicted && i < 12; ++i) {
    const double middle = std::sqrt(below * scale);
    (stiffness_at(c, middle) < onset_at(c, middle).stiffness ? below : scale) = middle;
  }
  if (!predicted) scale = most;
  const device::Onset onset = onset_at(c, scale);
  result.predicted = predicted ? stiffness_at(c, scale) : HUGE_VAL;
  result.frequency = onset.frequency;
  const auto oscillates = [&](double at) {
    ++result.trials;
    return swing(c, at, c.law->make(at)).oscillates(c.kind->plant.resolution);
  };
  // Simulated: from well below upwards, then between.
  constexpr double kStep = 1.12;
  double high = 0.5 * scale;
  while (high > 0.01 * scale && oscillates(high)) high /= kStep;
  double low = high;
  bool found = false;
  while (!found && high < std::min(3 * scale, most)) {
    low = high;
    high *= kStep;
    found = oscillates(high);
  }
  for (int i = 0; found && i < 4; ++i) {
    const double middle = std::sqrt(low * high);
    (oscillates(middle) ? high : low) = middle;
  }
  result.simulated = found ? stiffness_at(c, std::sqrt(low * high)) : HUGE_VAL;
  if (result.predicted > stiffness_at(c, showing) && result.simulated > stiffness_at(c, showing)) {
    result.predicted = result.simulated = HUGE_VAL;
    found = false;
  }
  for (const double over : {1.5, 5.0}) {
    if (!found) break;
    const double at = scale_of(c, over * result.simulated);
    const device::Swing s = swing(c, at, controlled(c, c.law->make(at)));
    ++result.trials;
    ++result.controlled;
    if (s.oscillates(c.kind->plant.resolution)) ++result.controlled_oscillate;
    const double past = s.to_hand - kTrace;
    result.past_trace = std::max(result.past_trace, past);
    result.share = std::max(result.share, past / s.on_its_way);
  }
  result.passive = device::passive_stiffness(plant_of(c), {1 / c.rate, 0}, 1).least();
  const double at = scale_of(c, 0.99 * result.passive);
  result.passive_oscillates = at < most && oscillates(at);
  return result;
}

}  // namespace palpate::test
