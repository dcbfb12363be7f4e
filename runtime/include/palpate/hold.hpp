// SPDX-License-Identifier: MIT
// A contact while it lasts: when it sticks, slides and ends, and what it owes.
#pragma once

#include "palpate/energy.hpp"
#include "palpate/rest.hpp"
#include "palpate/slip.hpp"
#include "palpate/tick.hpp"

#include <cmath>

namespace palpate::runtime {

/// One point of a tool on one point of the body, from the first overlap to the last. Of layout::Feature those that
/// kFeatures leaves out take neither code nor memory; the view must not have them.
template <std::uint32_t kFeatures = layout::feature_all>
class BasicHold {
  static constexpr bool kFriction = (kFeatures & layout::feature_friction) != 0;

public:
  BasicHold(const View& view, std::uint32_t tool) : view_(&view), rest_(view, tool) {}

  [[nodiscard]] bool lasts() const { return lasts_; }
  void end() { lasts_ = false; }
  /// Of a contact that was released: the skin left the body, too.
  [[nodiscard]] bool left() const { return left_; }
  [[nodiscard]] const BasicRest<kFeatures>& rest() const { return rest_; }

  /// Begins as BasicRest does.
  Tick begin(const ToolTouch& touch, const Projection& found, double most, const Pose& pose) {
    rest_.begin(touch, found, most, pose);
    account_.reset();
    lasts_ = true;
    last_ = rest_.point(pose);
    depth_ = rest_.deflection(last_).depth;
    // At zero depth there is no force yet, but the contact has begun: from here on the tool may push.
    return depth_ > 0 ? tick(pose, last_) : output(State::stick, pose, last_, field().at_depth(depth_), {});
  }

  /// Force of a contact that lasts; `before`: where the pose takes p.
  Tick tick(const Pose& pose, const Vec3& before) {
    const bool friction = kFriction && view_->has(layout::feature_friction);
    bool rolled = friction && rest_.probe() > 0 && rest_.turned(pose) && rest_.roll(pose);
    const Vec3 q = rest_.profile() ? lie_down(pose, before) : before;
    const Vec3 way = q - last_;
    last_ = q;
    for (;; rolled = false) {
      Deflection d = rest_.deflection(q);
      if (!(d.depth > 0)) return release(d);
      DepthTerms terms = field().at_depth(d.depth);
      if (friction) deepen(d, terms);
      if (account_.owed() > 0 && !pay(d, terms)) return release(d);
      if (!kFriction || !friction) return slide(pose, d, {}, terms, 0);
      const Vec3 pull = terms.straight + field().sideways(terms, d.sideways);
      if (length(pull) > terms.limit * (1 + 1e-9)) {
        return slide(pose, d, slipped(d, terms, pull), terms, -dot(pull, way));
      }
      if (!rolled) {
        field().couple(terms, d.sideways);
        return output(State::stick, pose, q, terms, pull);
      }
      roll_on(pose, d, terms);
    }
  }

  /// A touching tool that leaps by more than a contact's size between two ticks did not move, it was put
  /// elsewhere: the depth it finds there is no work of the hand and must not push.
  [[nodiscard]] bool jumped(const Vec3& q) const {
    const Vec3 way = q - last_;
    return dot(way, way) > rest_.size() * rest_.size();
  }

  /// J, in the last tick, and how much of it the hand did not give.
  [[nodiscard]] double stored() const { return stored(rest_.deflection(last_)); }
  [[nodiscard]] double owed() const { return account_.owed(); }

  /// Forces are `ratio` (above 0, infinite where there were none) times what they were in the last tick from now on.
  void rescaled(double ratio) {
    account_.rescale(ratio);
    replaced(stored() / ratio, last_);
  }

private:
  [[nodiscard]] const BasicField<kFeatures>& field() const { return rest_.field(); }

  /// N across n(c), that of the straight push included. Out of line, for only ticks that slide ask for it: one that
  /// sticks has its own.
  [[nodiscard, gnu::noinline]] Vec3 sideways_force(const Deflection& d, const DepthTerms& terms) const {
    return terms.straight + field().sideways(terms, d.sideways);
  }

  /// The sideways deflection (m) at which friction holds, where `pull` (N) is more than it does.
  [[nodiscard]] Vec3 slipped(const Deflection& d, const DepthTerms& terms, const Vec3& pull) const {
    return slip(field(), terms, view_->meta->sideways_scale, d.sideways, pull);
  }

  /// J in the present field.
  [[nodiscard]] double stored(const Deflection& d) const {
    return field().stored(field().at_depth(d.depth), d.sideways);
  }

  /// The anchor rule: sideways motion has been added to the effective deflection; going deeper moves its anchor.
  void deepen(Deflection& d, const DepthTerms& terms) {
    if (d.depth > depth_ || !(depth_ > 0)) rest_.leave(d, field().deepened(depth_, terms, d.sideways));
    depth_ = d.depth;
    field().remember(terms);
  }

  /// What a lift loses of what is owed. False where no depth is left.
  [[gnu::noinline]] bool pay(Deflection& d, DepthTerms& terms) {
    const double left = field().stored(terms, d.sideways);
    lose(account_.due(left), left, d, terms);
    return d.depth > 0;
  }

  /// Gives up `due` of the `stored` energy (J) by as much depth.
  void lose(double due, double stored, Deflection& d, DepthTerms& terms) {
    double left = stored;
    if (due > 0) {
      const double way = std::fmin(d.depth, due / terms.normal_force);
      rest_.subtract(way);
      depth_ = d.depth -= way;
      terms = field().at_depth(d.depth);
      left = field().stored(terms, d.sideways);
    }
    account_.paid(stored - left, left);
  }

  /// After c or p went elsewhere while the tool stood still: `held` (J) was stored before, and `rubbed` (J) is what the
  /// hand did against the sideways force. True where depth was lost.
  bool replaced(double held, double rubbed, Deflection& d, DepthTerms& terms) {
    const double stored = field().stored(terms, d.sideways);
    const bool friction = view_->has(layout::feature_friction), coupled = view_->coupled_laws != nullptr;
    // A coupled response stores what was rubbed until c gives way.
    const double due = account_.replaced(held, stored, friction, coupled ? 0 : rubbed);
    if (due > 0) lose(due, stored, d, terms);
    return due > 0;
  }
  /// The same for the tool at q, with nothing rubbed.
  void replaced(double held, const Vec3& q) {
    Deflection d = rest_.deflection(q);
    DepthTerms terms = field().at_depth(d.depth);
    replaced(held, 0, d, terms);
  }

  /// Moves c over the surface until the sideways deflection is `wanted`; in this tick the hand did the work `rubbed`
  /// (J) against the sideways force.
  Tick slide(const Pose& pose, Deflection d, const Vec3& wanted, DepthTerms& terms, double rubbed) {
    Vec3 pull;
    // c rests while the tool moves along n(c): 0.1 nm on a contact of 10 mm.
    if (length(d.sideways - wanted) > 1e-8 * rest_.size()) {
      const double held = field().stored(terms, d.sideways);
      rest_.follow(pose, last_, wanted, terms.normal_force);
      d = rest_.deflection(last_);
      if (!(d.depth > 0)) return release(d);
      terms = field().at_depth(d.depth);
      pull = give_way(d, terms);
      if (replaced(held, rubbed, d, terms)) {
        if (!(d.depth > 0)) return release(d);
        pull = sideways_force(d, terms);
      }
    } else {
      pull = sideways_force(d, terms);
    }
    const double size = length(pull);
    if (size > terms.limit) pull = (terms.limit / size) * pull;
    depth_ = d.depth;
    field().remember(terms);
    field().couple(terms, d.sideways);
    return output(State::slide, pose, last_, terms, pull);
  }

  /// Where a new place holds clearly less than friction held at the old one, the rest gives way without c. Returns the
  /// sideways force.
  Vec3 give_way(Deflection& d, const DepthTerms& terms) {
    const Vec3 pull = sideways_force(d, terms);
    if constexpr (kFriction) {
      if (length(pull) > terms.limit * 1.001) {
        rest_.leave(d, slipped(d, terms, pull));
        return sideways_force(d, terms);
      }
    }
    return pull;
  }

  /// Without this the torque on a round skin that turns would do work that is nobody's. A contact that slides needs it
  /// not: its c goes on anyway.
  [[gnu::noinline]] void roll_on(const Pose& pose, const Deflection& d, const DepthTerms& terms) {
    const double held = field().stored(terms, d.sideways);
    rest_.roll_on(pose, last_, d);
    replaced(held, last_);
  }

  /// Returns where the pose takes p then.
  Vec3 lie_down(const Pose& pose, const Vec3& before) {
    if (!rest_.lies_otherwise(pose)) return before;
    const Deflection d = rest_.deflection(before);
    if (!(d.depth > 0)) return before;
    const double held = stored(d);
    rest_.lie_down(pose, d);
    const Vec3 q = rest_.point(pose);
    replaced(held, q);
    return q;
  }

  Tick release(const Deflection& d) {
    lasts_ = false;
    left_ = !rest_.overlaps(d.depth);
    Tick tick;
    tick.state = State::released;
    return tick;
  }

  [[nodiscard]] Tick output(State state, const Pose& pose, const Vec3& q, const DepthTerms& terms,
                            const Vec3& tangential_force) const {
    const Vec3& n = field().normal();
    const Vec3 force = terms.normal_force * n + tangential_force, tool_point = q - rest_.probe() * n;
    return {state,        force,          cross(tool_point - pose.translation, force),
            terms.depth,  terms.limit,    field().covered(),
            terms.beyond, rest_.c(),      tool_point,
            rest_.at(),   rest_.on_tool()};
  }

  const View* view_;
  bool lasts_ = false, left_ = false;
  Vec3 last_;         ///< m, p in the last tick
  double depth_ = 0;  ///< m, of the last tick
  EnergyAccount account_;
  BasicRest<kFeatures> rest_;
};

}  // namespace palpate::runtime
