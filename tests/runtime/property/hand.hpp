// SPDX-License-Identifier: GPL-3.0-or-later
// Random motions of a hand over a body: presses, grazes, corners, turns and leaps, the same with every library.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/runtime/property/property.hpp"

namespace palpate::test::property {

using runtime::BodyPoint;
using runtime::Pose;
using runtime::Vec3;
using runtime::View;

/// Random numbers from the bits of one engine: the same with every library.
class Random {
public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_()) / 4294967296.0);
  }
  std::uint32_t below(std::uint32_t count) { return static_cast<std::uint32_t>(engine_()) % count; }
  bool one_in(std::uint32_t count) { return below(count) == 0; }
  Vec3 direction() {
    for (;;) {
      const Vec3 v{between(-1, 1), between(-1, 1), between(-1, 1)};
      const double size = length(v);
      if (size > 0.1 && size < 1) return (1 / size) * v;
    }
  }

private:
  std::mt19937 engine_;
};

inline Pose rotation_of(const Vec3& turn) {
  const double angle = length(turn), share = angle > 1e-12 ? std::sin(angle / 2) / angle : 0.5;
  return Pose::from_quaternion(std::cos(angle / 2), share * turn.x, share * turn.y, share * turn.z, {});
}

/// Rotation vector of a small turn from one pose to another (exact to its third power), body frame.
inline Vec3 turn_between(const Pose& from, const Pose& to) {
  const Pose r = Pose{{to.rotation[0], to.rotation[1], to.rotation[2], to.rotation[3], to.rotation[4], to.rotation[5],
                       to.rotation[6], to.rotation[7], to.rotation[8]},
                      {}} *
                 inverse(from);
  const double* m = r.rotation;
  return 0.5 * Vec3{m[7] - m[5], m[2] - m[6], m[3] - m[1]};
}

inline BodyPoint sharpest_of(const View& view, Random& random) {
  BodyPoint best;
  double least = 2;
  for (int i = 0; i < 40; ++i) {
    BodyPoint at{random.below(view.meta->triangle_count), {0, 0, 0}};
    const int corner = static_cast<int>(random.below(3));
    const Vec3 a = runtime::face_normal(view, at.triangle),
               b = runtime::face_normal(view, view.triangle(at.triangle).neighbour[corner]);
    const double cosine = dot(a, b) / std::max(1e-300, length(a) * length(b));
    if (cosine >= least) continue;
    least = cosine;
    const double share = random.one_in(2) ? random.between(0, 1) : 0.01;
    at.bary[(corner + 1) % 3] = share;
    at.bary[(corner + 2) % 3] = 1 - share;
    best = at;
  }
  return best;
}

inline BodyPoint anywhere(const View& view, Random& random) {
  double a = random.between(0, 1), b = random.between(0, 1);
  if (a + b > 1) {
    a = 1 - a;
    b = 1 - b;
  }
  return {random.below(view.meta->triangle_count), {a, b, 1 - a - b}};
}

/// A hand that visits places of the body, each from outside and back out, along straight legs.
class Hand {
public:
  Hand(const View& view, const PropertyCase& c) : view_(view), case_(c), random_(c.seed) {
    const layout::ToolRecord& tool = view.tools[c.tool];
    reach_ = runtime::ToolShape<>(view, c.tool).extent();
    probe_ = tool.probe_radius;
    profile_ = tool.kind == static_cast<std::uint32_t>(layout::ToolKind::profile);
    mesh_ = tool.kind == static_cast<std::uint32_t>(layout::ToolKind::mesh) && view.tool_vertices != nullptr;
    visit();
  }

  Pose next() {
    if (case_.motion == Motion::fast && random_.one_in(400)) {
      pose_.translation = pose_.translation + (random_.between(0, 10) * scale()) * random_.direction();
    }
    if (left_ == 0) leg();
    --left_;
    pose_.translation = pose_.translation + step_;
    if (length(turn_) > 0) {
      Pose turned = rotation_of(turn_);
      turned =
          turned * Pose{{pose_.rotation[0], pose_.rotation[1], pose_.rotation[2], pose_.rotation[3], pose_.rotation[4],
                         pose_.rotation[5], pose_.rotation[6], pose_.rotation[7], pose_.rotation[8]},
                        {}};
      for (int k = 0; k < 9; ++k) pose_.rotation[k] = turned.rotation[k];
    }
    return pose_;
  }

private:
  [[nodiscard]] double scale() const { return view_.meta->depth_scale; }

  // A new place: the tool at any turn, with one of its points above the place.
  void visit() {
    const BodyPoint at = case_.motion == Motion::corner ? sharpest_of(view_, random_) : anywhere(view_, random_);
    normal_ = runtime::smooth_normal(view_, at);
    pose_ = rotation_of(random_.between(0, 3.1) * random_.direction());
    const layout::ToolRecord& tool = view_.tools[case_.tool];
    Vec3 feeler;
    if (profile_ && !random_.one_in(2)) {
      // The stem along the surface, nearly.
      feeler = {0, 0, random_.between(0, 1) * tool.axis_length};
      const Vec3 along = unit(tangential(random_.direction(), normal_) + random_.between(-0.3, 0.3) * normal_, normal_);
      const Vec3 half = unit(along + Vec3{0, 0, 1}, {1, 0, 0});
      pose_ = Pose::from_quaternion(0, half.x, half.y, half.z, {});
    } else if (mesh_) {
      const auto& v = view_.tool_vertices[tool.first_vertex + random_.below(tool.vertex_count)];
      feeler = runtime::to_vec(v.point);
      const Vec3 half = unit(unit(runtime::to_vec(v.normal), {0, 0, -1}) - normal_, {1, 0, 0});
      pose_ = Pose::from_quaternion(0, half.x, half.y, half.z, {});
    } else if (profile_) {
      const Vec3 half = unit(Vec3{0, 0, 1} + unit(normal_ + 0.7 * random_.direction(), normal_), {1, 0, 0});
      pose_ = Pose::from_quaternion(0, half.x, half.y, half.z, {});
    }
    pose_.translation = position(view_, at) + (probe_ + 0.05 * scale()) * normal_ - pose_.rotate(feeler);
    depth_ = -0.05 * scale();
    legs_ = 2 + static_cast<int>(random_.below(6));
    left_ = 1;  // one tick at the start
    step_ = turn_ = {};
  }

  void leg() {
    if (legs_-- == 0) {  // out, along the normal
      move((std::max(depth_, 0.0) + 0.1 * scale()) * normal_);
      depth_ = -0.1 * scale();
      return;
    }
    if (legs_ < -1) return visit();
    if (random_.one_in(8)) {  // back along the last leg, exactly
      step_ = -step_;
      turn_ = -turn_;
      left_ = taken_;
      depth_ += dot(step_, normal_) * -static_cast<double>(left_);
      return;
    }
    const double deepest = case_.motion == Motion::graze ? 0.02 : random_.one_in(4) ? 1.1 : 0.6;
    const double to = random_.one_in(6) ? -0.02 * scale() : random_.between(0, deepest) * scale();
    const double aside = random_.one_in(3) ? 0 : random_.one_in(4) ? 4 : 0.5;
    const bool keeps = random_.one_in(3) && depth_ > 0;
    const double in = keeps ? 0 : to - depth_;
    move(random_.between(0, aside) * scale() * tangential(random_.direction(), normal_) - in * normal_);
    depth_ += in;
  }

  void move(const Vec3& way) {
    const double fine = case_.motion == Motion::fast    ? random_.between(0.02, 1) * scale()
                        : case_.motion == Motion::graze ? 2e-4 * scale()
                                                        : 1e-3 * scale();
    const bool turns = case_.motion == Motion::turn || (case_.motion == Motion::fast && random_.one_in(3));
    const Vec3 turn = turns ? random_.between(0, 0.3) * random_.direction() : Vec3{};
    const double size = length(way) + reach_ * length(turn);
    left_ = taken_ = 1 + static_cast<std::uint32_t>(size / (case_.fine * fine));
    step_ = (1.0 / left_) * way;
    turn_ = (1.0 / left_) * turn;
  }

  const View& view_;
  PropertyCase case_;
  Random random_;
  double reach_ = 0, probe_ = 0;
  bool profile_ = false, mesh_ = false;
  Pose pose_;
  Vec3 normal_, step_, turn_;
  double depth_ = 0;
  int legs_ = 0;
  std::uint32_t left_ = 0, taken_ = 1;
};

}  // namespace palpate::test::property
