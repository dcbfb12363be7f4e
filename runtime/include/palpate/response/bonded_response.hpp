// SPDX-License-Identifier: MIT
// The bonded responses at a contact (c, p), carried to c and blended into one law.
#pragma once

#include "palpate/response/bonded_torque_law.hpp"
#include "palpate/response/orientation.hpp"

namespace palpate::runtime {

/// Force and torque about p of a bonded contact.
struct BondedWrench {
  Vec3 force;   ///< N on the tool, body frame
  Vec3 torque;  ///< N m on the tool about p, body frame
};

/// Fixed size, no allocation.
class BondedResponse {
public:
  /// Blends the bonded responses of a tool at a point c of the body and a point p of the tool. `pose`: of the tool, for
  /// tools with several spins; null: their first spins.
  void blend(const View& view, std::uint32_t tool, const BodyPoint& c, const ToolPoint& p, const Pose* pose) {
    depth_ = pulled_ = deepest_ = rotated_ = 0;
    if (view.bonded == nullptr) return;
    double weights[3];
    site_weights(view, c, weights);
    normal_ = smooth_normal(view, c, weights);
    x_ = any_orthogonal(normal_);
    y_ = cross(normal_, x_);
    const int count = static_cast<int>(view.meta->bonded_coefs);
    law_.clear(count, view.meta->depth_scale);
    torque_.clear(count, view.meta->depth_scale);
    for_each_share<layout::feature_all>(
        view, tool, c, p, pose, *this, weights, [&](std::uint64_t index, double share, const Vec2& axis) {
          const layout::BondedHead& head = view.bonded_head(index);
          depth_ += share * static_cast<double>(head.depth);
          pulled_ += share * static_cast<double>(head.pulled);
          deepest_ += share * static_cast<double>(view.response_head(index).depth_limit);
          law_.add(view.bonded_curves(index), share, axis.x, axis.y);
          if (view.bonded_torque == nullptr) return;
          rotated_ += share * static_cast<double>(view.torque_head(index).rotated);
          torque_.add(view.torque_curves(index), share, axis.x, axis.y);
        });
  }

  [[nodiscard]] const Vec3& normal() const { return normal_; }
  [[nodiscard]] const Vec3& basis_x() const { return x_; }
  [[nodiscard]] const Vec3& basis_y() const { return y_; }
  /// Depth at which the contact was bonded (m). 0: the tool does not bond.
  [[nodiscard]] double depth() const { return depth_; }
  /// Largest angle by which the tool was rotated (rad). 0: its rotations have no torque.
  [[nodiscard]] double rotated() const { return rotated_; }

  /// Force and torque of a deflection p - c (m) and a rotation vector since the bond (rad, at most pi), body frame.
  /// Requires depth() > 0.
  [[nodiscard]] BondedWrench wrench(const Vec3& deflection, const Vec3& rotation) const {
    bonded::Triple d = components(deflection);
    d.n = -d.n;
    if (!(rotated_ > 0)) return {world(law_.force(d)), {}};
    const bonded::Wrench w = torque_.answer(law_, d, components(rotation));
    return {world(w.force), world(w.torque)};
  }

  /// True where a deflection and a rotation are farther than the responses were sampled.
  [[nodiscard]] bool beyond(const Vec3& deflection, const Vec3& rotation) const {
    constexpr double kSlack = 1 + 1e-5;  // limits are stored as floats
    const double z = -dot(deflection, normal_);
    return z > deepest_ * kSlack || z < -pulled_ * kSlack || (rotated_ > 0 && length(rotation) > rotated_ * kSlack);
  }

  /// Finds a deflection and a rotation with this force (N, body frame) and without torque. False where there are none.
  [[nodiscard]] bool find(const Vec3& force, Vec3& deflection, Vec3& rotation) const {
    bonded::Triple d{}, theta{};
    const bool found = rotated_ > 0 ? torque_.find(law_, components(force), d, theta) : law_.find(components(force), d);
    if (!found) return false;
    deflection = world({d.x, d.y, -d.n});
    rotation = world(theta);
    return true;
  }

private:
  [[nodiscard]] bonded::Triple components(const Vec3& v) const { return {dot(v, x_), dot(v, y_), dot(v, normal_)}; }
  [[nodiscard]] Vec3 world(const bonded::Triple& t) const { return t.x * x_ + t.y * y_ + t.n * normal_; }

  Vec3 normal_, x_, y_;
  double depth_ = 0, pulled_ = 0, deepest_ = 0;  ///< m
  double rotated_ = 0;                           ///< rad
  bonded::Law law_;
  bonded::TorqueLaw torque_;
};

}  // namespace palpate::runtime
