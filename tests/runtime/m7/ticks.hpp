// SPDX-License-Identifier: GPL-3.0-or-later
// The ticks of all tools of a response file along motions that host and microcontroller make alike.
#pragma once

#include <cmath>
#include <cstdint>

#include "palpate/palpate.hpp"
#include "tests/runtime/wandering.hpp"

namespace palpate::test {

enum class Hand : std::uint32_t {
  wandering,  ///< as a hand may
  /// As fast as a hand goes: in and out again at up to 0.5 m/s (a thousand ticks a second), aslant by up to 60 degrees,
  /// tilting by 5 rad/s meanwhile. It begins between two ticks and slides at once.
  stabbing,
  /// Beyond any motion: at every tick another depth, from a millionth to half of the scale, and another tilt, up to 55
  /// degrees and mostly much less.
  leaping
};

/// The result and the time of one tick, as the board writes them.
struct TickRecord {
  std::uint32_t state;
  float force[3], torque[3];  ///< N, N m
  /// Instructions: of the tick, which was given a search; of the search for later ones; of a tick that searches itself;
  /// of the first in a program of fewer features (0 where there is none). The last two are of a wandering hand.
  std::uint32_t tick, search, alone, lean;
};

/// The tick of the one contact of a program with these features, each in a translation unit of its own (program.cpp).
using ProgramTick = runtime::Tick (*)(const runtime::Pose&, const runtime::Search&);
/// Begins it anew.
template <std::uint32_t kFeatures>
ProgramTick begin_program(const runtime::View& view, std::uint32_t tool);

/// Position of a tool at every tick, over the box of response_samples.hpp.
class Motion {
public:
  Motion(const runtime::View& view, std::uint32_t tool, Hand hand)
      : hand_(hand),
        scale_(view.meta->depth_scale),
        round_(view.tools[tool].probe_radius),
        corners_(round_ > 0 ? 0 : runtime::ToolShape<>(view, tool).reach()),
        wandering_(tool),
        random_(tool) {}

  runtime::Pose next() {
    if (hand_ == Hand::stabbing) return stab();
    const runtime::Pose pose = wandering_.next();
    if (hand_ == Hand::wandering) return pose;
    const double most = halved(0.3, 7), x = tilt(most), y = tilt(most), z = tilt(most);  // tangents of half an angle
    const double depth = halved(0.5 * scale_ * (1 - 0.5 * uniform()), 19);
    runtime::Pose leap = runtime::Pose::from_quaternion(1, x, y, z, pose.translation);
    double below = 0;  // of a mesh: the sample's is an octahedron
    for (int k = 0; k < 3; ++k) below = std::fmax(below, std::fabs(leap.rotation[6 + k]));
    leap.translation.z = kTop + round_ + corners_ * below - depth;
    return leap;
  }

private:
  static constexpr double kTop = 0.015;  // m

  /// Straight in, as deep as half of the scale or a little more, and back: a way that every stab draws anew.
  runtime::Pose stab() {
    if (stab_ticks_ == 0) {
      stab_ticks_ = 40;
      const runtime::Vec3 towards{2.5 * uniform() - 1.25, 2.5 * uniform() - 1.25, -1};
      way_ = (2.5e-4 * (1 + uniform()) / length(towards)) * towards;
      turning_ = {tilt(0.0025), tilt(0.0025), tilt(0.0025)};  // half an angle a tick
      at_ = {0.005 * (2 * uniform() - 1), 0.005 * (2 * uniform() - 1), kTop + round_ + corners_ - 10 * way_.z};
      turned_ = {tilt(0.2), tilt(0.2), tilt(0.2)};
    }
    const double goes = --stab_ticks_ >= 20 ? 1 : -1;
    at_ = at_ + goes * way_;
    turned_ = turned_ + goes * turning_;
    return runtime::Pose::from_quaternion(1, turned_.x, turned_.y, turned_.z, at_);
  }

  double uniform() {
    random_ = 1664525u * random_ + 1013904223u;
    return (random_ >> 8) / 16777216.0;
  }
  double tilt(double most) { return most * (2 * uniform() - 1); }
  /// Fewer than so many times.
  double halved(double value, int times) { return std::ldexp(value, -static_cast<int>(times * uniform())); }

  Hand hand_;
  double scale_, round_, corners_;  ///< m
  Wandering wandering_;
  std::uint32_t random_;
  int stab_ticks_ = 0;
  runtime::Vec3 at_, way_, turned_, turning_;
};

constexpr int kSearchEvery = 20;

/// The longest of `ticks` ticks of a tool in a program of all features, as `count(work)` counts them.
template <class Count>
std::uint32_t longest_tick(const runtime::View& view, std::uint32_t tool, Hand hand, int ticks, const Count& count) {
  Motion motion(view, tool, hand);
  const ProgramTick full = begin_program<layout::feature_all>(view, tool);
  runtime::Search coming, latest;
  std::uint32_t most = 0;
  for (int i = 0; i < ticks; ++i) {
    const runtime::Pose pose = motion.next();
    if (i % kSearchEvery == 0) {
      latest = i > 0 ? coming : search(view, tool, pose);
      coming = search(view, tool, pose);
    }
    const std::uint32_t instructions = count([&] { full(pose, latest); });
    most = instructions > most ? instructions : most;
  }
  return most;
}

/// `count(work)` does the work and says how many instructions it took; `lean(view, tool)` begins a ProgramTick or is
/// null; `keep(record, hand)` is given every tick's.
template <class Count, class Lean, class Keep>
void tick_all(const runtime::View& view, const Count& count, const Lean& lean, const Keep& keep) {
  constexpr int kTicks = 1000;
  for (std::uint32_t run = 0; run < 3 * view.meta->tool_count; ++run) {
    const auto hand = static_cast<Hand>(run / view.meta->tool_count);
    const std::uint32_t tool = run % view.meta->tool_count;
    Motion motion(view, tool, hand);
    runtime::Contact alone(view, tool);
    const ProgramTick full = begin_program<layout::feature_all>(view, tool), fewer = lean(view, tool);
    runtime::Search coming, latest;
    for (int i = 0; i < kTicks; ++i) {
      const runtime::Pose pose = motion.next();
      TickRecord record{};
      // Searches arrive one period late, as those of another thread do.
      if (i % kSearchEvery == 0) {
        latest = i > 0 ? coming : search(view, tool, pose);
        record.search = count([&] { coming = search(view, tool, pose); });
      }
      runtime::Tick tick, of_fewer;
      record.tick = count([&] { tick = full(pose, latest); });
      if (hand == Hand::wandering) {
        record.alone = count([&] { alone.tick(pose); });
        if (fewer != nullptr) record.lean = count([&] { of_fewer = fewer(pose, latest); });
      }
      record.state = static_cast<std::uint32_t>(tick.state);
      const double answer[] = {tick.force.x, tick.force.y, tick.force.z, tick.torque.x, tick.torque.y, tick.torque.z};
      for (int k = 0; k < 3; ++k) {
        record.force[k] = static_cast<float>(answer[k]);
        record.torque[k] = static_cast<float>(answer[3 + k]);
      }
      keep(record, hand);
    }
  }
}

}  // namespace palpate::test
