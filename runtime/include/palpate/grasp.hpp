// SPDX-License-Identifier: MIT
// A tool that holds on to the body: its contact neither slides nor lets go, and answers pulls as well as pushes.
#pragma once

#include "palpate/contact.hpp"
#include "palpate/grasp_law.hpp"

#include <cmath>

namespace palpate::runtime {

/// Calls use(response, share, cosine, sine) for every response of a tool at a body point and a tool point, with its
/// share of the blend and the angle of its x axis from the basis' one, counted about the normal.
template <class Use>
void for_each_share(const View& view, std::uint32_t tool, const BodyPoint& body_point, const ToolPoint& tool_point,
                    const Spin& spin, const Vec3& normal, const Vec3& basis_x, const Vec3& basis_y, const Use& use) {
  double sites[3];
  patch_weights(view, body_point, sites);
  const ToolCorners corners = tool_corners(view, tool, tool_point);
  const auto& site = view.triangles[body_point.triangle].site;
  Across axis[3];
  for (int k = 0; k < 3; ++k) axis[k] = carried_axis(view.sites[site[k]], normal, basis_x, basis_y);
  SpinStep step;
  const SpunSites spun(view, view.tools[tool], spin, normal, basis_x, basis_y, axis, step);
  for (int l = 0; l < corners.count; ++l) {
    spun.for_each(corners.vertex[l], [&](int k, std::uint32_t sample, double share, const Across& x) {
      const double all = sites[k] * corners.weight[l] * share;
      if (all > 0) use(layout::response_index(*view.meta, site[k], corners.vertex[l]) + sample, all, x.cosine, x.sine);
    });
  }
}

/// What a grasp answers.
struct GraspAnswer {
  FieldForce force;
  Vec3 torque;  ///< N m on the tool about p, body frame
};

/// The grasps of the responses at a body point and a tool point, blended once. Fixed size, no allocation.
class GraspField {
public:
  /// Where a turn counts from: there are none.
  struct Rest {
    void set(const Pose& /*pose*/, const Vec3& /*rotation*/) {}
    [[nodiscard]] Vec3 rotation(const Pose& /*pose*/) const { return {}; }
  };

  GraspField() = default;
  /// `tool` is an index into the file's tools; `tool_point.patch` one of that tool's patches.
  GraspField(const View& view, std::uint32_t tool, const BodyPoint& body_point, const ToolPoint& tool_point,
             const Spin& spin = {}) {
    if (view.grasps == nullptr) return;
    normal_ = runtime::normal(view, body_point);
    basis_x_ = any_orthogonal(normal_);
    basis_y_ = runtime::cross(normal_, basis_x_);
    law_.clear(static_cast<int>(view.meta->grasp_coefs), view.meta->depth_scale);
    for_each_share(view, tool, body_point, tool_point, spin, normal_, basis_x_, basis_y_,
                   [&](std::uint64_t index, double share, double cosine, double sine) {
                     const layout::GraspHead& head = view.grasp_head(index);
                     depth_ += share * head.depth;
                     pulled_ += share * head.pulled;
                     deepest_ += share * view.response_head(index).depth_limit;
                     law_.add(view.grasp_curves(index), share, cosine, sine);
                   });
  }

  [[nodiscard]] const Vec3& normal() const { return normal_; }
  [[nodiscard]] const Vec3& basis_x() const { return basis_x_; }
  [[nodiscard]] const Vec3& basis_y() const { return basis_y_; }
  [[nodiscard]] const grasp::Law& law() const { return law_; }
  /// Depth at which the contact was bonded (m); 0: this tool does not hold on, or the file has no grasps.
  [[nodiscard]] double depth() const { return depth_; }

  /// Force of a deflection p - c (m, body frame), at depths of either sign; only where depth() > 0.
  [[nodiscard]] FieldForce force(const Vec3& deflection) const {
    const grasp::Triple d = local(deflection);
    return field_force(law_.force(d), d.n);
  }
  /// The same; a turn has no torque.
  [[nodiscard]] GraspAnswer answer(const Vec3& deflection, const Vec3& /*rotation*/) const {
    return {force(deflection), {}};
  }

  /// Sets a deflection that answers with this force (body frame); false where none does.
  [[nodiscard]] bool find(const Vec3& force, Vec3& deflection) const {
    grasp::Triple d{};
    if (!law_.find(components(force), d)) return false;
    deflection = world({d.x, d.y, -d.n});
    return true;
  }
  [[nodiscard]] bool find(const Vec3& force, Vec3& deflection, Vec3& /*rotation*/) const {
    return find(force, deflection);
  }

  /// (x, y, n) of a vector of the body frame, and back; and of a deflection, whose n is the depth.
  [[nodiscard]] grasp::Triple components(const Vec3& v) const {
    return {dot(v, basis_x_), dot(v, basis_y_), dot(v, normal_)};
  }
  [[nodiscard]] Vec3 world(const grasp::Triple& t) const { return t.x * basis_x_ + t.y * basis_y_ + t.n * normal_; }
  [[nodiscard]] grasp::Triple local(const Vec3& deflection) const {
    grasp::Triple d = components(deflection);
    d.n = -d.n;
    return d;
  }

  /// Of a force in components, at a depth (m).
  [[nodiscard]] FieldForce field_force(const grasp::Triple& f, double z) const {
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

private:
  Vec3 normal_, basis_x_, basis_y_;
  double depth_ = 0, pulled_ = 0, deepest_ = 0;  ///< m
  grasp::Law law_;
};

/// Takes a contact over as it stands, with the force that it has, and keeps c and p. It is conservative: a closed
/// motion does no work. Every tick takes bounded time, allocates nothing and throws nothing. As Grasp its torque is the
/// force's alone; TurningGrasp (turn.hpp) has that of turns, too.
template <class Answer>
class BasicGrasp {
public:
  /// From the last tick of a contact of this tool, and its pose, both in the body's frame, as those of a Contact are. A
  /// MovingContact tells its ticks in the world, where nothing could notice it: of one the grasp is of
  /// seen_from(body, tool) and carried(inverse(body), tick), and its own ticks are carried(body,
  /// grasp.tick(seen_from(body, tool))). holds() says whether there is a grasp: the file must
  /// have one for this tool, the tick a contact, and the grasp a deflection that answers with the contact's force.
  BasicGrasp(const View& view, std::uint32_t tool, const Pose& pose, const Tick& tick) {
    const bool touching = tick.touches();
    if (tool >= view.meta->tool_count || !touching || !pose.valid()) return;
    field_ = Answer(view, tool, tick.at, tick.on_tool, {&pose, 0});
    Vec3 deflection, rotation;
    if (!(field_.depth() > 0) || !field_.find(tick.force, deflection, rotation)) return;
    at_ = tick;
    const Vec3 away = tick.tool_point - pose.translation;
    const double* r = pose.rotation;
    point_ = {dot({r[0], r[3], r[6]}, away), dot({r[1], r[4], r[7]}, away), dot({r[2], r[5], r[8]}, away)};
    offset_ = deflection - (tick.tool_point - tick.body_point);
    rest_.set(pose, rotation);
    holds_ = true;
  }

  [[nodiscard]] bool holds() const { return holds_; }

  /// Force and torque at `pose`: state stick, with a depth that is negative while the tool pulls. A pose that is no
  /// pose ends the grasp (state fault). Where there is none: state free, no force.
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
    const GraspAnswer answer = field_.answer(tick.tool_point - tick.body_point + offset_, rest_.rotation(pose));
    tick.force = answer.force.force;
    tick.torque = cross(tick.tool_point - pose.translation, tick.force) + answer.torque;
    tick.depth = answer.force.depth;
    tick.friction_limit = answer.force.limit;
    tick.beyond = answer.force.beyond;
    return tick;
  }

private:
  Answer field_;
  Tick at_;      ///< where it was grasped
  Vec3 point_;   ///< m, p in the tool's frame
  Vec3 offset_;  ///< m, added to p - c: the force goes on from the contact's
  typename Answer::Rest rest_;
  bool holds_ = false;
};

using Grasp = BasicGrasp<GraspField>;

}  // namespace palpate::runtime
