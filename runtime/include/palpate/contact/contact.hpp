// SPDX-License-Identifier: MIT
// One tool against one body: the contact law. The README of include/palpate has its equations on one page.
#pragma once

#include "palpate/body/body.hpp"
#include "palpate/contact/contact_state.hpp"
#include "palpate/contact/first_contact.hpp"
#include "palpate/contact/tick_frame.hpp"
#include "palpate/response/interpolation.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace palpate::runtime {

/// Constants of how a contact moves over body and tool.
struct ContactConstants {
  /// Times the tool's travel in a tick: the way that p, and the response in use towards that at c, may go. c itself may
  /// leap.
  static constexpr double kPointSpeed = 8;
  /// Times the tool's travel over the indentation: angle (rad) by which the normal may turn in a tick.
  static constexpr double kTurnSpeed = 2;
  /// c rests while its target is nearer than this times a contact's size. It saves a blend that would change nothing.
  static constexpr double kRest = 1e-3;
  /// Weight of the smooth normal in the contact's normal, in radii. Without it the normal turns at once where the
  /// tool's core comes near the surface.
  static constexpr double kSmoothNormal = 0.3;
  /// Clearance at which a sweep has found the first touch, over the depth scale.
  static constexpr double kTouchGap = 1e-3;
  /// Least depth in a contact's size, over the tool's radius: a touch has a size too.
  static constexpr double kLeastDepth = 0.02;
  /// Share of the tool's radius in a contact's size: no contact is smaller.
  static constexpr double kLeastSize = 0.25;
};

/// Follows one tool. Every tick takes bounded time, allocates nothing and throws nothing. Not for several threads at
/// once; any number of contacts may share a view, which must outlive them and stay where it is, for contacts keep its
/// address. kFeatures (layout::Feature bits): a file that has a feature which is left out makes every tick a fault;
/// View::open<kFeatures> refuses it beforehand.
template <std::uint32_t kFeatures = layout::feature_all>
class BasicContact {
public:
  /// `tool`: an index below view.meta->tool_count; any other makes every tick a fault.
  BasicContact(const View& view, std::uint32_t tool) : view_(&view), tool_(tool), shape_(view, tool) {}
  BasicContact(const View&&, std::uint32_t) = delete;  ///< a temporary view would be gone at the first tick

  /// Forgets the contact. A tool that overlaps the body in the next tick begins without force.
  void reset() {
    state_.reset();
    free_.reset();
    foot_tracker_.reset();
  }

  /// The force at a pose of the tool (body frame).
  Tick tick(const Pose& tool) { return tick(tool, StillBody{view_}); }
  /// The same with searches that are made elsewhere at a lower rate: `latest` is the last that arrived. Such a tick
  /// never searches. A contact at a new place begins when a search has found the place.
  Tick tick(const Pose& tool, const Search& latest) { return tick(tool, StillBody{view_}, &latest); }

  /// The force at a pose of the tool (world) against a body that moves, deforms or changes its stiffness
  /// (body/body.hpp). All vectors of the tick are in the world's frame.
  template <class Body>
  Tick tick(const Pose& tool, const Body& body, const Search* latest = nullptr) {
    if (const Fault fault = check(tool, body, latest); fault != Fault::none) {
      reset();
      Tick tick;
      tick.state = State::fault;
      tick.fault = fault;
      return tick;
    }
    const bool lasted = state_.touching;
    if (!lasted) {
      const Sweep found = free_.advance(shape_, tool, body, latest, size(view_->meta->depth_scale),
                                        ContactConstants::kTouchGap * view_->meta->depth_scale);
      if (!found.touches) return {};
      begin(found.touch, body.surface_frame() * found.pose, body);
    }
    auto frame = body.frame(state_.place.body_point.at);
    Motion way(state_.tool, in_body(tool, frame));
    if (length(way.of(state_.place.tool_point.point)) > size(view_->meta->depth_scale)) {
      if (!put_elsewhere(tool, body, latest)) {
        free_.leave(tool, body, state_.place.foot.at);
        return released();
      }
      frame = body.frame(state_.place.body_point.at);
      way = Motion(state_.tool, in_body(tool, frame));
    }
    Tick tick = step(in_body(tool, frame), way, body, latest);
    if (!state_.touching) {
      free_.leave(tool, body, state_.place.foot.at);
      return lasted ? tick : Tick{};
    }
    state_.tool = in_body(tool, frame);
    rebase(frame, body.frame(state_.place.body_point.at));
    return in_world(frame, tick);
  }

  /// Begins a contact without force at the place of a search. `touch`: of this file and tool; its indices are not
  /// checked (see valid). `tool`: the pose (world) there; the motion from it to the next tick's pose counts.
  template <class Body>
  void begin(const ToolTouch& touch, const Pose& tool, const Body& body) {
    state_.reset();
    state_.touching = true;
    const BodyPoint& at = touch.body.at;
    state_.tool = in_body(tool, body.frame(at));
    ContactPlace& place = state_.place;
    // Against the surface as baked: a search may have been made on a deformed one.
    place.foot = local_closest_point(*view_, at, state_.tool.apply(touch.core.point));
    place.foot.signed_distance = std::copysign(place.foot.signed_distance, touch.body.signed_distance);
    state_.tool = in_body(tool, body.frame(place.foot.at));  // the frame at c, in which the motion goes on
    place.body_point = place.foot;
    place.target = place.foot.point;
    place.normal = smooth_normal(*view_, at);
    place.axis = any_orthogonal(place.normal);
    place.tool_point = touch.core;
    place.tool_point.at = shape_.sampled_point(touch.core, state_.tool, place.normal);
    state_.indentation = larger(0, shape_.skin() - place.foot.signed_distance);
    state_.factor = body.factor(at);
    state_.applied.point = place.tool_point.point;
    foot_tracker_.reset();
  }

  /// Whether the foot keeps to its wall by a walk over the surface. Otherwise it is the closest point of the whole body,
  /// which may lie on another wall. For one contact of several.
  void keep_to_wall(bool keep) { keeps_to_wall_ = keep; }

  /// Whether a search's pose is valid and its indices are of this file and tool.
  [[nodiscard]] bool valid(const Search& search) const {
    return search.touch.body.at.triangle < view_->meta->triangle_count &&
           (!shape_.is_mesh() || search.touch.core.at.patch < view_->meta->tool_patch_count) && search.pose.valid();
  }

  /// Everything that the contact remembers (body frame as baked).
  [[nodiscard]] const ContactState& state() const { return state_; }
  [[nodiscard]] const BlendedResponse<kFeatures>& response() const { return response_; }

  /// Everything that ticks change and that later ticks depend on. The last search's triangles are not in it: they only
  /// make a tick faster.
  struct Memory {
    ContactState state;
    FreeTool free;
    BlendedResponse<kFeatures> response;
  };
  [[nodiscard]] Memory memory() const { return {state_, free_, response_}; }
  /// Goes back to where memory() was called.
  void restore(const Memory& memory) {
    state_ = memory.state;
    free_ = memory.free;
    response_ = memory.response;
    set_layers();
  }

  [[nodiscard]] const ToolShape<kFeatures>& shape() const { return shape_; }
  [[nodiscard]] const View& view() const { return *view_; }

  /// m, radius of the contact area at a depth (m) and a quarter of the tool's radius: how far apart two walls have to be
  /// to count as two. A tool that goes farther in a tick was put elsewhere and begins anew, without force.
  [[nodiscard]] double size(double depth) const {
    const double radius = rounding();
    return std::sqrt(2 * radius * larger(depth, ContactConstants::kLeastDepth * radius)) +
           ContactConstants::kLeastSize * radius;
  }

private:
  /// A trial of the tick's end at one counted depth.
  struct Trial {
    SpringForce friction;
    Vec2 recovery;             ///< m
    ResponseAtDepth response;
    Vec3 force;                ///< N, without the body's factor
    double other = 0;          ///< J stored beside W, without the body's factor
  };
  /// The motion of a tick, for all its trials.
  struct TickMotion {
    double moved = 0;  ///< m, largest travel of the tool's skin
    double crept = 0;  ///< m, by which the response went on towards c
    Vec3 before;       ///< m, motion of the tool's point where the last force acted
    Vec3 after;        ///< m, motion of the tool's point where this force acts
    Vec3 point;        ///< m, of the tool's frame, where this force acts
    Vec3 axis_y;       ///< unit, n x axis
    Vec2 way;          ///< m, the part of `after` across n
  };

  /// m: the skin's radius; of a tool without skin the depth scale.
  [[nodiscard]] double rounding() const {
    return shape_.skin() > 0 ? shape_.skin() : view_->meta->depth_scale;
  }

  template <class Body>
  [[nodiscard]] Fault check(const Pose& tool, const Body& body, const Search* latest) const {
    constexpr std::uint32_t kContact = layout::feature_all & ~layout::kFeaturesBesideContacts;
    if ((view_->features & kContact & ~kFeatures) != 0) return Fault::feature_left_out;
    if (!(tool_ < view_->meta->tool_count)) return Fault::no_such_tool;
    if (!tool.valid() || !body.valid()) return Fault::bad_pose;
    return latest == nullptr || valid(*latest) ? Fault::none : Fault::bad_search;
  }

  static const Tick& in_world(StillFrame /*frame*/, const Tick& tick) { return tick; }
  static Tick in_world(const Pose& frame, const Tick& tick) { return transformed(frame, tick); }

  /// Expresses the state in the body's frame at the new c. It keeps every bit where the frame is the same.
  void rebase(StillFrame /*from*/, StillFrame /*to*/) {}
  void rebase(const Pose& from, const Pose& to) {
    if (from == to) return;
    const Pose by = inverse(to) * from;
    state_.tool = by * state_.tool;
    state_.place.normal = by.rotate(state_.place.normal);
    state_.place.axis = by.rotate(state_.place.axis);
    state_.applied.force = by.rotate(state_.applied.force);
  }

  /// One tick of a contact that lasts; `tool` in the frame of the body near c, `way` since the last tick.
  template <class Body>
  Tick step(const Pose& tool, const Motion& way, const Body& body, const Search* latest) {
    ContactPlace& place = state_.place;
    TickMotion motion;
    motion.moved = way.travel(shape_.extent());
    const double reach = ContactConstants::kPointSpeed * motion.moved;
    const CorePoint from = place.tool_point;
    place.tool_point = shape_.advance(from, tool, place.foot, place.normal, reach);
    const Vec3 q = tool.apply(place.tool_point.point);
    advance_foot(q, length(q - state_.tool.apply(from.point)), latest);
    // A search that arrives late may find less than was felt: it is lost as the tool moves.
    const double z = larger(shape_.skin() - place.foot.signed_distance, state_.indentation - motion.moved);
    if (!(z > 0)) {
      state_.touching = false;
      return released();
    }
    turn_normal(q, z, motion.moved);
    const bool turned_tool = orientation_matters() && !(state_.tool == tool);
    if (motion.moved > 0) advance_body_point();
    if (!state_.blended || place.lag > 0 || !same(from, place.tool_point) || turned_tool) {
      motion.crept = smaller(place.lag, reach);
      blend(tool, state_.blended && place.lag > reach ? reach / place.lag : 1);
      state_.blended = true;
      place.lag -= motion.crept;
    }

    motion.point = place.tool_point.point - shape_.skin() * tool.unrotate(place.normal);
    motion.before = way.of(state_.applied.point);
    motion.after = way.of(motion.point);
    motion.axis_y = cross(place.normal, place.axis);
    motion.way = {dot(motion.after, place.axis), dot(motion.after, motion.axis_y)};
    return answer(tool, z, motion, body);
  }

  /// Begins anew, without force, where the tool is now. False where it overlaps nothing there.
  template <class Body>
  bool put_elsewhere(const Pose& tool, const Body& body, const Search* latest) {
    state_.touching = false;
    const Pose& there = in_body(tool, body.surface_frame());
    const ToolTouch touch = latest != nullptr
                                ? local_touch(body.surface(), shape_, *latest, there, latest->touch.body.at)
                                : shape_.touch(body.surface(), there, state_.place.foot.at);
    if (!(touch.clearance < 0)) return false;
    begin(touch, tool, body);
    return true;
  }

  static Tick released() {
    Tick tick;
    tick.state = State::released;
    return tick;
  }

  /// f: the point of the surface closest to q. `moved` (m): the way of q since the last tick. The side of the surface
  /// on which q lies changes only where q can have crossed it, so a surface that folds over itself turns nothing round.
  void advance_foot(const Vec3& q, double moved, const Search* latest) {
    Location& foot = state_.place.foot;
    Location closest;
    if (keeps_to_wall_) {
      closest = local_closest_point(*view_, foot.at, q);
    } else if (latest != nullptr) {
      closest = local_closest_point(*view_, foot.at, latest->touch.body.at, q);
    } else {
      closest = foot_tracker_.at(*view_, q, foot.at);
    }
    const double before = foot.signed_distance, distance = std::fabs(closest.signed_distance);
    constexpr double kRounding = 1 + 1e-6;  // a way straight through the surface is just as long
    const bool crosses = std::fabs(before) + distance <= moved * kRounding;
    const bool inside = crosses ? is_inside(*view_, q, closest) : before < 0;
    closest.signed_distance = inside ? -distance : distance;
    foot = closest;
  }

  /// n turns towards unit(sign (q - f) + 0.3 R n_s), with n_s the smooth normal at f: nearly the gradient of the
  /// indentation. n turns at a bounded rate, also while f goes from one wall of a crease to the other, so the force of
  /// indentation z changes by at most kTurnSpeed times that of a press by the tool's travel. The tangential axis is
  /// carried along.
  void turn_normal(const Vec3& q, double z, double moved) {
    if (!(moved > 0)) return;  // at rest not even rounding turns it
    ContactPlace& place = state_.place;
    const double sign = place.foot.signed_distance < 0 ? -1 : 1, smooth = ContactConstants::kSmoothNormal * rounding();
    const Vec3 target =
        unit(sign * (q - place.foot.point) + smooth * smooth_normal(*view_, place.foot.at), place.normal);
    const Vec3 turn = target - place.normal;
    const double most = ContactConstants::kTurnSpeed * moved / z, angle = length(turn);
    const Vec3 n = angle <= most ? target : unit(place.normal + (most / angle) * turn, place.normal);
    const Vec3 axis = tangential(turned(place.axis, place.normal, n), n);
    place.axis = dot(axis, axis) > 1e-6 ? unit(axis, axis) : any_orthogonal(n);
    place.normal = n;
  }

  /// c: the point of the surface closest to the foot less the springs' deflection. It may leap; the response does not.
  void advance_body_point() {
    ContactPlace& place = state_.place;
    const Vec2& mean = state_.springs.mean;
    const Vec3 y = cross(place.normal, place.axis);
    const Vec3 target = place.foot.point - mean.x * place.axis - mean.y * y;
    const double rest = ContactConstants::kRest * size(state_.indentation);
    if (length(tangential(target - place.target, place.normal)) <= rest) return;
    const Vec3 from = place.body_point.point;
    place.target = target;
    place.body_point = local_closest_point(*view_, place.body_point.at, place.foot.at, target);
    place.lag += length(place.body_point.point - from);
  }

  [[nodiscard]] static bool same(const CorePoint& a, const CorePoint& b) {
    bool same = a.at.patch == b.at.patch;
    for (int k = 0; k < 3; ++k) same = same && a.at.weights[k] == b.at.weights[k];
    return same;
  }
  [[nodiscard]] bool orientation_matters() const {
    return (kFeatures & layout::feature_spin) != 0 && view_->spins != nullptr;
  }

  /// `share`: of the response at (c, p) in the new response; the rest is the old one.
  void blend(const Pose& tool, double share) {
    ContactPlace& place = state_.place;
    const Vec3 n = smooth_normal(*view_, place.body_point.at);
    const BlendedResponse<kFeatures> old = response_;
    response_.blend(*view_, tool_, place.body_point.at, place.tool_point.at, turned(place.axis, place.normal, n), &tool);
    if (share < 1) response_.mix(old, 1 - share);
    set_layers();
  }

  void set_layers() {
    if constexpr ((kFeatures & layout::feature_friction) != 0) layers_.set(response_.law(), response_.softening());
  }

  /// The force at the indentation z (m). The counted depth d is z where the hand has put in what the contact stored at the
  /// last indentation z_0; else
  ///
  ///     d = z - z_0 + the depth at which W + energy beside W = E,
  ///
  /// for the tick's own work deepens d as it deepens z (by at most the tool's way). If the force at d would take more
  /// than E holds, as in one long step, d falls further. Corrections are bounded by the way of the tool and of c in this
  /// tick; the rest is made in the next ones.
  template <class Body>
  Tick answer(const Pose& tool, double z, const TickMotion& motion, const Body& body) {
    const double wanted = body.factor(state_.place.body_point.at), step = body.factor_step();
    const double factor = smaller(larger(wanted, state_.factor - step), state_.factor + step);
    const double last = state_.indentation, covered_work = factor > 0 ? state_.energy.energy() / factor - state_.other : 0;
    NormalResponse before, full;
    if (last > 0) before = response_.law().normal(last);
    const auto covered_depth = [&] {
      return EnergyTank::counted_depth(response_.law(), covered_work, last, before.work, state_.counted_depth);
    };
    // A factor that rises makes the work of every depth larger. The part that E does not cover is lost before the
    // tick's motion, or the force would rise at rest.
    if (factor > state_.factor) {
      const double left = state_.factor / factor * state_.counted_depth;
      state_.counted_depth = clamped(covered_depth(), left, state_.counted_depth);
    }
    // An indentation that grows by more than the tool's way was found, not made.
    const double deepened = smaller(z - last, motion.moved);
    const double kept = state_.counted_depth + deepened;
    const double most = EnergyConstants::kCorrection * (motion.moved + motion.crept);
    const double least = larger(kept - most, 0);
    double depth = z, limit = 0;
    const double slack = smaller(EnergyConstants::kRounding * view_->meta->depth_scale, motion.moved);  // m
    const bool deficit = covered_work < before.work - slack * before.normal_force || kept < z - slack;
    if (deficit) {
      full = response_.law().normal(z);
      depth = smaller(clamped(covered_depth() + deepened, least, kept + most), z);
      limit = EnergyTank::recovery_limit(before.work > 0 ? covered_work / before.work : 0, full.normal_force);
      before = state_.counted_depth > 0 ? response_.law().normal(state_.counted_depth) : NormalResponse{};
    } else {
      state_.counted_depth = last;  // it differs from `last` by rounding alone
    }
    const SpringState springs = state_.springs;
    Trial trial;
    double energy = 0;
    for (int round = 0;; ++round) {
      try_depth(depth, z, full.normal_slope, limit, motion, trial);
      energy = energy_after(depth, before, factor, motion, trial);
      if (!deficit && round == 0) full = trial.response;
      const double spare = factor > 0 ? energy / factor - trial.other : 0;
      const bool covered = spare >= (1 - EnergyConstants::kMissing) * trial.response.work;
      if (covered || round == EnergyConstants::kRounds || !(depth > least)) break;
      depth = larger(EnergyTank::counted_depth(response_.law(), spare, depth, trial.response.work, depth), least);
      state_.springs = springs;
    }
    state_.energy.settle(energy, factor * (full.work + trial.other),
                         motion.moved / (EnergyConstants::kHoldTravel * rounding()));
    state_.recovery = trial.recovery;
    state_.other = trial.other;
    state_.indentation = z;
    state_.counted_depth = depth;
    state_.factor = factor;
    state_.applied = {factor * trial.force, motion.point, factor * trial.response.normal_slope,
                      factor * trial.response.stiffness.m};
    return report(tool, trial);
  }

  /// Force at a counted depth, to which the springs go. `limit` (N) and `stiffness` (N/m, where depth < z): of the
  /// recovery layer.
  void try_depth(double depth, double z, double stiffness, double limit, const TickMotion& motion, Trial& trial) {
    trial.response = depth > 0 ? response_.law().at(depth) : ResponseAtDepth{};
    const ResponseAtDepth& r = trial.response;
    trial.friction = {};
    if ((kFeatures & layout::feature_friction) != 0 && response_.law().has_friction()) {
      trial.friction = update_springs(layers_, r, {state_.counted_depth, depth, motion.way}, state_.springs);
    }
    const Vec2& mean = state_.springs.mean;
    // The recovery layer: its deflection shrinks no faster than the tool moves.
    const double slope = depth < z ? stiffness : r.normal_slope, last = length(state_.recovery);
    trial.recovery = state_.recovery + motion.way;
    const double reach = length(trial.recovery), most = larger(slope > 0 ? limit / slope : 0, last - motion.moved);
    if (reach > most) trial.recovery = (larger(most, 0) / reach) * trial.recovery;
    const Vec2 drag = slope * trial.recovery;
    // Slip removes the shear that the sticking contact's bias contains.
    const Vec2 bias = (1 - trial.friction.lost_bias) * r.bias;
    const double normal = r.normal_force + (1 - trial.friction.lost_bias) * dot(r.bias_slope, mean) + 0.5 * quadratic(r.normal_coupling, mean) -
                          trial.friction.lost_force;
    const Vec2 push = bias + trial.friction.force + drag;
    trial.force = larger(0, normal) * state_.place.normal - push.x * state_.place.axis - push.y * motion.axis_y;
    trial.other = dot(bias, mean) + trial.friction.energy - trial.friction.lost_work +
                  0.5 * dot(drag, trial.recovery);
  }

  /// J in the contact after the tick: the hand's work against the last force and this one (trapezoid), with the normal
  /// part of it exact where the response stays.
  [[nodiscard]] double energy_after(double depth, const NormalResponse& before, double factor, const TickMotion& motion,
                                    const Trial& trial) const {
    const double work = -0.5 * (dot(state_.applied.force, motion.before) + factor * dot(trial.force, motion.after));
    const double deepened = depth - state_.counted_depth;
    const double mean = 0.5 * (trial.response.normal_force + before.normal_force);
    return state_.energy.energy() + work + factor * (trial.response.work - before.work - mean * deepened);
  }

  [[nodiscard]] Tick report(const Pose& tool, const Trial& trial) const {
    const ContactPlace& place = state_.place;
    const bool friction = response_.law().has_friction();
    Tick tick;
    tick.state = !friction || trial.friction.slides ? State::slide : State::stick;
    tick.force = state_.applied.force;
    const Vec3 arm = tool.rotate(state_.applied.point);
    tick.torque = cross(arm, tick.force);
    tick.depth = state_.indentation;
    tick.counted_depth = state_.counted_depth;
    tick.friction_limit =
        friction ? state_.factor * trial.response.friction_coefficient * trial.response.normal_force : HUGE_VAL;
    tick.filled_share = response_.filled_share();
    tick.extrapolated = state_.indentation > response_.depth_limit() * (1 + 1e-5);
    tick.normal = place.normal;
    tick.body_point = place.body_point.point;
    tick.tool_point = tool.translation + arm;
    tick.at = place.body_point.at;
    tick.on_tool = place.tool_point;
    return tick;
  }

  ContactState state_;
  bool keeps_to_wall_ = false;
  FreeTool free_;
  const View* view_;
  std::uint32_t tool_;
  ToolShape<kFeatures> shape_;
  BlendedResponse<kFeatures> response_;
  FrictionLayers layers_;
  ClosestPointTracker<kFeatures> foot_tracker_;
};

using Contact = BasicContact<>;

namespace detail {
template <std::uint32_t kFeatures, std::size_t... K>
std::array<typename BasicContact<kFeatures>::Memory, sizeof...(K)> memories(
    const std::array<BasicContact<kFeatures>, sizeof...(K)>& contacts, std::index_sequence<K...> /*k*/) {
  return {contacts[K].memory()...};
}
}  // namespace detail

/// Memories of several contacts, for solves that tick all of them several times from one state.
template <std::uint32_t kFeatures, std::size_t kCount>
std::array<typename BasicContact<kFeatures>::Memory, kCount> memories(
    const std::array<BasicContact<kFeatures>, kCount>& contacts) {
  return detail::memories<kFeatures>(contacts, std::make_index_sequence<kCount>());
}
template <std::uint32_t kFeatures, std::size_t kCount>
void restore(std::array<BasicContact<kFeatures>, kCount>& contacts,
             const std::array<typename BasicContact<kFeatures>::Memory, kCount>& memories) {
  for (std::size_t k = 0; k < kCount; ++k) contacts[k].restore(memories[k]);
}

}  // namespace palpate::runtime
