// SPDX-License-Identifier: GPL-3.0-or-later
// A contact that is grasped: bonded where it stands at the grasp depth, pulled out, pushed in, drawn aside, turned.
#include "precompute/solve/pair/bonded.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>

namespace palpate::solve {
namespace {

using Eigen::Vector3d;
using Stand = Bonded::Stand;

constexpr std::size_t kFewest = 3;  // depths of a grasp: fewer are no curve

double largest(const std::vector<double>& depths) {
  double size = 0;
  for (const double depth : depths) size = std::max(size, std::abs(depth));
  return size;
}

class Grasp {
public:
  explicit Grasp(PairRun& run)
      : run_(run),
        path_(run.path),
        at_(run.point_from(run.path.grasp_depth)),
        bonded_(run, at_, largest(run.path.grasp_depths)) {}

  bool solve() {
    std::vector<Stand> stands{bonded_.start()};
    std::string cause = along(stands, std::greater<>());
    if (cause.empty()) cause = along(stands, std::less<>());
    // A grasp that fails at a large pull is a result, not a fault that a finer mesh mends.
    if (stands.size() < kFewest) {
      return run_.refuse_contact(cause.empty() ? "grasp: fewer than three depths are in its path" : cause);
    }
    if (!cause.empty()) run_.result.outcome.cause = "stopped short: " + cause;
    for (const Stand& s : stands) add(s.sample);
    return tangential_moves(stands) && turns(stands);
  }

private:
  // Along the normal, from the grasp through those of the depths that are less deep (or deeper, by `before`), the
  // nearest first. Why not to the last; else empty.
  template <class Before>
  std::string along(std::vector<Stand>& stands, const Before& before) {
    const double here = at_.depth, slack = 1e-9 * here;
    std::vector<double> depths;
    std::copy_if(path_.grasp_depths.begin(), path_.grasp_depths.end(), std::back_inserter(depths),
                 [&](double depth) { return before(here, depth) && std::abs(depth - here) > slack; });
    std::sort(depths.begin(), depths.end(), before);
    Stand now = bonded_.start();
    bonded_.restore(now);
    for (const double depth : depths) {
      if (const auto failed = bonded_.move(now, run_.start - depth * run_.frame.n)) {
        return *failed + " in the grasp at depth " + std::to_string(1e3 * depth) + " mm";
      }
      stands.push_back(now);
    }
    return {};
  }

  void add(Sample sample) {
    sample.index = index_++;
    run_.result.samples.push_back(sample);
  }

  // From where it is deepest, from where the tool first touched and from the furthest pull, or what is nearest.
  [[nodiscard]] std::vector<const Stand*> bases(const std::vector<Stand>& stands) const {
    const auto [out, in] = std::minmax_element(path_.grasp_depths.begin(), path_.grasp_depths.end());
    std::vector<const Stand*> from;
    for (const double wanted : {*in, 0.0, *out}) {
      const auto nearest = std::min_element(stands.begin(), stands.end(), [&](const Stand& a, const Stand& b) {
        return std::abs(a.sample.deflection.z() - wanted) < std::abs(b.sample.deflection.z() - wanted);
      });
      if (std::find(from.begin(), from.end(), &*nearest) == from.end()) from.push_back(&*nearest);
    }
    return from;
  }

  bool tangential_moves(const std::vector<Stand>& stands) {
    std::string cause;
    std::size_t taken = 0;
    for (const Stand* s : bases(stands)) {
      for (int d = 0; d < path_.grasp_directions; ++d) {
        const Vector3d way = run_.frame.to_world(run_.direction(d, path_.grasp_directions));
        Stand now = *s;
        bonded_.restore(now);
        for (int k = 1; k <= path_.grasp_points; ++k) {
          const double reach = path_.grasp_reach * k / path_.grasp_points;
          if (const auto failed = bonded_.move(now, s->state.translation + reach * way)) {
            cause = *failed + " in the grasp drawn " + std::to_string(1e3 * reach) + " mm aside at depth " +
                    std::to_string(1e3 * s->sample.deflection.z()) + " mm";
            break;
          }
          add(now.sample);
          ++taken;
        }
      }
    }
    if (path_.grasp_directions > 0 && taken == 0) return run_.refuse_contact(cause);
    if (!cause.empty()) run_.result.outcome.cause = "stopped short: " + cause;
    return true;
  }

  // Twist about the normal, rolling about the tangents.
  bool turns(const std::vector<Stand>& stands) {
    std::string cause;
    std::size_t taken = 0;
    for (const Stand* s : bases(stands)) {
      for (const Vector3d& turn : path_.grasp_turns) {
        Stand now = *s;
        bonded_.restore(now);
        if (const auto failed = bonded_.turn(now, *s, turn)) {
          cause = *failed + " in the grasp turned by " + std::to_string(turn.norm()) + " rad at depth " +
                  std::to_string(1e3 * s->sample.deflection.z()) + " mm";
          continue;
        }
        add(now.sample);
        ++taken;
      }
    }
    bonded_.restore(bonded_.start());
    if (!path_.grasp_turns.empty() && taken == 0) return run_.refuse_contact(cause);
    if (!cause.empty()) run_.result.outcome.cause = "stopped short: " + cause;
    return true;
  }

  PairRun& run_;
  const PairPath& path_;
  const CurvePoint& at_;
  Bonded bonded_;
  std::uint16_t index_ = 0;
};

}  // namespace

bool grasped_pulls(PairRun& run) {
  if (!(run.path.grasp_depth > 0)) return true;
  if (run.options.method != ContactMethod::penalty) return run.refuse("grasp: bonds are solved with a penalty alone");
  return Grasp(run).solve();
}

}  // namespace palpate::solve
