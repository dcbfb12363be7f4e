// SPDX-License-Identifier: MIT
// One tool against the body: free, sticking, sliding, released; one force a tick.
#pragma once

#include "palpate/field.hpp"
#include "palpate/project.hpp"
#include "palpate/slip.hpp"
#include "palpate/tick.hpp"
#include "palpate/tool.hpp"

#include <cmath>

namespace palpate::runtime {

struct ContactSettings {
  /// Depth (m) that a contact may have when it is first seen; what is deeper is subtracted for as long as it
  /// lasts, so that lag or a start inside the body cannot release energy. Negative: 2 % of the depth scale.
  double late_depth = -1;
};

/// Follows one tool. Every tick takes bounded time, allocates nothing and throws nothing. Not for several
/// threads at once; any number of contacts may share a view, which must outlive them.
/// kFeatures (layout::Feature bits): what it can do; of what is left out it has neither code nor memory, and with a
/// file that holds it every tick is a fault. View::open<kFeatures> says so beforehand.
template <std::uint32_t kFeatures = layout::feature_all>
class BasicContact {
  static constexpr bool kCoupled = (kFeatures & layout::feature_coupled) != 0;
  static constexpr bool kFriction = (kFeatures & layout::feature_friction) != 0;

public:
  /// `tool`: an index below view.meta->tool_count.
  BasicContact(const View& view, std::uint32_t tool, const ContactSettings& settings = {})
      : view_(&view),
        tool_(tool),
        reach_(skeleton_radius<kFeatures>(view, tool)),
        probe_(view.tools[tool].probe_radius) {
    late_ = settings.late_depth >= 0 ? settings.late_depth : 0.02 * view.meta->depth_scale;
    const layout::ToolRecord& record = view.tools[tool];
    profile_ = record.kind == static_cast<std::uint32_t>(layout::ToolKind::profile) && record.axis_length > 0;
  }

  /// Forgets the contact. The next tick must be outside the body, else the contact starts at zero force.
  void reset() {
    touching_ = was_free_ = false;
    search_.touch.safe = -1;
  }

  /// Force at `pose`. Ticks are meant to follow a motion: what happens between two is not seen.
  Tick tick(const Pose& pose) {
    if (!fits() || !pose.valid()) return fault();
    if (keeps(pose)) return hold(pose, pose.apply(anchor_));
    return seek(pose);
  }

  /// The same in a force loop whose searches are made elsewhere, at a lower rate: `latest` is the last that arrived.
  /// Beyond what that search knew to be free, the surface near its nearest point is looked at; a body met elsewhere is
  /// felt from the first search that sees it on, without force at first.
  Tick tick(const Pose& pose, const Search& latest) {
    if (!fits() || !pose.valid() || !latest.pose.valid()) return fault();
    if (keeps(pose)) return hold(pose, pose.apply(anchor_));
    search_ = latest;
    return motion_since_search(pose) < search_.touch.safe ? free() : meet(pose);
  }

  [[nodiscard]] const BasicField<kFeatures>& field() const { return field_; }

private:
  /// The file holds nothing that was left out; grasps are no matter of a contact.
  [[nodiscard]] bool fits() const {
    constexpr std::uint32_t kOfContacts = layout::feature_all & ~(layout::feature_grasp | layout::feature_turn);
    return (view_->features & kOfContacts & ~kFeatures) == 0;
  }

  /// The deflection, split at c.
  struct Deflection {
    double depth;   ///< m, less the depth at first sight
    Vec3 sideways;  ///< m, across n(c)
  };

  /// A touching tool that leaps by more than a contact's size between two ticks did not move, it was put
  /// elsewhere: the depth it finds there is no work of the hand and must not push.
  [[nodiscard]] bool jumped(const Vec3& q) const {
    const Vec3 way = q - last_;
    const double size = probe_ + view_->meta->depth_scale;
    return dot(way, way) > size * size;
  }

  [[nodiscard]] bool keeps(const Pose& pose) {
    if (touching_ && jumped(pose.apply(anchor_))) reset();
    return touching_;
  }

  Tick fault() {
    reset();
    Tick tick;
    tick.state = State::fault;
    return tick;
  }

  Tick free() {
    was_free_ = true;
    return {};
  }

  Tick seek(const Pose& pose) {
    if (search_.touch.safe > 0 && motion_since_search(pose) < search_.touch.safe) return {};
    search_ = search<kFeatures>(*view_, tool_, pose);
    return search_.touch.clearance >= 0 ? free() : meet(pose);
  }

  /// Begins a contact where the last search saw the body, if the tool overlaps it there.
  Tick meet(const Pose& pose) {
    anchor_ = search_.touch.anchor;
    tool_point_ = search_.touch.tool_point;
    offset_depth_ = 0;
    offset_sideways_ = anchored_ = {};
    const Vec3 q = pose.apply(anchor_);
    const double size = probe_ + view_->meta->depth_scale;
    const bool seen = search_.touch.clearance < 0 && motion_since_search(pose) < 0.5 * size;
    const Projection found = seen ? first_point(search_.touch, q) : project(*view_, search_.touch.body.at, q);
    const double depth = probe_ - dot(q - found.point, found.normal);
    // Of what has not been seen the surface near an old point says something as far as it reaches.
    if (!seen && (!found.converged || depth > 0.5 * size)) {
      was_free_ = false;
      return {};
    }
    if (!(depth > 0)) return free();
    place(found, pose);
    const Deflection d = deflection(q);
    offset_depth_ = was_free_ ? std::fmax(0, d.depth - late_) : d.depth;
    offset_sideways_ = d.sideways;
    depth_ = d.depth - offset_depth_;
    touching_ = true;
    // At zero depth there is no force yet, but the contact has begun: from here on the tool may push.
    const DepthTerms terms = field_.at_depth(depth_);
    last_ = q;
    return terms.depth > 0 ? hold(pose, q) : output(State::stick, pose, q, terms, {});
  }

  /// Most that any skeleton point can have moved since the last search.
  [[nodiscard]] double motion_since_search(const Pose& pose) const {
    double turned = 0;
    for (int k = 0; reach_ > 0 && k < 9; ++k) {
      const double d = pose.rotation[k] - search_.pose.rotation[k];
      turned += d * d;
    }
    return length(pose.translation - search_.pose.translation) + std::sqrt(turned) * reach_;
  }

  /// Where the smooth normals meet the tool: there the first deflection is purely along n(c). The nearest
  /// point where they do not meet it close by.
  [[nodiscard]] Projection first_point(const ToolTouch& touch, const Vec3& q) const {
    Projection found = project(*view_, touch.body.at, q);
    const double reach = std::fabs(touch.body.signed_distance);
    const bool near = std::fabs(found.height) <= 1.5 * reach + 0.1 * probe_;
    if (found.converged && near) return found;
    found.at = touch.body.at;
    found.point = touch.body.point;
    found.normal = normal(*view_, found.at);
    return found;
  }

  /// Rests the contact at a point of the surface and blends its responses.
  void place(const Projection& to, const Pose& pose) {
    at_ = to.at;
    c_ = to.point;
    turn(to.normal, pose);
  }

  /// Blends the responses for the present point of the body and the tool's present orientation.
  void turn(const Vec3& n, const Pose& pose) {
    if (profile_) {
      meridian_ = profile_meridian(view_->tools[tool_], anchor_.z, pose.along_axis(n));
      tool_point_ = profile_point(*view_, view_->tools[tool_], meridian_);
    }
    field_.build(*view_, tool_, at_, tool_point_, n);
  }

  [[nodiscard]] Deflection deflection(const Vec3& q) const {
    const Vec3& n = field_.normal();
    const Vec3 gap = q - c_;
    return {probe_ - dot(gap, n) - offset_depth_, tangential(gap - offset_sideways_ - anchored_, n)};
  }

  /// `before`: where the pose takes the anchor.
  Tick hold(const Pose& pose, const Vec3& before) {
    const Vec3 q = profile_ ? roll(pose, before) : before;
    last_ = q;
    Deflection d = deflection(q);
    if (!(d.depth > 0)) return release(d);
    if constexpr (kCoupled) {
      if (view_->coupled_laws != nullptr) deepen(d);
    }
    DepthTerms terms = field_.at_depth(d.depth);
    if (!kFriction || !view_->has(layout::feature_friction)) return follow(pose, q, d, {}, terms);
    const Vec3 tangential_force = terms.straight + field_.sideways(terms, d.sideways);
    if (length(tangential_force) > terms.limit * (1 + 1e-9)) {
      return follow(pose, q, d, slip(field_, terms, view_->meta->sideways_scale, d.sideways, tangential_force), terms);
    }
    field_.couple(terms, d.sideways);
    return output(State::stick, pose, q, terms, tangential_force);
  }

  /// The anchor rule: sideways motion has been added to the effective deflection; going deeper moves its anchor.
  [[gnu::noinline]] void deepen(Deflection& d) {
    if (d.depth > depth_) {
      const Vec3 kept = field_.deepened(depth_, d.depth, d.sideways);
      anchored_ = anchored_ + d.sideways - kept;
      d.sideways = kept;
    }
    depth_ = d.depth;
  }

  /// Moves c over the surface until the sideways deflection is `wanted`.
  Tick follow(const Pose& pose, const Vec3& q, const Deflection& before, const Vec3& wanted,
              const DepthTerms& terms_before) {
    const double size = probe_ + view_->meta->depth_scale;  // m, of a contact
    DepthTerms terms = terms_before;
    Deflection d = before;
    // c rests while the tool moves along n(c): 0.1 nm on a contact of 10 mm.
    if (length(d.sideways - wanted) > 1e-8 * size) {
      const Vec3 target = q - offset_sideways_ - wanted;
      anchored_ = {};  // c itself goes on
      const Projection found = project(*view_, at_, target);
      if (found.residual > 0.1 * size && hand_over(pose, q, terms.normal_force)) {
        d = deflection(q);
      } else {
        place(found, pose);
        d = deflection(q);
      }
      if (!(d.depth > 0)) return release(d);
      terms = field_.at_depth(d.depth);
    }
    Vec3 tangential_force = terms.straight + field_.sideways(terms, d.sideways);
    const double sideways_force = length(tangential_force);
    if (sideways_force > terms.limit) tangential_force = (terms.limit / sideways_force) * tangential_force;
    depth_ = d.depth;
    field_.couple(terms, d.sideways);
    return output(State::slide, pose, q, terms, tangential_force);
  }

  /// c cannot follow along the surface (the tool straddles a fissure or left over an edge): takes the point
  /// nearest to the tool instead, at a depth that answers with no more than the present force.
  bool hand_over(const Pose& pose, const Vec3& q, double force) {
    const Location nearest = locate<kFeatures>(*view_, q);
    const Projection found = project(*view_, nearest.at, q);
    // Decided before anything changes: a contact that stays must not lose depth tick by tick.
    if (!found.converged || found.at.triangle == at_.triangle) return false;
    place(found, pose);
    offset_sideways_ = {};
    const double depth = deflection(q).depth + offset_depth_;
    double low = 0, high = std::fmax(0, depth - offset_depth_);
    if (field_.at_depth(high).normal_force > force) {
      for (int i = 0; i < 40; ++i) {
        const double middle = 0.5 * (low + high);
        (field_.at_depth(middle).normal_force > force ? high : low) = middle;
      }
      offset_depth_ = depth - low;
    }
    return true;
  }

  /// A capsule lays itself down: p runs along the axis to where it is deepest, c with it, at a bounded rate
  /// and without changing the sideways deflection. Returns where the pose takes the anchor then.
  Vec3 roll(const Pose& pose, const Vec3& before) {
    const layout::ToolRecord& record = view_->tools[tool_];
    const double cosine = pose.along_axis(field_.normal());
    const double step = std::fmax(-0.1, std::fmin(0.1, -cosine)) * probe_;
    const double along = std::fmax(0, std::fmin(record.axis_length, anchor_.z + step));
    if (std::fabs(along - anchor_.z) > 1e-9 * probe_) {
      const Deflection d = deflection(before);
      anchor_.z = along;
      const Vec3 q = pose.apply(anchor_);
      place(project(*view_, at_, q - offset_sideways_ - anchored_ - d.sideways), pose);
      return q;
    }
    if (std::fabs(profile_meridian(record, anchor_.z, cosine) - meridian_) > 1e-6 * probe_) {
      turn(field_.normal(), pose);
    }
    return before;
  }

  Tick release(const Deflection& d) {
    touching_ = false;
    was_free_ = !(d.depth + offset_depth_ > 0);
    search_.touch.safe = -1;
    Tick tick;
    tick.state = State::released;
    return tick;
  }

  [[nodiscard]] Tick output(State state, const Pose& pose, const Vec3& q, const DepthTerms& terms,
                            const Vec3& tangential_force) const {
    const Vec3& n = field_.normal();
    Tick tick;
    tick.state = state;
    tick.force = terms.normal_force * n + tangential_force;
    tick.tool_point = q - probe_ * n;
    tick.torque = cross(tick.tool_point - pose.translation, tick.force);
    tick.depth = terms.depth;
    tick.friction_limit = terms.limit;
    tick.covered = field_.covered();
    tick.beyond = terms.beyond;
    tick.body_point = c_;
    tick.at = at_;
    tick.on_tool = tool_point_;
    return tick;
  }

  const View* view_;
  std::uint32_t tool_;
  double reach_, probe_;  ///< m
  double late_ = 0;
  bool profile_ = false;

  bool touching_ = false;
  bool was_free_ = false;  ///< the last tick saw no overlap
  Search search_;          ///< the last one; free until the tool has moved by touch.safe from its pose
  Vec3 last_;              ///< m, the anchor in the last tick

  BodyPoint at_;
  Vec3 c_;
  Vec3 anchor_;  ///< m, tool frame
  ToolPoint tool_point_;
  double meridian_ = 0;
  double offset_depth_ = 0;  ///< m, subtracted: depth at first sight
  Vec3 offset_sideways_;     ///< m, the same across n(c)
  // The coupled model's state: the depth of the last tick, and how far the anchor of the sideways deflection has gone
  // from c (c takes it over when it slides).
  double depth_ = 0;  ///< m
  Vec3 anchored_;     ///< m
  BasicField<kFeatures> field_;
};

using Contact = BasicContact<>;

}  // namespace palpate::runtime
