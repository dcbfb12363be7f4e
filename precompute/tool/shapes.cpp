// SPDX-License-Identifier: GPL-3.0-or-later
// Closed-form signed distances with gradient and Hessian.
#include "precompute/tool/shapes.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::tool {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

// Distance to a point, less a radius; the direction at the point itself is arbitrary but fixed.
DistanceSample round_point(const Vector3d& from_centre, double radius) {
  DistanceSample s;
  const double r = from_centre.norm();
  s.value = r - radius;
  if (r > 1e-12 * radius) {
    s.gradient = from_centre / r;
    s.hessian = (Matrix3d::Identity() - s.gradient * s.gradient.transpose()) / r;
  }
  return s;
}

// Without a root; what is lost in rounding goes to "false".
bool beyond(double squared_distance, double radius) {
  return radius > 0 && squared_distance > radius * radius * (1 + 1e-12);
}

class Sphere final : public ToolShape {
public:
  explicit Sphere(double radius) : radius_(radius) {}
  [[nodiscard]] DistanceSample distance(const Vector3d& p) const override { return round_point(p, radius_); }
  [[nodiscard]] bool surely_beyond(const Vector3d& p, double gap) const override {
    return beyond(p.squaredNorm(), radius_ + gap);
  }
  [[nodiscard]] AlignedBox3d bounds() const override {
    return {Vector3d::Constant(-radius_), Vector3d::Constant(radius_)};
  }

private:
  double radius_;
};

class Capsule final : public ToolShape {
public:
  Capsule(double radius, double length) : radius_(radius), length_(length) {}

  [[nodiscard]] DistanceSample distance(const Vector3d& p) const override {
    if (p.z() <= 0.0) return round_point(p, radius_);
    if (p.z() >= length_) return round_point(p - Vector3d(0, 0, length_), radius_);
    DistanceSample s = round_point({p.x(), p.y(), 0}, radius_);
    s.hessian.row(2).setZero();
    s.hessian.col(2).setZero();
    return s;
  }
  [[nodiscard]] bool surely_beyond(const Vector3d& p, double gap) const override {
    const double along = p.z() - std::clamp(p.z(), 0.0, length_);
    return beyond(p.head<2>().squaredNorm() + along * along, radius_ + gap);
  }
  [[nodiscard]] AlignedBox3d bounds() const override {
    return {Vector3d::Constant(-radius_), Vector3d(radius_, radius_, length_ + radius_)};
  }

private:
  double radius_, length_;
};

class Punch final : public ToolShape {
public:
  Punch(double radius, double edge, double height) : radius_(radius), edge_(edge), half_(0.5 * height) {}

  // In the (r, z) half plane: a box shrunk by the edge radius, then grown by it.
  [[nodiscard]] DistanceSample distance(const Vector3d& p) const override {
    const double r = std::hypot(p.x(), p.y());
    const double side = p.z() < half_ ? -1.0 : 1.0;
    const double qr = r - (radius_ - edge_), qz = std::abs(p.z() - half_) - (half_ - edge_);
    const Vector3d er = r > 1e-12 * radius_ ? Vector3d(p.x() / r, p.y() / r, 0) : Vector3d::UnitX();
    const Vector3d ez(0, 0, side), hoop = Vector3d::UnitZ().cross(er);
    DistanceSample s;
    if (qr > 0 && qz > 0) {
      const double q = std::hypot(qr, qz), ur = qr / q, uz = qz / q;
      const Vector3d across = uz * er - ur * ez;
      s = {q - edge_, ur * er + uz * ez, across * across.transpose() / q};
      if (r > 1e-12 * radius_) s.hessian += (ur / r) * hoop * hoop.transpose();
    } else if (qr > qz) {
      s = {qr - edge_, er, Matrix3d::Zero()};
      if (r > 1e-12 * radius_) s.hessian = hoop * hoop.transpose() / r;
    } else {
      s = {qz - edge_, ez, Matrix3d::Zero()};
    }
    return s;
  }
  [[nodiscard]] AlignedBox3d bounds() const override {
    return {Vector3d(-radius_, -radius_, 0), Vector3d(radius_, radius_, 2 * half_)};
  }

private:
  double radius_, edge_, half_;
};

}  // namespace

std::shared_ptr<const ToolShape> make_sphere(double radius) { return std::make_shared<Sphere>(radius); }
std::shared_ptr<const ToolShape> make_capsule(double radius, double length) {
  return std::make_shared<Capsule>(radius, length);
}
std::shared_ptr<const ToolShape> make_punch(double radius, double edge_radius, double height) {
  return std::make_shared<Punch>(radius, edge_radius, height);
}

}  // namespace palpate::tool
