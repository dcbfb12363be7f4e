// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/solve/contact/friction.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::solve {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

// Mean of the limit over its value at the end, of points that pass the rim of the contact during a step. They pass it
// anywhere on their way, and the pressure rises with the root of the distance from the rim: 4/5 of the way that counts
// from its middle.
constexpr double kRim = 0.8;

}  // namespace

double FrictionEnergy::limit(const ContactPoint& point) const {
  return -coefficient_ * contact_.penalty() * point.weight * point.distance.value;
}

const FrictionEnergy::Anchor* FrictionEnergy::anchor(std::size_t index) const {
  const auto at = std::lower_bound(anchors_.begin(), anchors_.end(), index,
                                   [](const Anchor& a, std::size_t wanted) { return a.index < wanted; });
  return at != anchors_.end() && at->index == index ? &*at : nullptr;
}

// Halfway: gaps say little of where a point met the tool, since they grow much faster than the penalty's overlap.
Vector3d FrictionEnergy::landing(const ContactPoint& point) const {
  return 0.5 * (point.at + start_pose_.inverse() * contact_.position(point.nodes, point.shape, start_));
}

void FrictionEnergy::set_anchors(std::vector<Anchor> anchors) {
  anchors_ = std::move(anchors);
  points_.clear();
}

void FrictionEnergy::begin(const VectorXd& x) {
  start_ = x;
  start_pose_ = contact_.pose();
  std::vector<Anchor> now;
  points_.clear();
  for (const ContactPoint& p : contact_.touching(x)) {
    const Anchor* old = anchor(p.index);
    now.push_back({p.index, old != nullptr ? old->position : p.at, limit(p)});
    points_.push_back({p.index, p.nodes, p.shape, now.back().position, p.distance.normal(), stiffness_ * p.weight,
                       now.back().limit, now.back().limit});
  }
  anchors_ = std::move(now);
  begun_ = points_;
}

FrictionEnergy::Mismatch FrictionEnergy::mismatch(const VectorXd& x) const {
  double without = 0, with = 0, scale = 0;
  const auto add = [&](double difference) {
    without += std::abs(difference);
    with += difference;
  };
  auto held = points_.begin();
  for (const ContactPoint& p : contact_.touching(x)) {
    for (; held != points_.end() && held->index < p.index; ++held) add(held->limit);
    const bool known = held != points_.end() && held->index == p.index;
    add((known ? (held++)->limit : 0.0) - limit(p));
    scale += limit(p);
  }
  for (; held != points_.end(); ++held) add(held->limit);
  if (!(scale > 0)) return without > 0 ? Mismatch{1.0, 1.0} : Mismatch{};
  return {without / scale, std::abs(with) / scale};
}

void FrictionEnergy::hold(const VectorXd& x, double share) {
  std::vector<Point> next;
  auto held = points_.begin();
  const auto fade = [&](std::size_t below) {  // points that no longer touch
    for (; held != points_.end() && held->index < below; ++held) {
      if (share >= 1) continue;
      next.push_back(*held);
      next.back().limit *= 1 - share;
    }
  };
  for (const ContactPoint& p : contact_.touching(x)) {
    fade(p.index);
    const double last = held != points_.end() && held->index == p.index ? (held++)->limit : 0.0;
    const Anchor* old = anchor(p.index);
    next.push_back({p.index, p.nodes, p.shape, old != nullptr ? old->position : landing(p), p.distance.normal(),
                    stiffness_ * p.weight, last + share * (limit(p) - last), old != nullptr ? old->limit : 0.0});
  }
  fade(std::numeric_limits<std::size_t>::max());
  points_ = std::move(next);
}

// By a point that left halfway since the start: the traction fell from the limit to nothing.
double FrictionEnergy::lost_by(const Point& point, const VectorXd& x) const {
  const Vector3d from = start_pose_.inverse() * contact_.position(point.nodes, point.shape, start_);
  const Vector3d to = contact_.pose().inverse() * contact_.position(point.nodes, point.shape, x);
  Vector3d slip = 0.5 * (from + to) - point.anchor;
  slip -= slip.dot(point.normal) * point.normal;
  return kRim * point.limit * std::max(slip.norm() - point.limit / point.stiffness, 0.0);
}

double FrictionEnergy::settle(const VectorXd& x) {
  double dissipated = 0;
  auto held = points_.begin();
  for (const Point& p : begun_) {
    while (held != points_.end() && held->index < p.index) ++held;
    if (held == points_.end() || held->index != p.index) dissipated += lost_by(p, x);
  }
  std::vector<Anchor> next;
  const Eigen::Isometry3d to_tool = contact_.pose().inverse();
  for (Point& p : points_) {
    const Vector3d at = to_tool * contact_.position(p.nodes, p.shape, x), s = slip(p, x);
    const double elastic = p.limit / p.stiffness, length = s.norm();
    if (length > elastic) {
      // The traction went along the limit, from the one before the step to that at its end.
      const double mean = p.before > 0 ? 0.5 * (p.before + p.limit) : kRim * p.limit;
      dissipated += mean * (length - elastic);
      p.anchor = at - elastic / length * s;
    }
    if (contact_.shape().distance(at).value < 0) next.push_back({p.index, p.anchor, p.limit});
  }
  anchors_ = std::move(next);
  return dissipated;
}

Vector3d FrictionEnergy::slip(const Point& point, const VectorXd& x) const {
  const Vector3d from = contact_.pose().linear().transpose() *
                            (contact_.position(point.nodes, point.shape, x) - contact_.pose().translation()) -
                        point.anchor;
  return from - from.dot(point.normal) * point.normal;
}

double FrictionEnergy::value(const VectorXd& x) const {
  double sum = 0;
  for (const Point& p : points_) {
    const double length = slip(p, x).norm(), force = p.stiffness * length;
    sum += force <= p.limit ? 0.5 * force * length : p.limit * (length - 0.5 * p.limit / p.stiffness);
  }
  return sum;
}

double FrictionEnergy::gradient(const VectorXd& x, VectorXd& gradient) const {
  double sum = 0;
  for (const Point& p : points_) {
    const Vector3d s = slip(p, x);
    const double length = s.norm(), force = p.stiffness * length;
    const bool sticks = force <= p.limit;
    sum += sticks ? 0.5 * force * length : p.limit * (length - 0.5 * p.limit / p.stiffness);
    const Vector3d pull = contact_.pose().linear() * ((sticks ? p.stiffness : p.limit / length) * s);
    for (int n = 0; n < 6; ++n) gradient.segment<3>(3 * p.nodes[n]) += p.shape[n] * pull;
  }
  return sum;
}

void FrictionEnergy::hessian(const VectorXd& x, fem::HessianKind, fem::BlockMatrix& matrix) const {
  const Matrix3d& turn = contact_.pose().linear();
  for (const Point& p : points_) {
    const Vector3d s = slip(p, x);
    const double length = s.norm();
    Matrix3d h = Matrix3d::Identity() - p.normal * p.normal.transpose();
    if (p.stiffness * length <= p.limit) {
      h *= p.stiffness;
    } else {
      h = p.limit / length * (h - s * s.transpose() / (length * length));
    }
    const Matrix3d world = turn * h * turn.transpose();
    for (int a = 0; a < 6; ++a) {
      for (int b = 0; b <= a; ++b) matrix.add(p.nodes[a], p.nodes[b], p.shape[a] * p.shape[b] * world);
    }
  }
}

FrictionReport FrictionEnergy::report(const VectorXd& x) const {
  FrictionReport r;
  double slipping = 0;
  for (const Point& p : points_) {
    const Vector3d s = slip(p, x);
    const double length = s.norm(), force = std::min(p.stiffness * length, p.limit);
    if (length > 0) r.force += contact_.pose().linear() * (force / length * s);
    r.stored += 0.5 * force * force / p.stiffness;
    r.limit += p.limit;
    r.traction += force;
    // A point that was returned to the limit is at it up to rounding.
    if (p.stiffness * length >= p.limit * (1 - 1e-9)) slipping += p.limit;
  }
  r.slipping = r.limit > 0 ? slipping / r.limit : 0.0;
  for (const ContactPoint& p : contact_.touching(x)) r.pressure -= contact_.penalty() * p.weight * p.distance.value;
  return r;
}

Vector3d FrictionEnergy::moment(const VectorXd& x, const Vector3d& about) const {
  Vector3d sum = Vector3d::Zero();
  for (const Point& p : points_) {
    const Vector3d s = slip(p, x), arm = contact_.position(p.nodes, p.shape, x) - about;
    const double length = s.norm(), force = std::min(p.stiffness * length, p.limit);
    if (length > 0) sum += arm.cross(contact_.pose().linear() * (force / length * s));
  }
  for (const ContactPoint& p : contact_.touching(x)) {
    const Vector3d arm = contact_.pose() * p.at - about;
    sum +=
        arm.cross(contact_.pose().linear() * (contact_.penalty() * p.weight * p.distance.value * p.distance.gradient));
  }
  return sum;
}

}  // namespace palpate::solve
