// SPDX-License-Identifier: MIT
// A contact while it lasts: when it sticks, slides and ends.
#pragma once

#include "palpate/ledger.hpp"
#include "palpate/tick.hpp"

#include <cmath>
#include <utility>

namespace palpate::runtime {

/// One point of a tool on one point of the body, from the first overlap to the last. Of layout::Feature those that
/// kFeatures leaves out take neither code nor memory; the view must not have them.
template <std::uint32_t kFeatures = layout::feature_all>
class BasicHold {
  static constexpr bool kFriction = (kFeatures & layout::feature_friction) != 0;

public:
  BasicHold(const View& view, std::uint32_t tool) : parts_(view, tool), ledger_(view) {}

  [[nodiscard]] bool lasts() const { return lasts_; }
  void end() { lasts_ = false; }
  /// Of a contact that was released: the skin left the body, too.
  [[nodiscard]] bool left() const { return left_; }
  [[nodiscard]] const BasicRest<kFeatures>& rest() const { return parts_.rest(); }

  /// Begins as BasicRest does.
  Tick begin(const ToolTouch& touch, const FirstTouch& first, const Pose& pose) {
    parts_.begin(touch, first, pose);
    ledger_.begin();
    lasts_ = true;
    slides_ = ran_ = false;
    last_ = first.at;
    const Vec3 q = rest().point(pose);
    double depth = rest().deflection(q).depth;
    // What went sideways since the first touch did so on the way down: 2/3 of it are kept where the sideways stiffness
    // grows with the root of the depth, as under a round tip.
    if (const Vec3 way = q - first.at; dot(way, way) > 0) depth *= 4.0 / 9;
    parts_.set_depth(depth);
    if (depth > 0) {
      begins_ = ledger_.rubs();
      const Tick first_tick = tick(pose, q);
      begins_ = false;
      return first_tick;
    }
    last_ = q;
    return begun(pose);
  }

  /// Force of a contact that lasts; `before`: where the pose takes p. `served`: a tracker's latest search, or null.
  Tick tick(const Pose& pose, const Vec3& before, const Search* served = nullptr) {
    BasicRest<kFeatures>& rest = parts_.rest();
    const bool friction = ledger_.rubs();
    bool rolled = friction && rest.probe() > 0 && rest.turned(pose) && rest.roll(pose);
    Vec3 q = before;
    Deflection d;
    DepthTerms terms;
    bool waits = false, ran = false;
    double regained = dot(before - last_, before - last_) > 0 ? rest.relieve(last_, before) : 0;
    if (rest.lies()) {
      rest.let_run(pose, before - last_);
      // Where c goes on it takes up how the tool lies anyway. After a leap it mostly does. Where p runs, too, c and p
      // take turns if there are spins, whose blends are dear.
      waits = (rolled || slides_ || rest.far(before - last_)) && (ran_ || rest.lies_in_place(pose));
      ran = !waits && lie_down(pose, q, d, terms);
    }
    if (!ran) parts_.stand(q, d, terms);
    bool placed = ran_ = ran && rest.spins();
    const Vec3 way = before - last_;
    const double depth = parts_.depth();
    last_ = q;
    if (!(depth > 0 || d.depth > 0 || dot(way, way) > 0)) return begun(pose);
    if (friction && !slides_ && rest.slow(dot(way, way)) && rest.far_aside(q)) let_go_round(length(way), d, terms);
    // Again after each loss of depth, and where c or p went on, both once.
    for (int losses = 0;;) {
      if (!(d.depth > 0)) return release(d);
      ledger_.move(d);
      if (friction) parts_.deepen(way, d, terms);
      if (regained > 0) {
        const double most = 1.25 * terms.normal_force;  // with what a sideways deflection may add
        ledger_.owe(parts_, most * std::exchange(regained, 0), d, terms);
        if (!(d.depth > 0)) return release(d);
      }
      if (ledger_.owed() > 0 && !ledger_.pay(parts_, d, terms)) return release(d);
      if (!kFriction || !friction)
        return slide(pose, d, {{}, terms.straight}, terms, way, depth, terms.straight, served, false);
      const Vec3 core = parts_.core(d, terms);
      const Vec3 pull = parts_.has_rim() ? ledger_.rub_rim(parts_, core, d, terms) : core;
      if (losses < kMostLosses && ledger_.tell(parts_, pull, core, d, terms)) {
        ++losses;
        continue;
      }
      if (length(parts_.friction(core, terms)) > parts_.limit(terms) * (1 + 1e-9)) {
        const Slipped to = parts_.slipped(d, terms, core, begins_ || placed);
        return slide(pose, d, to, terms, way, depth, ledger_.bears(parts_, pull, core, to), served, placed);
      }
      if (rolled && !placed) {
        roll_on(pose, d, terms);
      } else if (!waits || !lie_down(pose, q, d, terms)) {
        parts_.end(d, terms);
        if (field().is_coupled()) parts_.couple(terms, d, pull);
        slides_ = false;
        return output(State::stick, pose, q, terms, pull);
      }
      rolled = waits = false;
      placed = true;
    }
  }

  /// A touching tool that leaps by more than a contact's size between two ticks did not move, it was put
  /// elsewhere: the depth it finds there is no work of the hand and must not push.
  [[nodiscard]] bool jumped(const Vec3& q) const {
    const Vec3 way = q - last_;
    return dot(way, way) > rest().size() * rest().size();
  }

  /// J, in the last tick, and how much of it the hand did not give.
  [[nodiscard]] double stored() const { return parts_.stored(rest().deflection(last_)); }
  [[nodiscard]] double owed() const { return ledger_.owed(); }
  /// J that the account took from this contact, or the last.
  [[nodiscard]] double lost() const { return ledger_.lost(); }

  /// Forces are `ratio` (above 0, infinite where there were none) times what they were in the last tick from now on.
  /// Where depth is lost for it, `tick`, which was the last, becomes what is felt at its pose then, c at rest.
  void rescaled(double ratio, const Pose& pose, Tick& tick) {
    Deflection d;
    DepthTerms terms;
    parts_.stand(last_, d, terms);
    const double before = ledger_.leave(parts_, terms, d) / ratio;
    ledger_.rescale(ratio);
    if (!ledger_.replaced(parts_, before, last_, d, terms)) return;
    tick = d.depth > 0 ? settle(tick.state, pose, less_held(d, terms), d, terms) : begun(pose);
  }

  /// Of a contact that lasts: what the tool did up to here counts as done at `by` times its poses. It is no motion of
  /// the tool against the body, so what is stored more by that is no work of the hand. Where the tool would be off the
  /// body there, as after a leap, the contact keeps its depth: it goes as c follows or the tool lifts.
  void rebase(const Pose& by) {
    Deflection d;
    DepthTerms terms;
    parts_.stand(last_, d, terms);
    const double before = ledger_.leave(parts_, terms, d), depth = d.depth;
    last_ = by.apply(last_);
    ledger_.rotate(by);
    parts_.rebase(by);
    if (Deflection there = rest().deflection(last_); !(there.depth > 0)) {
      parts_.rest().subtract_of(there, there.depth - depth);
    }
    ledger_.replaced(parts_, before, last_, d, terms);
    parts_.set_depth(d.depth);
  }

private:
  [[nodiscard]] const BasicField<kFeatures>& field() const { return parts_.field(); }

  /// Beyond an edge the tool pushes as far as it overlaps the body there, not as deep as it is under the plane of c, to
  /// which friction may hold it for ever. What that is too much is lost as the tool moves, by `moved` (m) in this tick:
  /// no faster than a lift would lose it.
  [[gnu::noinline]] void let_go_round(double moved, Deflection& d, DepthTerms& terms) {
    const double way = std::fmin(rest().past_edge(last_), d.depth - parts_.depth() + moved);
    if (!(way > 0)) return;
    const double before = ledger_.leave(parts_, terms, d);
    parts_.rest().subtract(way);
    ledger_.replaced(parts_, before, last_, d, terms);
  }

  /// Moves c over the surface until the core's sideways deflection is as `wanted`; the rim's anchor stays where it is.
  /// In this tick the tool went `way` (m), from a `depth` (m); `before` is the sideways force (N) where c is. Where c
  /// was `placed` in this tick nothing is blended twice for it: the anchor goes on alone, and all the way.
  Tick slide(const Pose& pose, Deflection d, const Slipped& wanted, DepthTerms& terms, const Vec3& way, double depth,
             const Vec3& before, const Search* served, bool placed) {
    Vec3 pull;
    slides_ = true;
    parts_.let_go();
    parts_.note_slip(Part::core, d.sideways, wanted.deflection);
    // c rests while the tool moves along n(c): 0.1 nm on a contact of 10 mm.
    const bool rests =
        !(length(d.sideways - wanted.deflection) > 1e-8 * rest().size()) && !rest().lies_otherwise_here(pose);
    if (begins_) {
      pull = ledger_.rub(parts_, d, terms, [&] {
        parts_.leave_core(d, wanted.deflection);
        return give_way(wanted.force, d, terms, false);
      });
    } else if (rests) {
      pull = at_rest(parts_.core_force(d, terms), d, terms);
    } else {
      const Vec3 counted = rest().counted(way, last_);
      const auto at_first = ledger_.slides(parts_, wanted, before, counted, d, terms);
      bool went = false;
      if (placed) {
        parts_.leave_core(d, wanted.deflection);
      } else {
        const Vec3 rim = parts_.rim_deflection(d);
        went = parts_.rest().follow(pose, last_, wanted.deflection, terms.normal_force, length(way), d.depth - depth,
                                    served);
        d = rest().deflection(last_);
        if (!(d.depth > 0)) return release(d);
        parts_.leave_rim(d, rim);
        field().set_depth(d.depth, terms);
      }
      pull = give_way(parts_.core_force(d, terms), d, terms, went);
      if (ledger_.slid(parts_, at_first, pull, counted, d, terms)) {
        if (!(d.depth > 0)) return release(d);
        pull = less_held(d, terms);
      }
    }
    return settle(State::slide, pose, pull, d, terms);
  }

  /// The tick ends, sideways with `pull` (N) or what friction holds of it.
  Tick settle(State state, const Pose& pose, Vec3 pull, const Deflection& d, DepthTerms& terms) {
    pull = within_limit(pull, friction_centre(terms), terms.limit);
    parts_.end(d, terms);
    ledger_.keep(parts_, pull, d, terms);
    if (field().is_coupled()) parts_.couple(terms, d, pull);
    return output(state, pose, last_, terms, pull);
  }

  /// N, sideways, after a loss of depth: what friction holds no more gives way in the same tick, for in the next the
  /// hand may rest.
  Vec3 less_held(Deflection& d, const DepthTerms& terms) {
    return ledger_.rub(parts_, d, terms, [&] { return give_way(parts_.core_force(d, terms), d, terms, false); });
  }

  /// Where a new place holds clearly less of the `core` (N) there than friction held at the old one, the rest gives way
  /// without c; where c was held up all of it, for nothing else does: a tick at rest would go on. Returns the sideways
  /// force.
  PALPATE_TICK_INLINE Vec3 give_way(Vec3 core, Deflection& d, const DepthTerms& terms, bool went) {
    if constexpr (kFriction) {
      const double most = parts_.limit(terms) * (went ? 1.001 : 1 + 1e-9);
      for (int turn = 0; turn < parts_.kMostSlips && length(parts_.friction(core, terms)) > most;
           ++turn) {  // once, but after a leap
        const Slipped to = parts_.slipped(d, terms, core, true, went);
        parts_.leave_core(d, to.deflection);
        core = to.force;
      }
    }
    return parts_.has_rim() ? parts_.with_rim(parts_.at_limit(core, terms), d, terms) : core;
  }

  /// N across n(c) of a contact that slides, while c rests.
  Vec3 at_rest(const Vec3& core, const Deflection& d, const DepthTerms& terms) {
    return parts_.has_rim() ? ledger_.rub_rim(parts_, parts_.at_limit(core, terms), d, terms) : core;
  }

  /// Without this the torque on a round skin that turns would do work that is nobody's. A contact that slides needs it
  /// not: its c goes on anyway.
  [[gnu::noinline]] void roll_on(const Pose& pose, Deflection& d, DepthTerms& terms) {
    const double before = ledger_.leave(parts_, terms, d);
    parts_.rest().roll_on(pose, last_, d);
    ledger_.replaced(parts_, before, last_, d, terms);
  }

  /// Moves p, which the pose takes to q, and sets what is there then. False where it stays: q and terms stay, too.
  bool lie_down(const Pose& pose, Vec3& q, Deflection& d, DepthTerms& terms) {
    if (!rest().lies_otherwise(pose)) return false;
    d = rest().deflection(q);
    if (!(d.depth > 0)) return false;
    const double before = ledger_.leave(parts_, field().energy_terms(d.depth), d);
    parts_.rest().lie_down(pose, d);
    q = rest().point(pose);
    ledger_.replaced(parts_, before, q, d, terms);
    return true;
  }

  /// At zero depth there is no force yet, but the contact has begun: from here on the tool may push, when it moves.
  [[nodiscard, gnu::noinline]] Tick begun(const Pose& pose) const {
    return output(ledger_.rubs() ? State::stick : State::slide, pose, last_, field().at_depth(0), {});
  }

  Tick release(const Deflection& d) {
    lasts_ = false;
    left_ = !rest().overlaps(d.depth);
    Tick tick;
    tick.state = State::released;
    return tick;
  }

  [[nodiscard]] Tick output(State state, const Pose& pose, const Vec3& q, const DepthTerms& terms,
                            const Vec3& tangential_force) const {
    const Vec3& n = field().normal();
    const Vec3 force = rest().slope(q) * terms.normal_force * n + tangential_force, tool_point = q - rest().probe() * n;
    return {state,        force,           cross(tool_point - pose.translation, force),
            terms.depth,  terms.limit,     field().covered(),
            terms.beyond, rest().c(),      tool_point,
            rest().at(),  rest().on_tool()};
  }

  static constexpr int kMostLosses = 4;  ///< of depth in a tick, for what the hand got sideways: mostly none

  bool lasts_ = false, left_ = false;
  bool slides_ = false, begins_ = false;
  bool ran_ = false;  ///< p of a tool with spins did, in the last tick
  Vec3 last_;         ///< m, p in the last tick
  BasicParts<kFeatures> parts_;
  BasicLedger<kFeatures> ledger_;
};

}  // namespace palpate::runtime
