// SPDX-License-Identifier: MIT
// A tool that holds on to the body: its contact neither slides nor lets go, and answers pulls as well as pushes.
#pragma once

#include "palpate/field.hpp"
#include "palpate/grasp_law.hpp"

#include <cmath>

namespace palpate::runtime {

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
    if (view.bonded == nullptr) return;
    normal_ = runtime::normal(view, body_point);
    basis_x_ = any_orthogonal(normal_);
    basis_y_ = runtime::cross(normal_, basis_x_);
    law_.clear(static_cast<int>(view.meta->bonded_coefs), view.meta->depth_scale);
    for_each_share(view, tool, body_point, tool_point, spin, normal_, basis_x_, basis_y_,
                   [&](std::uint64_t index, double share, double cosine, double sine) {
                     const layout::BondedHead& head = view.bonded_head(index);
                     depth_ += share * head.depth;
                     pulled_ += share * head.pulled;
                     deepest_ += share * view.response_head(index).depth_limit;
                     law_.add(view.bonded_curves(index), share, cosine, sine);
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

}  // namespace palpate::runtime
