// SPDX-License-Identifier: GPL-3.0-or-later
// The ticks of all tools of a response file along a motion that host and microcontroller make alike.
#pragma once

#include <cstdint>

#include "palpate/runtime.hpp"
#include "tests/runtime/wandering.hpp"

namespace palpate::test {

/// What one tick answered, and what it took: as the board writes it.
struct TickRecord {
  std::uint32_t state;
  float force[3], torque[3];  ///< N, N m
  /// Instructions: of the tick, which was given a search; of the search for later ones; of a tick that searches itself;
  /// of the first without the features that the file does not hold (as far as `tick_all` knows such programs).
  std::uint32_t tick, search, alone, lean;
};

template <std::uint32_t kFeatures, class Count, class Keep>
void tick_tools(const runtime::View& view, const Count& count, const Keep& keep) {
  constexpr int kTicks = 1000, kSearchEvery = 20;
  for (std::uint32_t tool = 0; tool < view.meta->tool_count; ++tool) {
    Wandering wandering(tool);
    runtime::Contact contact(view, tool), alone(view, tool);
    runtime::BasicContact<kFeatures> lean(view, tool);
    runtime::Search coming, latest;
    for (int i = 0; i < kTicks; ++i) {
      const runtime::Pose pose = wandering.next();
      TickRecord record{};
      // Searches arrive one period late, as those of another thread do.
      if (i % kSearchEvery == 0) {
        latest = i > 0 ? coming : search(view, tool, pose);
        record.search = count([&] { coming = search(view, tool, pose); });
      }
      runtime::Tick tick;
      record.tick = count([&] { tick = contact.tick(pose, latest); });
      record.alone = count([&] { alone.tick(pose); });
      record.lean = count([&] { lean.tick(pose, latest); });
      record.state = static_cast<std::uint32_t>(tick.state);
      const double answer[] = {tick.force.x, tick.force.y, tick.force.z, tick.torque.x, tick.torque.y, tick.torque.z};
      for (int k = 0; k < 3; ++k) {
        record.force[k] = static_cast<float>(answer[k]);
        record.torque[k] = static_cast<float>(answer[3 + k]);
      }
      keep(record);
    }
  }
}

/// `count(work)` does the work and says how many instructions it took; `keep(record)` is given every tick's.
template <class Count, class Keep>
void tick_all(const runtime::View& view, const Count& count, const Keep& keep) {
  constexpr std::uint32_t kFriction = layout::feature_friction | layout::feature_lateral;
  if (view.features == 0) return tick_tools<0>(view, count, keep);
  if (view.features == kFriction) return tick_tools<kFriction>(view, count, keep);
  tick_tools<layout::feature_all>(view, count, keep);
}

}  // namespace palpate::test
