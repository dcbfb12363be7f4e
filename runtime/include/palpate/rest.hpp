// SPDX-License-Identifier: MIT
// Where a contact rests on body and tool: the field of the pair, and how far a tool is deflected from it.
#pragma once

#include "palpate/field.hpp"
#include "palpate/first_touch.hpp"
#include "palpate/illinois.hpp"
#include "palpate/nearby.hpp"
#include "palpate/project.hpp"
#include "palpate/relief.hpp"
#include "palpate/stance.hpp"

#include <cmath>

namespace palpate::runtime {

/// The deflection of a tool, split at c.
struct Deflection {
  double depth;   ///< m, less what is subtracted, that counts (BasicRelief)
  Vec3 sideways;  ///< m, across n(c), from its anchor
};

/// A point c of the body, a point p of the tool and their field. The sideways deflection is that from an anchor, which
/// is c at first. Of layout::Feature those that kFeatures leaves out take neither code nor memory.
template <std::uint32_t kFeatures = layout::feature_all>
class BasicRest {
  static constexpr bool kFriction = (kFeatures & layout::feature_friction) != 0;

public:
  BasicRest(const View& view, std::uint32_t tool) : view_(&view), stance_(view, tool), relief_(view) {}

  /// Where a tool's point of a search met the body: deflected by what it went since then.
  void begin(const ToolTouch& touch, const FirstTouch& first, const Pose& pose) {
    subtracted_ = first.already;
    anchored_ = rolled_ = {};
    held_up_ = false;
    relief_.begin();
    stance_.begin(touch, first.foot.normal, pose);
    place(first.foot, pose);
    offset_ = tangential(first.at - c_, field_.normal());
  }

  [[nodiscard]] const BasicField<kFeatures>& field() const { return field_; }
  [[nodiscard]] const BodyPoint& at() const { return at_; }
  [[nodiscard]] const Vec3& c() const { return c_; }
  /// m, from where on the sideways deflection counts: not across n(c) exactly.
  [[nodiscard]] Vec3 anchor() const { return c_ + offset_ + anchored_; }
  [[nodiscard]] const ToolPoint& on_tool() const { return stance_.on_tool(); }
  /// m, from p to the skin.
  [[nodiscard]] double probe() const { return stance_.probe(); }
  /// m, of a contact.
  [[nodiscard]] double size() const { return probe() + view_->meta->depth_scale; }
  /// What answers depends on how the tool lies.
  [[nodiscard]] bool lies() const { return stance_.lies(); }
  /// BasicStance::spins().
  [[nodiscard]] bool spins() const { return stance_.spins(); }

  /// However it does, its point of the axis stays: then whatever moves c blends for how it lies now.
  [[nodiscard]] bool lies_in_place(const Pose& pose) const { return stance_.lies_in_place(pose, field_.normal()); }

  /// Where the pose takes p.
  [[nodiscard]] Vec3 point(const Pose& pose) const { return pose.apply(stance_.in_tool()); }

  [[nodiscard]] Deflection deflection(const Vec3& q) const {
    const Vec3& n = field_.normal();
    const Vec3 gap = q - c_;
    return {counted(probe() - dot(gap, n) - subtracted_), tangential(gap - offset_ - anchored_, n)};
  }
  /// The skin overlaps the body by this depth (m), too.
  [[nodiscard]] bool overlaps(double depth) const { return depth + subtracted_ > 0; }

  /// What holds of slow motions alone: p went by a way whose square is given (m^2).
  [[nodiscard]] PALPATE_TICK_INLINE bool slow(double squared) const {
    const double most = kSlow * view_->meta->depth_scale;
    return squared < most * most;
  }

  /// Farther than a hand goes in a tick, by a `way` (m) of p.
  [[nodiscard]] bool far(const Vec3& way) const {
    const double most = kFar * size();
    return dot(way, way) > most * most;
  }

  /// The tool at q is so far aside of c that it may be past an edge: the surface may be nearer to it than the plane of
  /// c by more than past_edge() leaves out.
  [[nodiscard]] PALPATE_TICK_INLINE bool far_aside(const Vec3& q) const {
    const Vec3 gap = q - c_;
    const double height = dot(gap, field_.normal()), out = height > 0 ? height : 0, bend = kBend * size();
    return dot(gap, gap) - height * height > bend * (bend + 2 * out);
  }
  /// m, by which the tool at q is deeper under the plane of c, less what is subtracted, than its skin overlaps the
  /// body: between the two the surface bends away. What any bend may add to a depth is left out.
  [[nodiscard]] double past_edge(const Vec3& q) const {
    return nearby(*view_, at_, q).signed_distance - dot(q - c_, field_.normal()) - subtracted_ - kBend * size();
  }

  /// BasicRelief, of which this knows the depth; its move() for the tool that goes from one point to another.
  [[nodiscard]] BasicRelief<kFeatures>& relief() { return relief_; }
  double relieve(const Vec3& from, const Vec3& to) {
    return relief_.present() ? relief_.move(field_.relief(), length(to - from), sunk(from), sunk(to)) : 0;
  }
  /// By how much the depth that counts grows as the tool at q moves on along -n(c).
  [[nodiscard]] double slope(const Vec3& q) const {
    return relief_.present() ? relief_.slope(field_.relief(), sunk(q)) : 1;
  }
  /// A way (m) of the tool, that is at q now, as far as it counts along n(c).
  [[nodiscard]] Vec3 counted(const Vec3& way, const Vec3& q) const {
    if (!relief_.present()) return way;
    return way + ((slope(q) - 1) * dot(way, field_.normal())) * field_.normal();
  }

  /// Subtracts so much depth (m) from now on.
  void subtract(double depth) { subtracted_ += depth; }
  /// So much (m) of what counts.
  void subtract_of(Deflection& d, double depth) {
    subtract(uncounted(d.depth) - uncounted(d.depth - depth));
    d.depth -= depth;
  }

  /// Moves the anchor so that this much of a sideways deflection is left.
  void leave(Deflection& d, const Vec3& kept) {
    anchored_ = anchored_ + d.sideways - kept;
    d.sideways = kept;
  }

  /// Moves c over the surface until the tool at q, which went `moved` (m) and is deeper by `deepened` (m), is deflected
  /// by `sideways` (m) from it. False where c cannot go on and the anchor does instead: at a corner, where the tool is
  /// off the body wherever c would go, as beyond the lip of a fold, and wherever c would have to leap (in a fast motion
  /// by more than the tool's way accounts for). To end there would drop the force at once, to leap would turn it, so c
  /// stays and the contact lets go as the tool moves. A leap it is, too, where c has a foot, but the force would change
  /// by far more than by the tool's way: c goes after the tool as far as that may be, if it can. `served`: see
  /// hand_over().
  PALPATE_TICK_INLINE bool follow(const Pose& pose, const Vec3& q, const Vec3& sideways, double force, double moved,
                                  double deepened, const Search* served = nullptr) {
    take_over(held_up_ ? HUGE_VAL : moved);
    Projection found = foot(q, sideways);
    const double before = sunk(q), most = kLeap * moved + kLeast * size();
    const bool waits = found.residual > kBeyond * size();
    if (waits && !slow(moved * moved) && hand_over(pose, q, before, most, force, served)) return true;
    const double there = overlap(found, q);
    bool goes = there > 0 && !waits;
    // The tool touches here as well, and in a slow motion as deep.
    const double least = kFriction && view_->has(layout::feature_friction) && slow(moved * moved) ? before : 0;
    double less = still_subtracted(there, before, least);
    // Of a hand at rest what is left of a slip settles.
    const double change = change_of_force(found.normal, before, there - less);
    if (change > most * most && goes && moved > 0) {
      goes = hold_back(found, less, q, sideways, {before, least, most, std::sqrt(change)});
    }
    if (goes) {
      subtracted_ = less;
      place(found, pose);
    } else {
      subtract(moved + std::fmax(0, deepened));
      if (lies_otherwise_here(pose)) turn(field_.normal(), pose);
    }
    // What c could not follow, as at a corner, the anchor does: the force would turn round at once.
    held_up_ = !goes || !found.converged;
    if (held_up_) lead_anchor(q, sideways);
    return !held_up_;
  }

  /// The tool turned since roll() or the last blend.
  [[nodiscard]] bool turned(const Pose& pose) const { return stance_.turned(pose); }

  /// A round skin that turns does not slip: its turn drags the body along. True where that is so far that c is to go
  /// on instead (roll_on).
  [[nodiscard, gnu::noinline]] bool roll(const Pose& pose) {
    const Vec3 way = stance_.take_turn(pose, field_.normal());
    rolled_ = rolled_ + way;
    anchored_ = anchored_ + way;
    constexpr double kShare = 1e-3;  // of a contact's size
    return dot(rolled_, rolled_) >= kShare * kShare * size() * size();
  }

  /// Moves c by what was rolled, and the anchor back to it; by so much of it as c can go.
  void roll_on(const Pose& pose, const Vec3& q, const Deflection& d) {
    anchored_ = anchored_ - rolled_;
    rolled_ = {};
    const Projection found = foot(q, d.sideways);
    place(found, pose);
    if (!found.converged) lead_anchor(q, d.sideways);
  }

  /// BasicStance::let_run().
  void let_run(const Pose& pose, const Vec3& way) { stance_.let_run(pose, way, field_.normal(), size()); }

  /// The tool lies otherwise than when its responses were blended, and has moved.
  [[nodiscard]] PALPATE_TICK_INLINE bool lies_otherwise(const Pose& pose) const {
    return stance_.lies_otherwise(pose, field_.normal());
  }
  /// And p stays: it has come to where it is to be, or waits for another tick, as that of a tool with spins may.
  [[nodiscard]] bool lies_otherwise_here(const Pose& pose) const {
    return (spins() || lies_in_place(pose)) && lies_otherwise(pose);
  }

  /// Blends the responses for how the tool lies. A capsule lays itself down: p runs along the axis to where it is
  /// deepest, c with it, as far as it may and without changing the deflection d of the tool at q: what is gained in
  /// depth that way is no work of the hand and is subtracted. So does p on a mesh tool, over its patches.
  void lie_down(const Pose& pose, const Deflection& d) {
    ToolPlace there = stance_.next(pose, field_.normal());
    const Vec3& from = stance_.in_tool();
    if (length(there.point - from) > 1e-9 * probe()) {
      Vec3 q = pose.apply(there.point);
      Projection to = foot(q, d.sideways);
      // On a sharp edge p may cross the deepest place: there c and p would go to and fro.
      const Vec3 way = pose.rotate(there.point - from);
      const double before = dot(way, field_.normal()), after = dot(way, to.normal);
      if (before * after < 0 && stance_.shorten(before / (before - after), there)) {
        q = pose.apply(there.point);
        to = foot(q, d.sideways);
      }
      const double gained = overlap(to, q) - subtracted_ - uncounted(d.depth);
      if (to.converged && gained >= 0) {
        stance_.go_to(there);
        subtract(gained);
        return place(to, pose);
      }
    }
    turn(field_.normal(), pose);
  }

  /// Turns the tool's pose of the last tick by that of `by`.
  void rebase(const Pose& by) { stance_.rebase(by); }

private:
  /// m, of what is subtracted, that is so where the depth is `there` less that: it is that of the old place, where the
  /// depth was `before` less all. The tool is to be deeper than `least`.
  [[nodiscard]] PALPATE_TICK_INLINE double still_subtracted(double there, double before, double least) const {
    return there - subtracted_ > least ? subtracted_ : std::fmax(0, there - before);
  }

  /// By how much the force is another where n is normal and the depth is `now` (m) instead of `before`, as depth that
  /// pushes with the stiffness (m, squared): it turns, and grows or falls across that.
  [[nodiscard]] PALPATE_TICK_INLINE double change_of_force(const Vec3& n, double before, double now) const {
    return (now - before) * (now - before) + 2 * before * before * (1 - dot(n, field_.normal()));
  }

  /// m, depths.
  struct Leap {
    double before, least;
    double most, change;  ///< that the force may change by, and would
  };

  /// Where c would leap: has it go a part of the way, no deeper, and the anchor the rest. False where c leaps all the
  /// same, as to the other wall of a fold.
  [[gnu::noinline]] bool hold_back(Projection& found, double& less, const Vec3& q, const Vec3& sideways,
                                   const Leap& leap) const {
    constexpr double kPart = 0.5;  // of what it may, for the surface may bend more than on the whole way
    const Vec3 to = q - offset_ - anchored_ - sideways, across = tangential(to - c_, field_.normal());
    found = project(*view_, at_, to - (1 - kPart * leap.most / leap.change) * across);
    found.converged = false;
    const double there = overlap(found, q);
    less = std::fmax(still_subtracted(there, leap.before, leap.least), there - leap.before);
    return there > 0 && found.residual <= kBeyond * size() &&
           change_of_force(found.normal, leap.before, there - less) <= leap.most * leap.most;
  }

  /// Moves the anchor to where the tool at q is deflected by `sideways` from it, for c could not follow.
  void lead_anchor(const Vec3& q, const Vec3& sideways) {
    anchored_ = anchored_ + deflection(q).sideways - tangential(sideways, field_.normal());
  }

  /// What the anchor went ahead of c, c takes over when it slides: no faster than the tool moves, by `moved` (m) in
  /// this tick, for another place at once would answer with a step. What the tool turned meanwhile slipped.
  void take_over(double moved) {
    anchored_ = anchored_ - rolled_;
    const double left = length(anchored_) - moved - length(rolled_);
    anchored_ = left > 0 ? (left / length(anchored_)) * anchored_ : Vec3{};
    rolled_ = {};
  }

  /// Where c rests when the tool at q is to be deflected by `sideways` from the anchor.
  [[nodiscard]] Projection foot(const Vec3& q, const Vec3& sideways) const {
    return project(*view_, at_, q - offset_ - anchored_ - sideways);
  }

  /// m, of the skin at q with the body at a point of its surface.
  [[nodiscard]] double overlap(const Projection& there, const Vec3& q) const {
    return probe() - dot(q - there.point, there.normal);
  }
  /// m, of the skin at q under the plane of c, less what is subtracted.
  [[nodiscard]] double sunk(const Vec3& q) const { return probe() - dot(q - c_, field_.normal()) - subtracted_; }
  /// m, that counts of that; and back.
  [[nodiscard]] double counted(double depth) const {
    return relief_.present() ? relief_.counted(field_.relief(), depth) : depth;
  }
  [[nodiscard]] double uncounted(double depth) const {
    return relief_.present() ? relief_.uncounted(field_.relief(), depth) : depth;
  }

  /// Rests the contact at a point of the surface and blends its responses.
  void place(const Projection& to, const Pose& pose) {
    at_ = to.at;
    c_ = to.point;
    turn(to.normal, pose);
  }

  /// Blends the responses for the present point of the body and the tool's present orientation.
  void turn(const Vec3& n, const Pose& pose) { stance_.build(at_, n, pose, field_); }

  /// c cannot follow along the surface (the tool straddles a fissure or left over an edge): takes the point
  /// nearest to the tool instead, at a depth that answers with no more than the present force (N), unless the force
  /// would change by more than that of a depth of `before` (m) does by `most` (m). Where that is, a tracker's latest
  /// search says if there is one: nothing is searched then, and a search that saw nothing, or p half a contact's size
  /// away, says nothing.
  [[gnu::noinline]] bool hand_over(const Pose& pose, const Vec3& q, double before, double most, double force,
                                   const Search* served) {
    if (served && !(served->touch.clearance < HUGE_VAL && length(q - point(served->pose)) < 0.5 * size())) {
      return false;
    }
    const Projection found = project(*view_, served ? served->touch.body.at : locate<kFeatures>(*view_, q, at_).at, q);
    // Decided before anything changes: what stays is as it was.
    const double there = overlap(found, q);
    if (!found.converged || found.at.triangle == at_.triangle || !(there > 0)) return false;
    if (change_of_force(found.normal, before, std::fmin(there, before)) > most * most) return false;
    place(found, pose);
    offset_ = anchored_ = {};
    subtracted_ = 0;
    held_up_ = false;
    DepthTerms terms;
    const auto excess = [&](double depth) {
      field_.set_depth(counted(depth), terms);
      return terms.normal_force - force;
    };
    if (const double above = excess(there); above > 0) {
      // What answers with less is taken.
      Illinois root{0, -force, there, above};
      double left = force;
      while (root.looks < 40 && root.high - root.low > kExact * there && left > kExact * force) {
        const double depth = root.next(), at = excess(depth);
        if (!(at > 0)) left = -at;
        root.narrow(depth, at);
      }
      subtract(there - root.low);
    }
    return true;
  }

  static constexpr double kSlow = 0.05;   // of the depth scale, in a tick: 25 cm/s at 1 kHz where that is 5 mm
  static constexpr double kBeyond = 0.1;  // of a contact's size, that c may be off its foot
  static constexpr double kLeap = 4;      // times p's way, that the force may change by where c goes slowly, and
  static constexpr double kLeast = 1e-4;  // as much of a contact's size, which nobody feels
  static constexpr double kFar = 0.1;     // of a contact's size, in a tick: 50 cm/s at 1 kHz where that is 5 mm
  static constexpr double kExact = 1e-9;  // of a depth and its force, where c is handed over
  static constexpr double kBend = 0.05;   // of a contact's size, that a bend of the surface may add to a depth

  const View* view_;
  BasicStance<kFeatures> stance_;
  BasicRelief<kFeatures> relief_;
  BodyPoint at_;
  Vec3 c_;
  double subtracted_ = 0;  ///< m, from the depth
  Vec3 offset_;            ///< m, across n(c), from c to p at first sight
  Vec3 anchored_;          ///< m, how far the anchor has gone from c (c takes it over when it slides)
  Vec3 rolled_;            ///< m, the part of that which c goes on by once it is large enough to matter
  bool held_up_ = false;   ///< by what c could not follow when it slid last
  BasicField<kFeatures> field_;
};

}  // namespace palpate::runtime
