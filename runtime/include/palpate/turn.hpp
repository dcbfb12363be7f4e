// SPDX-License-Identifier: MIT
// A tool that holds on and whose turns have a torque: twist about the normal, rolling about the tangents.
#pragma once

#include "palpate/grasp.hpp"
#include "palpate/turn_law.hpp"

#include <cmath>

namespace palpate::runtime {

/// Rotation vector (rad, of length at most pi) of a rotation matrix, by way of its quaternion's largest component
/// (Shepperd 1978); at pi one of the two.
inline Vec3 rotation_vector(const double (&r)[9]) {
  const double squares[4] = {1 + r[0] + r[4] + r[8], 1 + r[0] - r[4] - r[8], 1 - r[0] + r[4] - r[8],
                             1 - r[0] - r[4] + r[8]};
  int most = 0;
  for (int k = 1; k < 4; ++k) most = squares[k] > squares[most] ? k : most;
  const double differences[3] = {r[7] - r[5], r[2] - r[6], r[3] - r[1]};
  const double sums[3] = {r[5] + r[7], r[2] + r[6], r[1] + r[3]};  // yz, xz, xy
  double w = squares[0];
  Vec3 v{differences[0], differences[1], differences[2]};
  if (most > 0) w = differences[most - 1];
  if (most == 1) v = {squares[1], sums[2], sums[1]};
  if (most == 2) v = {sums[2], squares[2], sums[0]};
  if (most == 3) v = {sums[1], sums[0], squares[3]};
  const double sine = length(v);
  if (!(sine > 0)) return {};
  const double angle = 2 * std::atan2(sine, std::fabs(w));
  return (std::copysign(angle, w) / sine) * v;
}

/// The responses of a grasp and of its turns at a body point and a tool point, blended once. Fixed size, no allocation.
class TurnField {
public:
  /// Where a turn counts from.
  class Rest {
  public:
    /// `rotation`: the vector that a tool at `pose` has (rad, body frame).
    void set(const Pose& pose, const Vec3& rotation) {
      const double angle = length(rotation);
      const Vec3 axis = angle > 0 ? (std::sin(angle / 2) / angle) * rotation : Vec3{};
      const Pose offset = Pose::from_quaternion(std::cos(angle / 2), axis.x, axis.y, axis.z, {});
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          back_[3 * i + j] = 0;
          for (int k = 0; k < 3; ++k) back_[3 * i + j] += pose.rotation[3 * k + i] * offset.rotation[3 * k + j];
        }
      }
    }
    /// Of a tool at `pose` (rad, body frame).
    [[nodiscard]] Vec3 rotation(const Pose& pose) const {
      double turned[9] = {};
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          for (int k = 0; k < 3; ++k) turned[3 * i + j] += pose.rotation[3 * i + k] * back_[3 * k + j];
        }
      }
      return rotation_vector(turned);
    }

  private:
    double back_[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< the rotation at rest transposed, times that of the offset
  };

  TurnField() = default;
  /// `tool` is an index into the file's tools; `tool_point.patch` one of that tool's patches.
  TurnField(const View& view, std::uint32_t tool, const BodyPoint& body_point, const ToolPoint& tool_point,
            const Spin& spin = {})
      : grasp_(view, tool, body_point, tool_point, spin) {
    if (view.bonded_torque == nullptr || !(grasp_.depth() > 0)) return;
    law_.clear(static_cast<int>(view.meta->bonded_coefs), view.meta->depth_scale);
    for_each_share(view, tool, body_point, tool_point, spin, grasp_.normal(), grasp_.basis_x(), grasp_.basis_y(),
                   [&](std::uint64_t index, double share, double cosine, double sine) {
                     turned_ += share * view.torque_head(index).rotated;
                     law_.add(view.torque_curves(index), share, cosine, sine);
                   });
  }

  /// Depth at which the contact was bonded (m); 0: this tool does not hold on, or the file has no grasps.
  [[nodiscard]] double depth() const { return grasp_.depth(); }
  /// Angle (rad) up to which it was turned; 0: turns of this tool have no torque, or the file has none.
  [[nodiscard]] double turned() const { return turned_; }

  /// Of a deflection p - c (m) and a rotation vector of at most pi (rad), body frame; only where depth() > 0.
  [[nodiscard]] GraspAnswer answer(const Vec3& deflection, const Vec3& rotation) const {
    if (!(turned_ > 0)) return grasp_.answer(deflection, rotation);
    const grasp::Triple d = grasp_.local(deflection);
    const grasp::Wrench w = law_.answer(grasp_.law(), d, grasp_.components(rotation));
    GraspAnswer result{grasp_.field_force(w.force, d.n), grasp_.world(w.torque)};
    result.force.beyond = result.force.beyond || length(rotation) > turned_ * (1 + 1e-5);
    return result;
  }

  /// Sets a deflection and a rotation that answer with this force (body frame) and without torque, as the contact's is
  /// about p; false where none do.
  [[nodiscard]] bool find(const Vec3& force, Vec3& deflection, Vec3& rotation) const {
    if (!(turned_ > 0)) return grasp_.find(force, deflection);
    grasp::Triple d{}, theta{};
    if (!law_.find(grasp_.law(), grasp_.components(force), d, theta)) return false;
    deflection = grasp_.world({d.x, d.y, -d.n});
    rotation = grasp_.world(theta);
    return true;
  }

private:
  GraspField grasp_;
  double turned_ = 0;  ///< rad
  grasp::TurnLaw law_;
};

}  // namespace palpate::runtime
