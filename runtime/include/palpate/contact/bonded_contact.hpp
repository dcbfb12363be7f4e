// SPDX-License-Identifier: MIT
// A tool that is bonded to the body: the contact neither slips nor separates, and resists pulls as well as pushes.
#pragma once

#include "palpate/contact/tick_frame.hpp"
#include "palpate/math/rotation.hpp"
#include "palpate/response/bonded_law.hpp"
#include "palpate/response/orientation.hpp"

#include <cmath>
#include <type_traits>

namespace palpate::runtime {

/// Force (N) and torque (N m, about p) on the tool in the body's frame.
struct BondedForce {
  Vec3 force, torque;
  double depth = 0;           ///< m, negative while the tool pulls
  bool extrapolated = false;  ///< deeper, farther out or more rotated than the responses were sampled
};

/// Blend of the bonded responses at (c, p). Fixed size. kTorque: rotations of the tool about p have a torque.
template <bool kTorque>
class BondedResponse {
public:
  BondedResponse() = default;
  /// `tool`: an index into the file's tools. `p.patch`: a patch of this tool. `lies`: of the tool at the bond, for
  /// tools that were sampled at several spins.
  BondedResponse(const View& view, std::uint32_t tool, const BodyPoint& c, const ToolPoint& p,
                 const Orientation& lies = {}) {
    if (view.bonded == nullptr) return;
    double weights[3];
    site_weights(view, c, weights);
    normal_ = smooth_normal(view, c, weights);
    x_ = any_orthogonal(normal_);
    y_ = cross(normal_, x_);
    const int count = static_cast<int>(view.meta->bonded_coefs);
    law_.clear(count, view.meta->depth_scale);
    if constexpr (kTorque) torque_law_.clear(count, view.meta->depth_scale);
    const auto use = [&](std::uint64_t index, double share, const Vec2& axis) { add(view, index, share, axis); };
    for_each_share<layout::feature_all>(view, tool, c, p, lies, *this, weights, use);
  }

  [[nodiscard]] const Vec3& normal() const { return normal_; }
  [[nodiscard]] const Vec3& basis_x() const { return x_; }
  [[nodiscard]] const Vec3& basis_y() const { return y_; }
  [[nodiscard]] double depth() const { return depth_; }      ///< m, of the bond; 0: the file has none of this tool
  [[nodiscard]] double rotated() const { return rotated_; }  ///< rad, sampled angle; 0: rotations have no torque

  /// Returns force and torque at a deflection p - c (m) and a rotation vector (rad). Requires depth() > 0.
  [[nodiscard]] BondedForce at(const Vec3& deflection, const Vec3& rotation = {}) const {
    constexpr double kFloat = 1 + 1e-5;  // limits are stored as floats
    const Vec3 d{dot(deflection, x_), dot(deflection, y_), -dot(deflection, normal_)};
    bool extrapolated = d.z > depth_limit_ * kFloat || d.z < -pulled_ * kFloat;
    BondedWrench w{law_.force(d), {}};
    if constexpr (kTorque) {
      if (rotated_ > 0) {
        w = torque_law_.wrench(law_, d, components(rotation));
        extrapolated = extrapolated || length(rotation) > rotated_ * kFloat;
      }
    }
    return {in_body_frame(w.force), in_body_frame(w.torque), d.z, extrapolated};
  }

  /// Sets deflection and rotation at which the force is `force` and the torque zero. Returns false where none exist.
  [[nodiscard]] bool find(const Vec3& force, Vec3& deflection, Vec3& rotation) const {
    Vec3 d, theta;
    bool found = false;
    if constexpr (kTorque) found = rotated_ > 0 && torque_law_.find(law_, components(force), d, theta);
    if (!(rotated_ > 0)) found = law_.find(components(force), d);
    deflection = in_body_frame({d.x, d.y, -d.z});
    rotation = in_body_frame(theta);
    return found;
  }

private:
  void add(const View& view, std::uint64_t index, double share, const Vec2& axis) {
    depth_ += share * view.bonded_head(index).depth;
    pulled_ += share * view.bonded_head(index).pulled;
    depth_limit_ += share * view.response_head(index).depth_limit;
    law_.add(view.bonded_curves(index), share, axis);
    if constexpr (kTorque) {
      if (view.bonded_torque == nullptr) return;
      rotated_ += share * view.torque_head(index).rotated;
      torque_law_.add(view.torque_curves(index), share, axis);
    }
  }
  [[nodiscard]] Vec3 components(const Vec3& v) const { return {dot(v, x_), dot(v, y_), dot(v, normal_)}; }
  [[nodiscard]] Vec3 in_body_frame(const Vec3& v) const { return v.x * x_ + v.y * y_ + v.z * normal_; }

  Vec3 normal_, x_, y_;
  double depth_ = 0, pulled_ = 0, depth_limit_ = 0;  ///< m
  double rotated_ = 0;                               ///< rad
  BondedLaw law_;
  std::conditional_t<kTorque, BondedTorqueLaw, Vec2> torque_law_;  ///< unused without torque
};

/// Takes over a contact with its force, and keeps its c and p. The force is the gradient of one stored energy, so a
/// closed motion does no work.
///
/// A stiffness factor that rises from s to s' adds no energy: deflection and rotation x go on from (s / s') x. The
/// stored energy U is convex from U(0) = 0 to x, for rotations up to 2 rad, so s' U((s / s') x) <= s U(x). A linear
/// force stays as it is. The bond rests nearer to the tool from then on.
///
/// Every tick takes bounded time, allocates nothing and throws nothing.
template <bool kTorque>
class BasicBondedContact {
public:
  /// `pose` and `tick`: of the last tick of a contact of this tool. `body`: of this tick, if it was not at rest.
  /// holds() is false in three cases: the contact does not touch; the file has no bonded responses of the tool; no
  /// deflection has the contact's force.
  BasicBondedContact(const View& view, std::uint32_t tool, const Pose& pose, const Tick& tick)
      : BasicBondedContact(view, tool, pose, tick, StillBody{&view}) {}
  template <class Body>
  BasicBondedContact(const View& view, std::uint32_t tool, const Pose& pose, const Tick& tick, const Body& body) {
    if (!(tool < view.meta->tool_count) || !tick.touches() || !pose.valid() || !body.valid()) return;
    const Pose frame = frame_at(body, tick.at), in = in_body(pose, frame);
    bond_ = transformed(inverse(frame), tick);
    factor_ = body.factor(tick.at);
    response_ = BondedResponse<kTorque>(view, tool, tick.at, tick.on_tool.at, &in);
    Vec3 deflection, rotation;
    if (!(factor_ > 0) || !(response_.depth() > 0)) return;
    if (!response_.find((1 / factor_) * bond_.force, deflection, rotation)) return;
    bond_.state = State::stick;
    bond_.normal = response_.normal();
    bond_.friction_limit = HUGE_VAL;
    point_ = in.unapply(bond_.tool_point);
    hold(in, bond_.tool_point, deflection, rotation);
    holds_ = true;
  }

  [[nodiscard]] bool holds() const { return holds_; }

  /// Returns force and torque at a pose, with the state `stick`. The depth is negative while the tool pulls. An invalid
  /// pose is a fault and ends the bond. Without a bond the state is `free` and the force is zero.
  Tick tick(const Pose& tool) { return tick(tool, StillBody{nullptr}); }
  /// The same against a body that moves, deforms or changes its stiffness; vectors are in the world's frame.
  template <class Body>
  Tick tick(const Pose& tool, const Body& body) {
    Tick tick;
    if (!tool.valid() || !body.valid()) {
      holds_ = false;
      tick.state = State::fault;
      tick.fault = Fault::bad_pose;
    }
    if (!holds_) return tick;
    const double step = body.factor_step(), last = factor_;
    factor_ = std::fmin(std::fmax(body.factor(bond_.at), factor_ - step), factor_ + step);
    const Pose frame = frame_at(body, bond_.at), in = in_body(tool, frame);
    tick = bond_;
    tick.tool_point = in.apply(point_);
    Vec3 deflection = tick.tool_point - bond_.body_point + offset_, rotation = rotation_vector((in * rest_).rotation);
    if (factor_ > last) {
      deflection = (last / factor_) * deflection;
      rotation = (last / factor_) * rotation;
      hold(in, tick.tool_point, deflection, rotation);
    }
    const BondedForce answer = response_.at(deflection, rotation);
    tick.force = factor_ * answer.force;
    tick.torque = cross(tick.tool_point - in.translation, tick.force) + factor_ * answer.torque;
    tick.depth = tick.counted_depth = answer.depth;
    tick.extrapolated = answer.extrapolated;
    return transformed(frame, tick);
  }

private:
  /// Sets where the bond is at rest: the tool at `in`, with p at `at`, has this deflection (m) and rotation (rad).
  void hold(const Pose& in, const Vec3& at, const Vec3& deflection, const Vec3& rotation) {
    offset_ = deflection - (at - bond_.body_point);
    rest_ = inverse(in) * rotation_pose(rotation);
  }

  BondedResponse<kTorque> response_;
  Tick bond_;          ///< at the bond, body frame
  Vec3 point_;         ///< m, p in the tool's frame
  Vec3 offset_;        ///< m, added to p - c; the force at the bond is that of the contact
  Pose rest_;          ///< tool * rest_ has the rotation of the tool since the bond, plus that of hold()
  double factor_ = 1;  ///< stiffness factor of the body
  bool holds_ = false;
};

/// Its torque is that of the force at p. Rotations about p have no torque of their own.
using BondedContact = BasicBondedContact<false>;
/// Rotations about p have a torque, where the file has it.
using BondedContact6D = BasicBondedContact<true>;

}  // namespace palpate::runtime
