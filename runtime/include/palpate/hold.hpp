// SPDX-License-Identifier: MIT
// A contact while it lasts: when it sticks, slides and ends, and what it owes.
#pragma once

#include "palpate/energy.hpp"
#include "palpate/inner.hpp"
#include "palpate/rest.hpp"
#include "palpate/rim.hpp"
#include "palpate/slip.hpp"
#include "palpate/strain.hpp"
#include "palpate/tick.hpp"

#include <cmath>

namespace palpate::runtime {

/// One point of a tool on one point of the body, from the first overlap to the last. Of layout::Feature those that
/// kFeatures leaves out take neither code nor memory; the view must not have them.
template <std::uint32_t kFeatures = layout::feature_all>
class BasicHold {
  static constexpr bool kFriction = (kFeatures & layout::feature_friction) != 0;

public:
  BasicHold(const View& view, std::uint32_t tool) : view_(&view), rest_(view, tool), rim_(view) {
    if constexpr (kFriction) {
      rubs_ = view.has(layout::feature_friction);
      tallies_ = rubs_ && !view.coupled;
    }
  }

  [[nodiscard]] bool lasts() const { return lasts_; }
  void end() { lasts_ = false; }
  /// Of a contact that was released: the skin left the body, too.
  [[nodiscard]] bool left() const { return left_; }
  [[nodiscard]] const BasicRest<kFeatures>& rest() const { return rest_; }

  /// Begins as BasicRest does.
  Tick begin(const ToolTouch& touch, const FirstTouch& first, const Pose& pose) {
    rest_.begin(touch, first, pose);
    rim_.leave({}, {});
    account_.reset();
    if constexpr (kFriction) tally_.reset();
    let_go();
    lasts_ = true;
    slides_ = false;
    last_ = first.at;
    const Vec3 q = rest_.point(pose);
    depth_ = rest_.deflection(q).depth;
    // What went sideways since the first touch did so on the way down: 2/3 of it are kept where the sideways stiffness
    // grows with the root of the depth, as under a round tip.
    if (const Vec3 way = q - first.at; dot(way, way) > 0) depth_ *= 4.0 / 9;
    if (depth_ > 0) {
      begins_ = rubs();
      const Tick first_tick = tick(pose, q);
      begins_ = false;
      return first_tick;
    }
    // At zero depth there is no force yet, but the contact has begun: from here on the tool may push.
    last_ = q;
    return output(State::stick, pose, q, field().at_depth(0), {});
  }

  /// Force of a contact that lasts; `before`: where the pose takes p. `served`: a tracker's latest search, or null.
  Tick tick(const Pose& pose, const Vec3& before, const Search* served = nullptr) {
    const bool friction = rubs();
    bool rolled = friction && rest_.probe() > 0 && rest_.turned(pose) && rest_.roll(pose);
    Vec3 q = before;
    Deflection d;
    DepthTerms terms;
    bool waits = false;
    if (rest_.lies()) {
      rest_.let_run(pose, before - last_);
      // Where c goes on it takes up how the tool lies anyway. After a leap it mostly does.
      waits = (rolled || slides_ || rest_.far(before - last_)) && rest_.lies_in_place(pose);
    }
    if (waits || !rest_.lies() || !lie_down(pose, q, d, terms)) stand(q, d, terms);
    const Vec3 way = q - last_;
    const double depth = depth_;
    last_ = q;
    if (friction && !slides_ && rest_.slow(dot(way, way)) && rest_.far_aside(q)) let_go_round(length(way), d, terms);
    for (;;) {
      if (!(d.depth > 0)) return release(d);
      if constexpr (kFriction) {
        if (tallies()) tally_.move(d.sideways);
      }
      if (friction) deepen(way, d, terms);
      if (account_.owed() > 0 && !pay(d, terms)) return release(d);
      if (!kFriction || !friction)
        return slide(pose, d, {{}, terms.straight}, terms, way, depth, terms.straight, served);
      const Vec3 core = straight_of_core(terms) + field().sideways(terms, d.sideways);
      const Vec3 pull = rim_.present() ? with_rim_alone(core, d, terms) : core;
      if (tallies() && tell(pull, core, d, terms)) continue;
      if (length(core) > rim_.core_limit() * terms.limit * (1 + 1e-9)) {
        return slide(pose, d, slipped(d, terms, core, begins_), terms, way, depth, pull, served);
      }
      if (rolled) {
        roll_on(pose, d, terms);
      } else if (!waits || !lie_down(pose, q, d, terms)) {
        if (field().is_coupled()) couple(terms, d, core);
        slides_ = false;
        return output(State::stick, pose, q, terms, pull);
      }
      rolled = waits = false;
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
  /// J that the account took from this contact, or the last.
  [[nodiscard]] double lost() const { return account_.lost(); }

  /// Forces are `ratio` (above 0, infinite where there were none) times what they were in the last tick from now on.
  void rescaled(double ratio) {
    account_.rescale(ratio);
    Deflection d;
    DepthTerms terms;
    stand(last_, d, terms);
    const double before = leave(terms, d) / ratio;
    if constexpr (kFriction) tally_.rescale(ratio);
    replaced(before, last_, d, terms);
  }

  /// Of a contact that lasts: what the tool did up to here counts as done at `by` times its poses. It is no motion of the
  /// tool against the body, so what is stored more by that is no work of the hand.
  void rebase(const Pose& by) {
    Deflection d;
    DepthTerms terms;
    stand(last_, d, terms);
    const double before = leave(terms, d);
    last_ = by.apply(last_);
    if constexpr (kFriction) {
      tally_.rotate(by);
      inner_.core.rotate(by);
      inner_.rim.rotate(by);
    }
    rest_.rebase(by);
    replaced(before, last_, d, terms);
    depth_ = d.depth;
  }

private:
  [[nodiscard]] const BasicField<kFeatures>& field() const { return rest_.field(); }

  [[nodiscard]] Vec3 straight_of_core(const DepthTerms& terms) const {
    return rim_.present() ? rim_.core_limit() * terms.straight : terms.straight;
  }
  /// N of the core across n(c), its part of the straight push included. Out of line, for only ticks that slide ask for
  /// it: one that sticks has its own.
  [[nodiscard, gnu::noinline]] Vec3 core_force(const Deflection& d, const DepthTerms& terms) const {
    return straight_of_core(terms) + field().sideways(terms, d.sideways);
  }
  /// N of core and rim, of which `core` is known. The rim gives way first.
  [[nodiscard, gnu::noinline]] Vec3 with_rim(const Vec3& core, const Deflection& d, const DepthTerms& terms) {
    const Slips rim = slips(Part::rim, terms);
    Vec3 e = d.sideways, pull = core - (rim_.core_limit() - rim_.limit()) * terms.straight;
    if (rim_.apart()) {
      e = rim_deflection(d);
      pull = rim.straight + field().sideways(terms, e, Part::rim);
    }
    if (length(pull) > rim.limit) {
      // Once, but after a leap: where the force across its line is more than friction holds, it goes on that way.
      for (int turn = 0; turn < kMostSlips && length(pull) > rim.limit; ++turn) {
        const Slipped to = slip(field(), terms, rim, e, pull);
        e = to.holds ? to.deflection : d.sideways;
        pull = to.holds ? to.force : rim.straight + field().sideways(terms, e, Part::rim);
      }
      rim_.leave(d.sideways, e);
    }
    return rim_.mean(core, pull);
  }

  /// The same, where what the rim loses is told to nobody else.
  [[nodiscard]] Vec3 with_rim_alone(const Vec3& core, const Deflection& d, const DepthTerms& terms) {
    return rub(d, terms, [&] { return with_rim(core, d, terms); });
  }

  /// Has `slip` take of what is stored, where the tool is: it is no lift.
  template <class Slip>
  PALPATE_TICK_INLINE Vec3 rub(const Deflection& d, const DepthTerms& terms, const Slip& slip) {
    const bool owes = account_.owed() > 0;
    const double held = owes ? stored(terms, d) : 0;
    const Vec3 pull = slip();
    if (owes) account_.replaced(held, stored(terms, d), true, 0);
    return pull;
  }

  /// The core's of a contact that slides: it comes to rest at its limit, or so near above that it is taken for that.
  [[nodiscard]] Vec3 at_limit(const Vec3& core, const DepthTerms& terms) const {
    const double most = rim_.core_limit() * terms.limit, size = length(core);
    return size > most ? (most / size) * core : core;
  }

  /// What holds as much of the contact's friction limit bears as much of a straight push.
  [[nodiscard]] Slips slips(Part part, const DepthTerms& terms) const {
    const double limit = part == Part::rim ? rim_.limit() : rim_.core_limit();
    return {part, limit * terms.straight, limit * terms.limit, view_->meta->sideways_scale, part == Part::rim};
  }
  [[nodiscard]] Vec3 rim_deflection(const Deflection& d) const { return rim_.deflection(d.sideways, field().normal()); }

  /// Moves the core's anchor so that this much of its sideways deflection is left; the rim's stays where it is.
  void leave_core(Deflection& d, const Vec3& kept) {
    const Vec3 rim = rim_deflection(d);
    rest_.leave(d, kept);
    rim_.leave(d.sideways, rim);
  }

  /// The core's sideways deflection at which friction holds, where its `pull` (N) is more than it does.
  [[nodiscard]] Slipped slipped(const Deflection& d, const DepthTerms& terms, const Vec3& pull, bool at_once) const {
    Slips what = slips(Part::core, terms);
    what.at_once = at_once;
    return slip(field(), terms, what, d.sideways, pull);
  }

  /// Adds what the sideways deflections do to the normal force; `core` is core_force().
  void couple(DepthTerms& terms, const Deflection& d, const Vec3& core) const {
    if (!rim_.present()) return field().couple(terms, d.sideways, core);
    const Vec3 e = rim_deflection(d), rim = rim_.limit() * terms.straight + field().sideways(terms, e);
    field().couple(terms, d.sideways, core, 1 - rim_.share(), rim_.core_limit());
    field().couple(terms, e, rim, rim_.share(), rim_.limit());
  }

  /// J in the present field.
  [[nodiscard]] double stored(const Deflection& d) const { return stored(field().energy_terms(d.depth), d); }
  [[nodiscard]] PALPATE_TICK_INLINE double stored(const DepthTerms& terms, const Deflection& d) const {
    const double core = field().stored(terms, d.sideways, rim_.core_limit());
    return rim_.present() ? rim_.mean(core, field().stored(terms, rim_deflection(d), rim_.limit())) : core;
  }

  /// The anchor rule: sideways motion has been added to the effective deflection; going deeper moves its anchor, and
  /// lifting what was pushed down after a lift moves it back.
  void deepen(const Vec3& way, Deflection& d, const DepthTerms& terms) {
    if constexpr (kFriction) {
      // A hand that trembles is slow.
      if (inner_.core.known() && !rest_.slow(dot(way, way))) let_go();
      if (d.depth > depth_ || !(depth_ > 0)) {
        if (inner_.lifts) turn(d);
        const Vec3 core = deeper(inner_.core, d.sideways, terms, rim_.core_limit());
        if (rim_.present()) rim_.leave(core, deeper(inner_.rim, rim_deflection(d), terms, rim_.limit()));
        rest_.leave(d, core);
      } else if (d.depth < depth_) {
        inner_.lifts = true;
        if (inner_.core.known()) lift(d, terms);
      }
    }
    depth_ = d.depth;
    field().remember(terms);
  }
  /// What a part of the contact keeps of a deflection (m).
  PALPATE_TICK_INLINE Vec3 deeper(InnerPart& part, const Vec3& deflection, const DepthTerms& terms, double lean) {
    const Vec3 kept = field().deepened(depth_, terms, deflection, lean);
    if (part.known()) part.deepened(field(), depth_, deflection, terms, kept, lean);
    return kept;
  }
  [[gnu::noinline]] void lift(Deflection& d, const DepthTerms& terms) {
    const Vec3 core = inner_.core.lifted(field(), depth_, terms, d.sideways, rim_.core_limit());
    if (rim_.present()) {
      rim_.leave(core, inner_.rim.lifted(field(), depth_, terms, rim_deflection(d), rim_.limit()));
    }
    rest_.leave(d, core);
  }
  /// A lift ends. What is hardly deflected bears nothing that could be lost.
  void turn(const Deflection& d) {
    const double least = 1e-5 * rest_.size();
    if (!(dot(d.sideways, d.sideways) > least * least)) return let_go();
    inner_.lifts = false;
    inner_.core.turn();
    inner_.rim.turn();
  }
  /// What slides bears no more than its limit anywhere.
  void let_go() {
    if constexpr (kFriction) {
      inner_.lifts = false;
      inner_.core.forget();
      inner_.rim.forget();
    }
  }

  /// Beyond an edge the tool pushes as far as it overlaps the body there, not as deep as it is under the plane of c, to
  /// which friction may hold it for ever. What that is too much is lost as the tool moves, by `moved` (m) in this tick:
  /// no faster than a lift would lose it.
  [[gnu::noinline]] void let_go_round(double moved, Deflection& d, DepthTerms& terms) {
    const double way = std::fmin(rest_.past_edge(last_), d.depth - depth_ + moved);
    if (!(way > 0)) return;
    const double before = leave(terms, d);
    rest_.subtract(way);
    replaced(before, last_, d, terms);
  }

  /// What a lift loses of what is owed. False where no depth is left.
  [[gnu::noinline]] bool pay(Deflection& d, DepthTerms& terms) {
    const double held = stored(terms, d), due = account_.due(held), left = due > 0 ? lose(due, d, terms) : held;
    account_.paid(held - left, left);
    return d.depth > 0;
  }

  /// Gives up `due` (J) of what is stored by as much depth; returns what is left.
  double lose(double due, Deflection& d, DepthTerms& terms) {
    const double way = std::fmin(d.depth, due / terms.normal_force), leant = tallies() ? lean(terms, d) : 0;
    rest_.subtract(way);
    depth_ = d.depth -= way;
    field().set_depth(d.depth, terms);
    if constexpr (kFriction) {
      if (tallies()) tally_.shift({}, lean(terms, d) - leant);
    }
    return stored(terms, d);
  }

  /// After c or p went elsewhere while the tool stood still: `held` (J) was stored before, and `rubbed` (J) is what
  /// friction took of what is stored sideways and not counted in that. True where depth was lost.
  PALPATE_TICK_INLINE bool replaced(double held, double rubbed, Deflection& d, DepthTerms& terms) {
    const double now = stored(terms, d);
    const double due = account_.replaced(held, now, rubs(), rubbed);
    if (due > 0) account_.held_back(now - lose(due, d, terms));
    return due > 0;
  }

  /// J that is stored before c or p goes elsewhere; replaced() is to follow.
  [[nodiscard]] double leave(const DepthTerms& terms, const Deflection& d) {
    if constexpr (kFriction) {
      if (tallies()) tally_.shift(-d.sideways, -lean(terms, d));
    }
    return stored(terms, d);
  }
  /// The same for the tool at q, with nothing rubbed; sets what is there now.
  PALPATE_TICK_INLINE void replaced(double left, const Vec3& q, Deflection& d, DepthTerms& terms) {
    stand(q, d, terms);
    if constexpr (kFriction) {
      if (tallies()) tally_.shift(d.sideways, lean(terms, d));
    }
    replaced(left, 0, d, terms);
  }

  /// Deflection of the tool at q, and its terms.
  void stand(const Vec3& q, Deflection& d, DepthTerms& terms) const {
    d = rest_.deflection(q);
    field().set_depth(d.depth, terms);
  }

  /// Moves c over the surface until the core's sideways deflection is as `wanted`; the rim's anchor stays where it is.
  /// In this tick the tool went `way` (m), from a `depth` (m); `before` is the sideways force (N) where c is.
  Tick slide(const Pose& pose, Deflection d, const Slipped& wanted, DepthTerms& terms, const Vec3& way, double depth,
             const Vec3& before, const Search* served) {
    Vec3 pull;
    slides_ = true;
    let_go();
    // c rests while the tool moves along n(c): 0.1 nm on a contact of 10 mm.
    const bool rests = !(length(d.sideways - wanted.deflection) > 1e-8 * rest_.size()) &&
                       !(rest_.lies_in_place(pose) && rest_.lies_otherwise(pose));
    if (begins_) {
      // Where c was placed in this tick nothing is blended twice for it: the anchor goes on alone, and all the way.
      pull = rub(d, terms, [&] {
        leave_core(d, wanted.deflection);
        return give_way(wanted.force, d, terms, false);
      });
    } else if (rests) {
      pull = at_rest(core_force(d, terms), d, terms);
    } else {
      const double held = stored(terms, d), strained = strain(before, d, terms);
      const double done = strained > 0 ? work(terms, before, way) : 0;
      const Vec3 rim = rim_deflection(d);
      const bool went =
          rest_.follow(pose, last_, wanted.deflection, terms.normal_force, length(way), d.depth - depth, served);
      d = rest_.deflection(last_);
      if (!(d.depth > 0)) return release(d);
      rim_.leave(d.sideways, rim);
      field().set_depth(d.depth, terms);
      pull = give_way(core_force(d, terms), d, terms, went);
      if (replaced(held, rubbed(strained, done, pull, way, d, terms), d, terms)) {
        if (!(d.depth > 0)) return release(d);
        pull = at_rest(core_force(d, terms), d, terms);
      }
    }
    const double size = length(pull);
    if (size > terms.limit) pull = (terms.limit / size) * pull;
    depth_ = d.depth;
    field().remember(terms);
    if constexpr (kFriction) {
      if (tallies()) tally_.keep(d.sideways, pull, lean(terms, d), strain(pull, d, terms));
    }
    if (field().is_coupled()) couple(terms, d, rim_.present() ? core_force(d, terms) : pull);
    return output(State::slide, pose, last_, terms, pull);
  }

  /// There is friction.
  [[nodiscard]] bool rubs() const {
    if constexpr (kFriction) return rubs_;
    return false;
  }
  /// The sideways forces are no gradient, and what they hold is not in stored().
  [[nodiscard]] bool tallies() const {
    if constexpr (kFriction) return tallies_;
    return false;
  }
  [[nodiscard]] double strain(const Vec3& pull, const Deflection& d, const DepthTerms& terms) const {
    return tallies() ? most_strain(terms, d, pull, rim_.present() ? core_force(d, terms) : pull) : 0;
  }

  /// J of the hand's that friction took of what the sideways deflections hold, where strain() was `before` and the body
  /// did `done` (J) on the tool at the motion's end. With the force that is left there the hand gave less on its `way`
  /// (m), too.
  double rubbed(double before, double done, const Vec3& pull, const Vec3& way, const Deflection& d,
                const DepthTerms& terms) {
    if constexpr (kFriction) {
      if (before > 0) return tally_.rub(strain(pull, d, terms) / before) + done - work(terms, pull, way);
    }
    return 0;
  }
  /// J, of a force at one end of a way (m), by the rule of trapezoids.
  [[nodiscard]] double work(const DepthTerms& terms, const Vec3& pull, const Vec3& way) const {
    return 0.5 * dot(terms.normal_force * field().normal() + pull, way);
  }

  /// J that the straight push's sideways force holds, as in stored() of a separable file.
  [[nodiscard]] double lean(const DepthTerms& terms, const Deflection& d) const {
    const double core = -rim_.core_limit() * dot(terms.straight, d.sideways);
    return rim_.present() ? rim_.mean(core, -rim_.limit() * dot(terms.straight, rim_deflection(d))) : core;
  }

  /// J that the sideways deflections hold at most; `pull` (N) is what they and the straight push do, the core's `core`.
  [[nodiscard]] PALPATE_TICK_INLINE double most_strain(const DepthTerms& terms, const Deflection& d, const Vec3& pull,
                                                       const Vec3& core) const {
    const auto most = [&](double lean, const Vec3& force, const Vec3& deflection) {
      return std::fabs(dot(lean * terms.straight - force, deflection));
    };
    if (!rim_.present()) return most(1, pull, d.sideways);
    const double share = rim_.share();
    const Vec3 rim = (1 / share) * (pull - (1 - share) * core);
    return rim_.mean(most(rim_.core_limit(), core, d.sideways), most(rim_.limit(), rim, rim_deflection(d)));
  }

  /// Has the account owe what the hand got sideways in this tick and had not given. True where depth was lost for it.
  PALPATE_TICK_INLINE bool tell(const Vec3& pull, const Vec3& core, Deflection& d, DepthTerms& terms) {
    if constexpr (kFriction) {
      const double most = most_strain(terms, d, pull, core), more = tally_.add(d.sideways, pull, lean(terms, d), most);
      if (more > 0) return owe(more, d, terms);
    }
    return false;
  }
  [[gnu::noinline]] bool owe(double more, Deflection& d, DepthTerms& terms) {
    account_.owe(more);
    // A push of some power of the depth stores at least a fifth of this.
    if (!(account_.owed() > 0.1 * terms.normal_force * d.depth)) return false;
    const double now = stored(terms, d), due = account_.too_much(now, more);
    if (due > 0) account_.held_back(now - lose(due, d, terms));
    return due > 0;
  }

  /// Where a new place holds clearly less of the `core` (N) there than friction held at the old one, the rest gives way
  /// without c; where c was held up all of it, for nothing else does: a tick at rest would go on. Returns the sideways
  /// force.
  PALPATE_TICK_INLINE Vec3 give_way(Vec3 core, Deflection& d, const DepthTerms& terms, bool went) {
    if constexpr (kFriction) {
      const double most = rim_.core_limit() * terms.limit * (went ? 1.001 : 1 + 1e-9);
      for (int turn = 0; turn < kMostSlips && length(core) > most; ++turn) {  // once, but after a leap
        const Slipped to = slipped(d, terms, core, true);
        leave_core(d, to.deflection);
        core = to.force;
      }
    }
    return rim_.present() ? with_rim(at_limit(core, terms), d, terms) : core;
  }

  /// N across n(c) of a contact that slides, while c rests.
  Vec3 at_rest(const Vec3& core, const Deflection& d, const DepthTerms& terms) {
    return rim_.present() ? with_rim_alone(at_limit(core, terms), d, terms) : core;
  }

  /// Without this the torque on a round skin that turns would do work that is nobody's. A contact that slides needs it
  /// not: its c goes on anyway.
  [[gnu::noinline]] void roll_on(const Pose& pose, Deflection& d, DepthTerms& terms) {
    const double before = leave(terms, d);
    rest_.roll_on(pose, last_, d);
    replaced(before, last_, d, terms);
  }

  /// Moves p, which the pose takes to q, and sets what is there then. False, with nothing set, where it stays.
  bool lie_down(const Pose& pose, Vec3& q, Deflection& d, DepthTerms& terms) {
    if (!rest_.lies_otherwise(pose)) return false;
    d = rest_.deflection(q);
    if (!(d.depth > 0)) return false;
    const double before = leave(field().energy_terms(d.depth), d);
    rest_.lie_down(pose, d);
    q = rest_.point(pose);
    replaced(before, q, d, terms);
    return true;
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

  static constexpr int kMostSlips = 8;  // of one part in a tick

  const View* view_;
  bool lasts_ = false, left_ = false;
  bool slides_ = false, begins_ = false;
  Vec3 last_;         ///< m, p in the last tick
  double depth_ = 0;  ///< m, of the last tick
  struct Inner {
    InnerPart core, rim;
    bool lifts = false;  ///< the last depth was less than that before
  };

  EnergyAccount account_;
  detail::If<kFriction, Inner> inner_;
  detail::If<kFriction, bool> rubs_ = {}, tallies_ = {};
  detail::If<kFriction, StrainTally> tally_;  ///< of a separable file
  BasicRest<kFeatures> rest_;
  BasicRim<kFeatures> rim_;
};

}  // namespace palpate::runtime
