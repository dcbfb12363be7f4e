// SPDX-License-Identifier: GPL-3.0-or-later
// Marching triangles over the clean surface, split where it is coarse, with the ends of each piece found by bisection.
#include "precompute/surface/support_rim.hpp"

#include "precompute/surface/pieces.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace palpate::surface {
namespace {

using Eigen::Vector3d;

struct Corner {
  Vector3d at;
  bool held;
};

class Rim {
public:
  explicit Rim(const Body& body) : body_(body) {}

  void add(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    const std::array<Corner, 3> corners{Corner{a, body_.held(a)}, Corner{b, body_.held(b)}, Corner{c, body_.held(c)}};
    const int count = corners[0].held + corners[1].held + corners[2].held;
    area_ += (b - a).cross(c - a).norm() / 2 * count / 3;
    if (count == 0 || count == 3) return;
    Vector3d ends[2];
    int found = 0;
    for (std::size_t e = 0; e < 3; ++e) {
      const Corner &from = corners[e], &to = corners[(e + 1) % 3];
      if (from.held != to.held) ends[found++] = crossing(from, to);
    }
    length_ += (ends[1] - ends[0]).norm();
    points_.push_back((ends[0] + ends[1]) / 2);
  }

  [[nodiscard]] SupportRim result() const {
    SupportRim rim;
    if (points_.empty()) return rim;
    rim.size = std::clamp(length_ > 0 ? area_ / (2 * length_) : 0.0, body_.diagonal / 64, body_.diagonal / 8);
    std::set<std::array<long, 3>> taken;
    for (const Vector3d& p : points_) {
      const std::array<long, 3> cell{std::lround(p.x() / rim.size), std::lround(p.y() / rim.size),
                                     std::lround(p.z() / rim.size)};
      if (taken.insert(cell).second) rim.points.push_back(p);
    }
    return rim;
  }

private:
  [[nodiscard]] Vector3d crossing(const Corner& from, const Corner& to) const {
    Vector3d a = from.at, b = to.at;
    for (int k = 0; k < 8; ++k) {
      const Vector3d middle = (a + b) / 2;
      (body_.held(middle) == from.held ? a : b) = middle;
    }
    return (a + b) / 2;
  }

  const Body& body_;
  double area_ = 0.0, length_ = 0.0;
  std::vector<Vector3d> points_;
};

}  // namespace

SupportRim support_rim(const Body& body) {
  const Surface& surface = body.query->surface();
  Rim rim(body);
  for (const auto& t : surface.triangles) {
    for_each_piece(surface.vertices[t[0]], surface.vertices[t[1]], surface.vertices[t[2]], body.diagonal / 32,
                   [&](const Vector3d& a, const Vector3d& b, const Vector3d& c) { rim.add(a, b, c); });
  }
  return rim.result();
}

}  // namespace palpate::surface
