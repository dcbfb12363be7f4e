// SPDX-License-Identifier: GPL-3.0-or-later
// Signed distance to a convex polygon in the (r, z) half plane, turned about the axis and grown by a radius.
#include "precompute/tool/taper.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace palpate::tool {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

class Taper final : public ToolShape {
public:
  Taper(double tip, double half_angle, double shaft, double length) : tip_(tip) {
    const double wide = std::min(shaft - tip, length * std::tan(half_angle));
    corners_ = {Vector2d(0, 0), Vector2d(wide, wide / std::tan(half_angle)), Vector2d(wide, length),
                Vector2d(0, length)};
  }

  [[nodiscard]] DistanceSample distance(const Vector3d& p) const override {
    const double r = std::hypot(p.x(), p.y());
    const Vector3d er = r > 1e-12 * tip_ ? Vector3d(p.x() / r, p.y() / r, 0) : Vector3d::UnitX();
    const Vector3d ez = Vector3d::UnitZ(), hoop = ez.cross(er);
    const Vector2d at(r, p.z());

    // Inside a convex polygon the signed distance is the largest one to the lines of its sides.
    double inside = -std::numeric_limits<double>::infinity(), outside = std::numeric_limits<double>::infinity();
    Vector2d normal = Vector2d::Zero(), away = Vector2d::Zero();
    bool at_corner = false;
    for (int k = 0; k < 3; ++k) {
      const Vector2d side = corners_[k + 1] - corners_[k];
      const double length = side.norm();
      if (!(length > 0)) continue;
      const Vector2d out(side.y() / length, -side.x() / length);
      const double beyond = (at - corners_[k]).dot(out);
      if (beyond > inside) {
        inside = beyond;
        normal = out;
      }
      const double along = std::clamp((at - corners_[k]).dot(side) / (length * length), 0.0, 1.0);
      const Vector2d from = at - (corners_[k] + along * side);
      if (from.norm() < outside) {
        outside = from.norm();
        away = from;
        at_corner = along <= 0 || along >= 1;
      }
    }
    DistanceSample s;
    if (inside > 0 && outside > 1e-12 * tip_) {
      normal = away / outside;
      s.value = outside - tip_;
      if (at_corner) {
        const Vector3d across = normal.y() * er - normal.x() * ez;
        s.hessian = across * across.transpose() / outside;
      }
    } else {
      s.value = inside - tip_;
    }
    s.gradient = normal.x() * er + normal.y() * ez;
    if (r > 1e-12 * tip_) {
      s.hessian += (normal.x() / r) * hoop * hoop.transpose();
    } else if (at_corner && inside > 0) {
      s.hessian += hoop * hoop.transpose() / outside;  // on the axis before the tip: a ball's
    }
    return s;
  }

  [[nodiscard]] Eigen::AlignedBox3d bounds() const override {
    const double wide = corners_[1].x() + tip_;
    return {Vector3d(-wide, -wide, -tip_), Vector3d(wide, wide, corners_[2].y() + tip_)};
  }

private:
  double tip_;
  std::array<Vector2d, 4> corners_;
};

}  // namespace

std::shared_ptr<const ToolShape> make_taper(double tip, double half_angle, double shaft, double length) {
  return std::make_shared<Taper>(tip, half_angle, shaft, length);
}

}  // namespace palpate::tool
