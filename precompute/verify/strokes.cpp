// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/verify/strokes.hpp"

#include "precompute/solve/push/coulomb_push.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::verify {
namespace {

using Eigen::Vector3d;

constexpr int kPress = 8;       // stations of a way in from free to the full depth, evenly in its root
constexpr double kFree = 0.02;  // of the depth: above the surface, before and after
constexpr double kShear = 0.2;  // of the reach to gross slip, from station to station while the contact shears
constexpr double kSlide = 0.2;  // contact radii, while it slides

// Builds the stations: `along` and `across` the main way (m), `depth` (m).
class Pen {
public:
  explicit Pen(const StrokeScale& scale) : scale_(scale) {
    stroke_.friction = scale.friction;
    put({0, 0, -kFree * scale.depth});
  }

  // Straight to a place, in steps of at most `step` (m).
  Pen& go(double along, double across, double depth, double step) {
    const Vector3d from = at_, to(along, across, depth);
    const int count = std::max(1, static_cast<int>(std::ceil((to - from).norm() / step - 1e-9)));
    for (int k = 1; k <= count; ++k) put(from + (to - from) * k / count);
    return *this;
  }

  // Between here and a place in or out of contact, closer together near the surface, where forces grow like depth^1.5.
  Pen& press(double along, double across, double depth) {
    const Vector3d from = at_, to(along, across, depth);
    const double low = std::sqrt(std::max(from.z(), 0.0)), high = std::sqrt(std::max(depth, 0.0));
    const int count =
        std::max(1, static_cast<int>(std::ceil(kPress * std::abs(high - low) / std::sqrt(scale_.depth) - 1e-9)));
    for (int k = 1; k <= count; ++k) {
      const double root = low + (high - low) * k / count;
      const double share = k == count ? 1.0 : (root * root - from.z()) / (to.z() - from.z());
      put(from + share * (to - from));
    }
    return *this;
  }

  // Out, straight along the normal.
  solve::StrokePath lift() {
    press(at_.x(), at_.y(), -kFree * scale_.depth);
    return stroke_;
  }

private:
  void put(const Vector3d& at) {
    at_ = at;
    const double c = std::cos(scale_.angle), s = std::sin(scale_.angle);
    stroke_.stations.emplace_back(c * at.x() - s * at.y(), s * at.x() + c * at.y(), -at.z());
  }

  const StrokeScale& scale_;
  Vector3d at_{0, 0, 0};
  solve::StrokePath stroke_;
};

}  // namespace

std::vector<NamedStroke> standard_strokes(const StrokeScale& scale) {
  const double d = scale.depth, a = scale.contact_radius;
  const double reach = solve::gross_slip_reach(scale.friction, scale.poisson) * d;  // along a half-space
  const double shear = kShear * reach, slide = kSlide * a;
  std::vector<NamedStroke> all;
  all.push_back({"press", Pen(scale)
                              .press(0, 0, d)
                              .go(1.6 * reach, 0, d, shear)
                              .go(2.5 * a, 0, d, slide)
                              .go(2.5 * a - 3 * reach, 0, d, shear)
                              .go(0.5 * a, 0, d, slide)
                              .lift()});
  all.push_back({"deepen", Pen(scale)
                               .press(0, 0, 0.4 * d)
                               .go(0.2 * reach, 0, 0.4 * d, 0.5 * shear)
                               .press(0.2 * reach, 0, d)
                               .go(0.2 * reach, 0.5 * reach, d, shear)
                               .press(0.2 * reach, 0.5 * reach, 0.5 * d)
                               .go(2 * a, 0.5 * reach, 0.5 * d, slide)
                               .press(2 * a, 0.5 * reach, d)
                               .go(2 * a, 0.5 * reach - 0.5 * a, d, shear)
                               .lift()});
  all.push_back({"oblique", Pen(scale)
                                .press(d, 0, d)
                                .go(d - 0.4 * reach, 0, d, shear)
                                .press(d - 0.4 * reach, 0, 0.6 * d)
                                .press(d - 0.4 * reach, 0, d)
                                .go(d - 0.4 * reach, 2 * reach, d, shear)
                                .press(d - 0.4 * reach, 2 * reach + 1.5 * d, 0)
                                .lift()});
  all.push_back(
      {"graze", Pen(scale).press(0.5 * a, 0, 0.5 * d).press(1.5 * a, 0, d).press(2.5 * a, 0, 0.3 * d).lift()});
  return all;
}

}  // namespace palpate::verify
