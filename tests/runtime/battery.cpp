// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/runtime/battery.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "palpate/checksum.hpp"
#include "tests/runtime/battery_loop.hpp"

namespace palpate::test {

using namespace battery;

void BatteryResult::add(const BatteryResult& o) {
  ticks += o.ticks;
  touching += o.touching;
  sliding += o.sliding;
  contacts += o.contacts;
  broken += o.broken;
  force = std::max(force, o.force);
  step = std::max(step, o.step);
  leap = std::max(leap, o.leap);
  begin = std::max(begin, o.begin);
  gain = std::max(gain, o.gain);
  gained += o.gained;
  gross += o.gross;
  acting += o.acting;
  lost += o.lost;
  drag = std::max(drag, o.drag);
  hash = 31 * hash + o.hash;
}

namespace {

// N/m, of small pushes sideways, in two directions across n(c).
double sideways_stiffness(const runtime::Field& field, const runtime::DepthTerms& terms, double aside) {
  if (!(aside > 0)) return 0;
  const Vec3 x = aside * runtime::any_orthogonal(field.normal()), y = cross(field.normal(), x);
  return std::max(length(field.sideways(terms, x)), length(field.sideways(terms, y))) / aside;
}

}  // namespace

double Stiffest::at(double depth) const { return within + further * std::max(0.0, depth / depth_scale - 1); }

Stiffest stiffest(const View& view, std::uint32_t tool) {
  Random random(1);
  const double z = view.meta->depth_scale, aside = 0.02 * view.meta->sideways_scale;
  const layout::ToolRecord& record = view.tools[tool];
  double most = 0, further = 0;
  for (std::uint32_t t = 0; t < view.meta->triangle_count; ++t) {
    for (int k = 0; k < 3; ++k) {
      BodyPoint at{t, {0, 0, 0}};
      at.bary[k] = 1;
      runtime::ToolPoint on_tool{record.first_patch, {1, 0, 0}};
      if (record.patch_count > 0) on_tool.patch += random.below(record.patch_count);
      const runtime::Field field(view, tool, at, on_tool);
      const double slope = (field.at_depth(1.2 * z).normal_force - field.at_depth(1.1 * z).normal_force) / (0.1 * z);
      const runtime::DepthTerms terms = field.at_depth(z);
      const double sideways = sideways_stiffness(field, terms, aside);
      most = std::max({most, slope, terms.normal_force / z, sideways});
      further = std::max(further, sideways_stiffness(field, field.at_depth(2 * z), aside) - sideways);
    }
  }
  return {1.1 * most, 1.1 * further, z};
}

BatteryResult run_battery(const View& view, const BatteryCase& c) {
  const Stiffest stiff = stiffest(view, c.tool);
  const double factor = c.driver == Driver::online ? 3 : 1, k = factor * stiff.within, scale = view.meta->depth_scale;
  const double reach = runtime::skeleton_radius(view, c.tool) + view.tools[c.tool].probe_radius;
  Hand hand(view, c);
  Loop loop(view, c);
  BatteryResult r;
  checksum::Xxh64 hash;
  constexpr double kNothing = 1e-7;  // of the depth scale: half a nanometre, that a contact may begin inside by
  const double drift = c.driver == Driver::online ? 5e-3 * scale : 0;  // factors change by as much in a tick
  Pose asked = hand.next();
  loop.put(asked);
  Pose before = loop.in_world(asked);
  Tick last = loop.tick(before);
  std::array<Friction, Together::kPlaces> friction;
  double deepest = loop.deepest(last);
  double before_that = 0;  // m moved in the tick before: where the body is animated, a part is told a tick late
  double work = 0, gross = 0, worst = 0, lost = 0;
  double hidden = 0;  // J at most, between the sum and what the hand gave on its way from tick to tick
  const auto close = [&] {
    r.contacts += gross > 0;
    r.gross += gross;
    r.gained += worst;
    const double least = c.motion == Motion::fast ? 0.02 : 1e-3;
    if (gross > 0 && worst > 0) r.gain = std::max(r.gain, worst / std::max(gross, least * k * scale * scale));
    work = gross = worst = hidden = 0;
  };
  const auto begin = [&](const Pose& from) {
    last = {};
    for (Friction& one : friction) one.begin();
    before = from;
  };
  for (r.ticks = 1; r.ticks < c.ticks; ++r.ticks) {
    const Pose next = hand.next();
    const bool put = length(next.translation - asked.translation) > 0.01 * scale;
    asked = next;
    if (c.motion != Motion::fast && put) {
      // The hand is put to its next place, perhaps inside the body: what it finds there is a start.
      loop.reset();
      loop.put(asked);
      close();
      begin(loop.in_world(asked));
    }
    const Pose pose = loop.in_world(asked);
    const Tick tick = loop.tick(pose);
    const double values[] = {tick.force.x, tick.force.y, tick.force.z, tick.torque.x, tick.torque.y, tick.torque.z};
    hash.update(values, sizeof values);
    const double size = length(tick.force);
    if (!std::isfinite(size + length(tick.torque)) || (size > 0 && !(tick.depth > 0)) || tick.state == State::fault) {
      ++r.broken;
      begin(pose);
      continue;
    }
    // Of the tool against the surface: so works the hand, and so the surface.
    const Pose surface = loop.surface_motion();
    const Vec3 way = pose.translation - surface.apply(before.translation);
    const Vec3 turned = turn_between({}, surface), turn = turn_between(before, pose) - turned;
    const double moved = length(way) + reach * (length(turn) + length(turned));
    r.touching += tick.touches();
    r.sliding += tick.state == State::slide;
    if (const double paid = loop.lost(); paid != lost) {  // a contact that begins has paid nothing
      r.acting += paid > 0;
      r.lost += paid > lost ? paid - lost : paid;
      lost = paid;
    }
    r.force = std::max(r.force, size / (k * std::max(scale, tick.depth)));
    const bool goes_on = tick.touches() && last.touches();
    const double crept = goes_on ? length(tick.body_point - last.body_point) : 0;
    const double late = c.driver == Driver::animated ? before_that : 0;
    const double change = length(tick.force - last.force),
                 here = factor * stiff.at(std::max(deepest, loop.deepest(tick)));
    const double step = change / (here * (moved + crept + late + drift + kNothing * scale));
    before_that = moved + crept;
    const bool begins = tick.touches() != last.touches() && (c.driver == Driver::late || c.motion == Motion::fast);
    if (begins) {
      r.begin = std::max(r.begin, (change - 2 * k * moved) / (k * scale));
    } else if (c.motion != Motion::fast || moved < 0.5 * scale) {
      r.step = std::max(r.step, step);
      // A tool that turns rolls on by 1e-3 of its size at once; against a body whose vertices move it always turns.
      if (goes_on && c.motion != Motion::fast && c.motion != Motion::turn) {
        const double rolls = c.driver == Driver::animated ? 1e-3 : 2.5e-5;
        const double anyhow = late + drift + rolls * (view.tools[c.tool].probe_radius + scale);
        r.leap = std::max(r.leap, change / (here * (moved + anyhow)));
      }
    }
    const double w = -0.5 * (dot(last.force + tick.force, way) + dot(last.torque + tick.torque, turn));
    work += w;
    gross += std::fabs(w);
    if (c.motion == Motion::fast) {
      hidden += 0.5 * (std::fabs(dot(tick.force - last.force, way)) + std::fabs(dot(tick.torque - last.torque, turn)));
    }
    worst = std::max(worst, -work - hidden);
    if (!tick.touches() && last.touches()) close();
    if (c.motion != Motion::fast) {
      loop.each(tick, [&](std::size_t i, const Tick& one, const Vec3& at, const Vec3& n) {
        friction[i].add(one, at, n, surface, turn, view.tools[c.tool].probe_radius);
      });
    }
    last = tick;
    deepest = loop.deepest(tick);
    before = pose;
  }
  double taken = 0, given = 0;
  for (const Friction& one : friction) {
    taken += one.taken;
    given += one.given;
  }
  r.drag = taken > 0 ? given / taken : 0;
  r.hash = hash.digest();
  return r;
}

std::string broken_promise(const BatteryCase& c, const BatteryResult& r) {
  const bool fast = c.motion == Motion::fast;
  if (r.broken > 0) return "a force that is not finite, or without depth, or a fault at a good pose";
  if (r.force > 1.2) return "a force beyond what the stiffest place answers with";
  if (r.step > (fast ? 2.5 : 2)) return "a force that changed by more than its bound a metre";
  if (r.leap > 5) return "a force that leapt while the tool hardly moved";
  if (r.begin > 5e-3) return "a contact that began or ended with a force";
  if (r.gain > (fast ? 0.02 : 1e-3)) return "a contact that gave back more than it took";
  if (r.drag > 1e-3) return "a friction that drove";
  return {};
}

const char* name(Motion motion) {
  static const char* const kNames[] = {"press", "graze", "corner", "turn", "fast"};
  return kNames[static_cast<int>(motion)];
}

const char* name(Driver driver) {
  static const char* const kNames[] = {"alone", "late", "online", "animated", "several"};
  return kNames[static_cast<int>(driver)];
}

}  // namespace palpate::test
