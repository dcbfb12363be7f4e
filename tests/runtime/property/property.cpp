// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/runtime/property/property.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "tests/runtime/property/driver.hpp"

namespace palpate::test {

using namespace property;

void PropertyResult::add(const PropertyResult& o) {
  ticks += o.ticks;
  touching += o.touching;
  sliding += o.sliding;
  contacts += o.contacts;
  broken += o.broken;
  force = std::max(force, o.force);
  step = std::max(step, o.step);
  jump = std::max(jump, o.jump);
  onset = std::max(onset, o.onset);
  gain = std::max(gain, o.gain);
  gross += o.gross;
  drive = std::max(drive, o.drive);
  least_counted = std::min(least_counted, o.least_counted);
  hash = 31 * hash + o.hash;
}

double Stiffest::at(double depth) const { return within + further * std::max(0.0, depth / depth_scale - 1); }

Stiffest stiffest(const View& view, std::uint32_t tool) {
  Random random(1);
  const double z = view.meta->depth_scale;
  const layout::ToolRecord& record = view.tools[tool];
  Stiffest result;
  result.depth_scale = z;
  const auto largest = [](const runtime::Sym2& k) { return k.m + std::hypot(k.x, k.y); };
  for (std::uint32_t t = 0; t < view.meta->triangle_count; ++t) {
    for (int k = 0; k < 3; ++k) {
      BodyPoint at{t, {0, 0, 0}};
      at.bary[k] = 1;
      runtime::ToolPoint on_tool{record.first_patch, {1, 0, 0}};
      if (record.patch_count > 0) on_tool.patch += random.below(record.patch_count);
      runtime::BlendedResponse<> response;
      response.blend(view, tool, at, on_tool, {1, 0, 0}, nullptr);
      const runtime::ResponseAtDepth r = response.law().at(z), deep = response.law().at(2 * z);
      const double tangential = largest(r.stiffness);
      result.within = std::max({result.within, deep.normal_slope, r.normal_force / z, tangential,
                                (r.normal_force + length(r.bias)) / z});
      result.further = std::max(result.further, largest(deep.stiffness) - tangential);
      result.friction = std::max(result.friction, r.friction_coefficient);
    }
  }
  result.within *= 1.1;
  result.further *= 1.1;
  return result;
}

PropertyResult run_property(const View& view, const PropertyCase& c) {
  const Stiffest stiff = stiffest(view, c.tool);
  const double factor = c.driver == Driver::scaled ? 3 : 1, k = factor * stiff.within, scale = view.meta->depth_scale;
  const double reach = runtime::ToolShape<>(view, c.tool).extent();
  const bool fast = c.motion == Motion::fast;
  FrictionWork friction;
  Hand hand(view, c);
  Loop loop(view, c);
  PropertyResult r;
  constexpr double kNothing = 1e-7;  // of the depth scale: half a nanometre
  const double drift = c.driver == Driver::scaled ? 5e-3 * scale : 0;  // factors change the force as much in a tick
  Pose asked = hand.next();
  loop.put(asked);
  Pose before = loop.in_world(asked);
  Tick last = loop.tick(before);
  loop.remember();
  double deepest = loop.depth(last), moved_before = 0;  // m
  double work = 0, gross = 0, worst = 0;
  double hidden = 0;  // J at most between the sum over trapezoids and the hand's work from tick to tick
  const auto close = [&] {
    r.contacts += gross > 0;
    r.gross += gross;
    const double least = fast ? 0.02 : 1e-3;
    if (gross > 0 && worst > 0) r.gain = std::max(r.gain, worst / std::max(gross, least * k * scale * scale));
    work = gross = worst = hidden = 0;
    friction.close(1e-3 * k * scale * scale);
  };
  const auto begin = [&](const Pose& from) {
    last = Tick{};
    before = from;
  };
  for (r.ticks = 1; r.ticks < c.ticks; ++r.ticks) {
    const Pose next = hand.next();
    const bool put = length(next.translation - asked.translation) > 0.01 * scale;
    asked = next;
    if (!fast && put) {  // a start, perhaps inside the body
      loop.reset();
      loop.put(asked);
      close();
      begin(loop.in_world(asked));
    }
    const Pose pose = loop.in_world(asked);
    const Tick tick = loop.tick(pose);
    const double values[] = {tick.force.x, tick.force.y, tick.force.z, tick.torque.x, tick.torque.y, tick.torque.z};
    for (const double value : values) {
      std::uint64_t bits;
      std::memcpy(&bits, &value, sizeof bits);
      r.hash = (r.hash ^ bits) * 0x100000001b3ULL;
    }
    const double size = length(tick.force);
    if (!std::isfinite(size + length(tick.torque)) || (size > 0 && !(tick.depth > 0)) || tick.state == State::fault) {
      ++r.broken;
      begin(pose);
      continue;
    }
    // The hand works on the tool against the surface, and so does the surface.
    const Pose surface = loop.surface_motion();
    const Vec3 way = pose.translation - surface.apply(before.translation);
    const Vec3 turned = turn_between({}, surface), turn = turn_between(before, pose) - turned;
    const double moved = length(way) + reach * (length(turn) + length(turned));
    r.touching += tick.touches();
    r.sliding += tick.state == State::slide;
    const double depth = loop.depth(tick);
    r.force = std::max(r.force, size / (k * std::max(scale, depth)));
    if (tick.depth > 0) r.least_counted = std::min(r.least_counted, tick.counted_depth / tick.depth);
    const bool goes_on = tick.touches() && last.touches();
    const double crept = loop.point_motion();
    const double late = c.driver == Driver::deforming ? moved_before : 0;
    const double change = length(tick.force - last.force), here = factor * stiff.at(std::max(deepest, depth));
    const double step = change / (here * (moved + crept + late + drift + kNothing * scale));
    moved_before = moved + crept;
    const bool begins = tick.touches() != last.touches() && (c.driver == Driver::searched || fast);
    if (begins) {
      r.onset = std::max(r.onset, (change - 2 * k * moved) / (k * scale));
    } else if (!fast || moved < 0.5 * scale) {
      r.step = std::max(r.step, step);
      if (goes_on && !fast && c.motion != Motion::turn) {
        r.jump = std::max(r.jump, change / (here * (moved + late + drift + kNothing * scale)));
      }
    }
    const double w = -0.5 * (dot(last.force + tick.force, way) + dot(last.torque + tick.torque, turn));
    work += w;
    gross += std::fabs(w);
    if (fast) {
      hidden += 0.5 * (std::fabs(dot(tick.force - last.force, way)) + std::fabs(dot(tick.torque - last.torque, turn)));
    }
    worst = std::max(worst, -work - hidden);
    if (!fast && tick.touches() && c.driver != Driver::set) {
      friction.add(tick, loop.bias(tick), way + cross(turn, tick.tool_point - pose.translation));
    }
    if (!tick.touches() && last.touches()) close();
    loop.remember();
    last = tick;
    deepest = depth;
    before = pose;
  }
  r.drive = friction.worst;
  return r;
}

std::string broken_promise(const PropertyCase& c, const PropertyResult& r, double friction) {
  const bool coarse = c.motion == Motion::fast;
  if (r.broken > 0) return "1: a force that is not finite, or without depth, or a fault at a good pose";
  if (r.force > 1.2) return "2: a force beyond that of the stiffest place";
  if (r.step > 2.5) return "3: a change of the force per metre of skin and c";
  if (r.jump > (friction >= 1 ? 10 : 5)) return "4: a change of the force per metre of a slow tool";
  if (r.onset > 5e-3) return "5: a contact that begins or ends with a force";
  if (r.gain > (coarse ? 0.02 : 1e-3)) return "6: a contact that gives back more than it took";
  if (r.drive > 1e-3) return "7: a friction that drives";
  return {};
}

const char* name(Motion motion) {
  static const char* const kNames[] = {"press", "graze", "corner", "turn", "fast"};
  return kNames[static_cast<int>(motion)];
}

const char* name(Driver driver) {
  static const char* const kNames[] = {"alone", "searched", "scaled", "deforming", "set"};
  return kNames[static_cast<int>(driver)];
}

}  // namespace palpate::test
