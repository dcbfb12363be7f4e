// SPDX-License-Identifier: MIT
// A tool that holds on to the body: its contact neither slides nor lets go, and answers pulls as well as pushes.
#pragma once

#include "palpate/contact.hpp"
#include "palpate/grasp_law.hpp"

#include <cmath>

namespace palpate::runtime {

/// The grasps of the responses at a body point and a tool point, blended once. Fixed size, no allocation.
class GraspField {
public:
  GraspField() = default;
  /// `tool` is an index into the file's tools; `tool_point.patch` one of that tool's patches.
  GraspField(const View& view, std::uint32_t tool, const BodyPoint& body_point, const ToolPoint& tool_point) {
    if (view.grasps == nullptr) return;
    const layout::Meta& m = *view.meta;
    normal_ = runtime::normal(view, body_point);
    basis_x_ = any_orthogonal(normal_);
    basis_y_ = cross(normal_, basis_x_);
    law_.clear(static_cast<int>(view.grasp_coefs), m.depth_scale);
    double sites[3], weight[3];
    std::uint32_t corner[3];
    patch_weights(view, body_point, sites);
    const int corners = tool_corners(view, tool, tool_point, corner, weight);
    const layout::Patch& patch = view.patches[view.triangles[body_point.triangle].patch];
    for (int k = 0; k < 3; ++k) {
      if (!(sites[k] > 0)) continue;
      const Vec3 x = carried_tangent(view.sites[patch.vertex[k]], normal_, basis_x_);
      for (int l = 0; l < corners; ++l) {
        const std::uint64_t index = layout::response_index(m, patch.vertex[k], corner[l]);
        const layout::GraspHead& head = view.grasp_head(index);
        const double share = sites[k] * weight[l];
        depth_ += share * head.depth;
        pulled_ += share * head.pulled;
        deepest_ += share * view.response_head(index).depth_limit;
        law_.add(view.grasp_curves(index), share, dot(x, basis_x_), dot(x, basis_y_));
      }
    }
  }

  [[nodiscard]] const Vec3& normal() const { return normal_; }
  /// Depth at which the contact was bonded (m); 0: this tool does not hold on, or the file has no grasps.
  [[nodiscard]] double depth() const { return depth_; }

  /// Force of a deflection p - c (m, body frame), at depths of either sign; only where depth() > 0.
  [[nodiscard]] FieldForce force(const Vec3& deflection) const {
    const double z = -dot(deflection, normal_);
    const grasp::Triple f = law_.force({dot(deflection, basis_x_), dot(deflection, basis_y_), z});
    FieldForce result;
    result.depth = z;
    result.normal = f.n;
    result.limit = HUGE_VAL;
    // Limits are stored as floats: a move to just the sampled depth must not count as beyond it.
    result.beyond = z > deepest_ * (1 + 1e-5) || z < -pulled_ * (1 + 1e-5);
    result.tangential = f.x * basis_x_ + f.y * basis_y_;
    result.force = f.n * normal_ + result.tangential;
    return result;
  }

  /// Sets a deflection that answers with this force (body frame); false where none does.
  [[nodiscard]] bool find(const Vec3& force, Vec3& deflection) const {
    grasp::Triple d{};
    if (!law_.find({dot(force, basis_x_), dot(force, basis_y_), dot(force, normal_)}, d)) return false;
    deflection = d.x * basis_x_ + d.y * basis_y_ - d.n * normal_;
    return true;
  }

private:
  Vec3 normal_, basis_x_, basis_y_;
  double depth_ = 0, pulled_ = 0, deepest_ = 0;  ///< m
  grasp::Law law_;
};

/// Takes a contact over as it stands, with the force that it has, and keeps c and p. It is conservative: a closed
/// motion does no work. Every tick takes bounded time, allocates nothing and throws nothing.
class Grasp {
public:
  /// From the last tick of a contact of this tool, and its pose. holds() says whether there is a grasp: the file must
  /// have one for this tool, the tick a contact, and the grasp a deflection that answers with the contact's force.
  Grasp(const View& view, std::uint32_t tool, const Pose& pose, const Tick& tick) {
    const bool touching = tick.state == State::stick || tick.state == State::slide;
    if (tool >= view.meta->tool_count || !touching || !pose.valid()) return;
    field_ = GraspField(view, tool, tick.at, tick.on_tool);
    Vec3 deflection;
    if (!(field_.depth() > 0) || !field_.find(tick.force, deflection)) return;
    at_ = tick;
    const Vec3 away = tick.tool_point - pose.translation;
    const double* r = pose.rotation;
    point_ = {dot({r[0], r[3], r[6]}, away), dot({r[1], r[4], r[7]}, away), dot({r[2], r[5], r[8]}, away)};
    offset_ = deflection - (tick.tool_point - tick.body_point);
    holds_ = true;
  }

  [[nodiscard]] bool holds() const { return holds_; }

  /// Force at `pose`: state stick, with a depth that is negative while the tool pulls. A pose that is no pose ends the
  /// grasp (state fault). Where there is none: state free, no force.
  Tick tick(const Pose& pose) {
    Tick tick;
    if (!pose.valid()) {
      holds_ = false;
      tick.state = State::fault;
    }
    if (!holds_) return tick;
    tick = at_;
    tick.state = State::stick;
    tick.tool_point = pose.apply(point_);
    const FieldForce answer = field_.force(tick.tool_point - tick.body_point + offset_);
    tick.force = answer.force;
    tick.torque = cross(tick.tool_point - pose.translation, tick.force);
    tick.depth = answer.depth;
    tick.friction_limit = answer.limit;
    tick.beyond = answer.beyond;
    return tick;
  }

private:
  GraspField field_;
  Tick at_;      ///< where it was grasped
  Vec3 point_;   ///< m, p in the tool's frame
  Vec3 offset_;  ///< m, added to p - c: the force goes on from the contact's
  bool holds_ = false;
};

}  // namespace palpate::runtime
