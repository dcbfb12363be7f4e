// SPDX-License-Identifier: GPL-3.0-or-later
// A ball drawn slowly over a body at a constant overlap of its skin, and what its contact did on the way.
#pragma once

#include <algorithm>
#include <cmath>

#include "palpate/several.hpp"
#include "tests/runtime/battery.hpp"
#include "tests/runtime/support.hpp"

namespace palpate::test {

/// One tick of either kind of loop: what all of its contacts do.
struct Felt {
  bool touching = false;
  Vec3 force;
  std::vector<Vec3> c;  ///< m, of each contact
  double reach = 0;     ///< m, from the skin to the farthest c
};
inline Felt felt(const Tick& t) {
  if (t.state != State::stick && t.state != State::slide) return {};
  return {true, t.force, {t.body_point}, distance(t.tool_point, t.body_point)};
}
template <int Most>
Felt felt(const runtime::SeveralTick<Most>& t) {
  Felt all{t.touching > 0, t.force, {}};
  for (const Tick& each : t.each) {
    const Felt one = felt(each);
    if (!one.touching) continue;
    all.c.push_back(each.body_point);
    all.reach = std::max(all.reach, one.reach);
  }
  return all;
}

/// Where a ball's middle is while its skin overlaps the body by `overlap` (m): of a line in x and y, the highest such
/// place. Points so near that straight lines between them will do.
inline std::vector<Vec3> over(const runtime::View& view, const Vec3& from, const Vec3& to, double overlap) {
  std::vector<Vec3> way;
  constexpr double kNode = 2e-4;
  const int nodes = 1 + static_cast<int>(length(to - from) / kNode);
  for (int i = 0; i <= nodes; ++i) {
    Vec3 q = from + (static_cast<double>(i) / nodes) * (to - from);
    const auto distance_at = [&](double z) {
      q.z = z;
      return runtime::locate(view, q).signed_distance - (kTipRadius - overlap);
    };
    // Down by what is known to be free: never through a ridge.
    double z = 0.1;
    for (int k = 0; k < 200; ++k) {
      const double gap = distance_at(z);
      if (gap < 1e-8) break;
      z -= gap;
    }
    way.push_back({q.x, q.y, z});
  }
  return way;
}

struct DrawReport {
  double way = 0;        ///< m, of the tool while it touched
  double jump = 0;       ///< largest way of a contact point in a tick over that of the tool
  int hand_overs = 0;    ///< ticks in which one went farther than twenty times that
  double step = 0;       ///< largest change of the force over stiffness times the tool's way
  double lost = 0;       ///< largest overlap without a contact, after the first touch, over the depth scale
  double held = 0;       ///< largest clearance with a contact, the same
  double trapped = 0;    ///< way straight up from where its skin is clear until it is free, over that from skin to c
  double weakest = 1e9;  ///< least force while the overlap was all there, N
  Vec3 at_jump, at_step, at_lost, at_held;  ///< m, where the tool was
  std::size_t most = 0;                     ///< contacts at once
};

/// Draws along `way` (m), there and back, from above its first point and up from it again, `stride` (m) a tick.
template <class Loop>
DrawReport draw(const runtime::View& view, const std::vector<Vec3>& way, double overlap, Loop loop,
                double stride = 5e-6) {
  DrawReport r;
  const double k = stiffest(view, 0), scale = view.meta->depth_scale;
  std::vector<Vec3> all{way.front() + Vec3{0, 0, overlap + 1e-3}};
  all.insert(all.end(), way.begin(), way.end());
  all.insert(all.end(), way.rbegin() + 1, way.rend());
  all.push_back(all.front());
  Vec3 at = all.front();
  Felt last = felt(loop.tick(upright(at)));
  long count = 0;
  const auto clearance = [&](const Vec3& q) { return runtime::locate(view, q).signed_distance - kTipRadius; };
  for (std::size_t leg = 1; leg < all.size(); ++leg) {
    const int steps = 1 + static_cast<int>(length(all[leg] - at) / stride);
    const Vec3 step = (1.0 / steps) * (all[leg] - at);
    const double size = length(step);
    if (!(size > 0)) continue;
    for (int i = 0; i < steps; ++i, ++count) {
      at = at + step;
      const Felt now = felt(loop.tick(upright(at)));
      if (const double s = distance(now.force, last.force) / (k * size); s > r.step) r.step = s, r.at_step = at;
      for (std::size_t n = 0; now.c.size() <= last.c.size() && n < now.c.size(); ++n) {  // else one has just begun
        const Vec3& c = now.c[n];
        double jump = 1e9;
        for (const Vec3& before : last.c) jump = std::min(jump, distance(c, before) / size);
        if (jump > 1e8) continue;
        if (jump > r.jump) r.jump = jump, r.at_jump = at;
        r.hand_overs += jump > 20;
      }
      if (now.touching) r.way += size;
      r.most = std::max(r.most, now.c.size());
      if (leg > 1 && leg + 1 < all.size()) r.weakest = std::min(r.weakest, length(now.force));
      if (count % 5 == 0) {
        const double clear = clearance(at) / scale;
        if (leg > 1 && leg + 1 < all.size() && !now.touching && -clear > r.lost) r.lost = -clear, r.at_lost = at;
        if (now.touching && clear > r.held) r.held = clear, r.at_held = at;
      }
      if (now.touching && leg > 1 && count % 400 == 0) {
        // Straight out: up, for nothing hangs over.
        Loop copy = loop;
        double gone = 0, clear = 0;
        for (bool touches = true; touches && gone < 20 * scale; gone += 4 * stride) {
          const Vec3 q = at + Vec3{0, 0, gone};
          touches = felt(copy.tick(upright(q))).touching;
          if (clearance(q) < 0) clear = gone;
        }
        r.trapped = std::max(r.trapped, (gone - clear) / std::max(now.reach, 0.01 * scale));
      }
      last = now;
    }
  }
  return r;
}

}  // namespace palpate::test
