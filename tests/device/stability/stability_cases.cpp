// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/device/stability/stability_cases.hpp"

#include "device/stability/file_stiffness.hpp"
#include "palpate/output/output_chain.hpp"
#include "palpate/output/passivity_controller.hpp"
#include "palpate/palpate.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::test {
namespace {

using runtime::CouplingOptions;
using runtime::Pose;
using runtime::Tick;
using runtime::View;

constexpr double kEdge = 1.3;

/// A contact as the device holds it: rigidly, or by a coupling.
template <class Contact, class Tie>
Response held(const Contact& contact, const Tie& tie) {
  const auto state = std::make_shared<std::pair<Contact, Tie>>(contact, tie);
  return [state](const Vec3& p, double seconds) {
    Pose pose;
    pose.translation = p;
    return state->second.tick(state->first, pose, seconds).force;
  };
}

/// `contact(scale)`: a new one.
template <class Make>
void set_contacts(ContactLaw& law, const Make& contact) {
  law.make = [contact](double scale) { return held(contact(scale), runtime::Rigid()); };
  law.couple = [contact](double scale, const CouplingOptions& options) {
    return held(contact(scale), runtime::VirtualCoupling(options));
  };
}

/// Forces that are a function of position.
struct PlainContact {
  std::function<Vec3(const Vec3&)> force;
  void reset() {}
  Tick tick(const Pose& pose) const {
    Tick tick;
    tick.force = force(pose.translation);
    return tick;
  }
};

/// A file's contact in a frame of its own, its forces scaled.
struct FileContact {
  runtime::Contact contact;
  Pose frame;
  double scale;
  void reset() { contact.reset(); }
  Tick tick(const Pose& at) {
    Pose pose = frame;
    pose.translation = frame.apply(at.translation);
    Tick tick = contact.tick(pose);
    tick.force = scale * inverse(frame).rotate(tick.force);
    return tick;
  }
};

/// Sizes (m) that virtual couplings need.
double contact_size(const PlainContact&) { return 0.05; }
double contact_size(const FileContact& file) { return runtime::contact_size(file.contact); }

/// A law of the depth alone.
ContactLaw plain(const char* name, double most_depth, double (*force)(double), double (*slope)(double)) {
  ContactLaw law;
  law.name = name;
  law.most_depth = most_depth;
  law.force = force;
  law.slope = slope;
  law.amplitude = [](double depth) { return 0.5 * depth; };
  law.direction = [](double) { return Vec3{0, 0, -1}; };
  set_contacts(law, [force](double scale) {
    return PlainContact{[force, scale](const Vec3& p) { return Vec3{0, 0, p.z < 0 ? scale * force(-p.z) : 0}; }};
  });
  return law;
}

double held_force(const StabilityCase& c) { return c.held * c.kind->plant.peak_force; }

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

/// A trial of a contact behind a spring (N/m).
device::Swing swing_behind(const StabilityCase& c, double scale, double spring, const Response& response) {
  device::Trial trial;
  trial.plant = plant_of(c);
  trial.timing.period = 1 / c.rate;
  trial.plant.start = {0, 0, c.law->height};
  const double depth = resting_depth(c, scale), force = scale * c.law->force(depth), slope = stiffness_at(c, scale);
  const double way = depth + force / spring;
  trial.pressed = {0, 0, -way - force / c.hand->hand.stiffness};
  trial.rest = {0, 0, -way};
  constexpr double kTwoPi = 6.283185307179586;
  // A soft spring would need a long way, but nobody swings a handle by decimetres.
  const double swung = c.law->amplitude(depth);
  trial.amplitude = std::max(swung, std::min((1 + slope / spring) * swung, 0.005)) * c.law->direction(depth);
  // That of the contact's and the hand's springs, as good as the loop's own.
  const device::Hand& hand = trial.plant.hand;
  const double stiffness = slope / (1 + slope / spring);
  trial.frequency = std::sqrt((stiffness + hand.stiffness) / (trial.plant.mass + hand.mass)) / kTwoPi;
  trial.response = response;
  return device::run_trial(trial);
}

/// Half of what the surface extends in the direction (of the axes) in which it extends least (m).
double middle(const View& view) {
  Vec3 low = vertex(view, 0), high = low;
  for (std::uint32_t i = 1; i < view.meta->vertex_count; ++i) {
    const Vec3 p = vertex(view, i);
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const Vec3 extent = high - low;
  return 0.5 * std::min({extent.x, extent.y, extent.z});
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
  set_contacts(spring, [](double scale) { return PlainContact{[scale](const Vec3& p) { return -1000 * scale * p; }}; });
  laws.push_back(spring);
  return laws;
}

ContactLaw file_law(const std::string& name, const View& view) {
  const runtime::BodyPoint at{0, {1.0 / 3, 1.0 / 3, 1.0 / 3}};
  const Vec3 c = position(view, at), n = smooth_normal(view, at);
  Pose frame = Pose::from_axis(c, n);
  frame.translation = c - runtime::search(view, 0, frame).touch.clearance * n;
  const auto field = std::make_shared<runtime::BlendedResponse<>>();
  field->blend(view, 0, at, {}, {1, 0, 0}, {});
  const double step = 1e-5 * view.meta->depth_scale;
  ContactLaw law;
  law.name = name;
  law.most_depth = 0.8 * field->depth_limit();
  law.farthest = middle(view);
  law.force = [field, n](double depth) { return dot(field->force(-depth * n), n); };
  law.slope = [field, n, step](double depth) { return device::slope(*field, -depth * n, step).norm; };
  law.amplitude = [field, n, step](double depth) {
    const device::Slope slope = device::slope(*field, -depth * n, step);
    const double tangential_slope = slope.norm * length(tangential(slope.direction, n));
    const runtime::ResponseAtDepth r = field->law().at(depth);
    const double most = 0.7 * r.friction_coefficient * r.normal_force;
    return tangential_slope * 0.25 * depth < most ? 0.25 * depth : most / tangential_slope;
  };
  law.direction = [field, n, step, frame](double depth) {
    return inverse(frame).rotate(device::slope(*field, -depth * n, step).direction);
  };
  set_contacts(law, [&view, frame](double scale) { return FileContact{runtime::Contact(view, 0), frame, scale}; });
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

device::PlantOptions plant_of(const StabilityCase& c) {
  device::PlantOptions plant = c.kind->plant;
  plant.hand = c.hand->hand;
  plant.delay_in = plant.delay_out = 0.5 * c.delay;
  plant.substep = 25e-6;
  return plant;
}

device::Swing swing(const StabilityCase& c, double scale, const Response& response) {
  return swing_behind(c, scale, HUGE_VAL, response);
}

device::Swing coupled_swing(const StabilityCase& c, double scale, const CouplingOptions& coupling) {
  return swing_behind(c, scale, coupling.stiffness, c.law->couple(scale, coupling));
}

Response controlled(const StabilityCase& c, const Response& response, Made& made) {
  runtime::output::PassivityOptions options;
  options.delay = c.delay;
  options.damping = c.kind->plant.damping;
  options.friction = 0.5 * c.kind->plant.friction;
  options.trace = 0.5 * kTrace;
  options.pause = HUGE_VAL;  // one of the hands has no damping
  using Out = runtime::OutputChain<runtime::output::Limit, runtime::output::PassivityController>;
  const auto out =
      std::make_shared<Out>(runtime::output::Limit{c.kind->plant.peak_force}, runtime::output::PassivityController(options));
  return [out, response, &made](const Vec3& p, double seconds) {
    const Vec3 force = (*out)(response(p, seconds), seconds, p);
    const auto& passivity = out->step<runtime::output::PassivityController>();
    made = {std::max(made.most, passivity.made()), passivity.bound()};
    return force;
  };
}

StabilityResult examine(const StabilityCase& c) {
  StabilityResult result;
  const device::LoopTiming timing{1 / c.rate, 0};
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
    Made made;
    const device::Swing s = swing(c, at, controlled(c, c.law->make(at), made));
    ++result.trials;
    ++result.controlled;
    if (s.oscillates(c.kind->plant.resolution)) ++result.controlled_oscillate;
    result.given = std::max(result.given, s.to_hand);
    result.made = std::max(result.made, made.most);
    result.made_share = std::max(result.made_share, made.most / made.bound);
  }
  for (const double over : {1.5, 5.0, 50.0}) {
    if (!found) break;
    const double stiffness = over * result.simulated, safe = device::passive_stiffness(plant_of(c), timing).least();
    CouplingOptions coupling;
    coupling.stiffness = stiffness * safe / (stiffness - safe);
    result.softest = std::min(result.softest, coupling.stiffness);
    result.stiffest = std::max(result.stiffest, coupling.stiffness);
    ++result.trials;
    ++result.coupled;
    // Not so hard that a soft spring lets the device through the body.
    StabilityCase held = c;
    held.held = std::min(c.held, coupling.stiffness * c.law->farthest / c.kind->plant.peak_force);
    const device::Swing s = coupled_swing(held, scale_of(held, stiffness), coupling);
    if (s.oscillates(c.kind->plant.resolution)) ++result.coupled_oscillate;
    result.coupled_given = std::max(result.coupled_given, s.to_hand);
  }
  result.passive = device::passive_stiffness(plant_of(c), timing, 1).least();
  const double at = scale_of(c, 0.99 * result.passive);
  result.passive_oscillates = at < most && oscillates(at);
  return result;
}

}  // namespace palpate::test
