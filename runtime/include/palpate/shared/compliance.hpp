// SPDX-License-Identifier: MIT
// Displacement of the body's surface at one contact by the force of another.
#pragma once

#include "palpate/format/half_space.hpp"
#include "palpate/geometry/surface.hpp"
#include "palpate/math/pose.hpp"

#include <cstddef>
#include <cstdint>

namespace palpate::runtime {

/// A 3x3 matrix by its rows.
struct Matrix3 {
  Vec3 row[3];

  [[nodiscard]] Vec3 operator*(const Vec3& v) const { return {dot(row[0], v), dot(row[1], v), dot(row[2], v)}; }
};

inline Matrix3 transposed(const Matrix3& m) {
  return {{{m.row[0].x, m.row[1].x, m.row[2].x},
           {m.row[0].y, m.row[1].y, m.row[2].y},
           {m.row[0].z, m.row[1].z, m.row[2].z}}};
}

/// A point of the surface with its part of the compliance, blended from its three sites once a move; x, y and z apart,
/// for sums over the modes by several at once.
struct CompliancePoint {
  half_space::Point place;
  double modes[3][layout::kMaxModes];  ///< sqrt(m/N): x, y, z of each mode
  double loads[3][layout::kMaxModes];  ///< the same with the modes' signs, for a force that acts here
};

/// The part of each mode along the normal at a point of the surface.
struct ComplianceTilt {
  Vec3 slope[2];                      ///< 1/m, over the surface: of the second and the third site's weight
  double rise[2][layout::kMaxModes];  ///< sqrt(m/N), of the second and the third site over the first
  double load[layout::kMaxModes];     ///< sqrt(m/N), with the modes' signs
};

/// The compliance of a body between two points of its surface, by the file's COMPLIANCE. It is linear about the
/// equilibrium from which contact starts. It has no state.
///
/// Tissue under a deep tool is stiffer than at rest, so its dent grows less than its force. The dents are linear in a
/// stretched depth h, whose conjugate force f / h' makes them; d is the depth of a contact and b the file's stiffening:
///
///     h(d) = d + b d^2 / (2 depth scale)
class Compliance {
public:
  /// `view`: a file with layout::feature_compliance, which must outlive this.
  explicit Compliance(const View& view) : view_(&view), bend_(view.compliance->stiffening / view.meta->depth_scale) {}

  /// h'' (1/m).
  [[nodiscard]] double bend() const { return bend_; }
  /// h' at a depth (m).
  [[nodiscard]] double stretch(double depth) const { return 1 + bend_ * depth; }

  /// Writes the point's part, and its part of the tilt where that is not null. Some 3 modes multiply-adds for each of
  /// its three sites.
  void locate(const BodyPoint& at, CompliancePoint& point, ComplianceTilt* tilt = nullptr) const {
    double weights[3];
    site_weights(*view_, at, weights);
    const Vec3 c = position(*view_, at), n = smooth_normal(*view_, at, weights);
    point.place = {{c.x, c.y, c.z}, {n.x, n.y, n.z}, 0};
    const layout::SurfaceTriangle triangle = view_->triangle(at.triangle);
    const std::size_t count = view_->compliance->modes;
    double site[3][3 * layout::kMaxModes];  // sqrt(m/N), of the three sites
    for (int i = 0; i < 3; ++i) {
      const layout::ComplianceSite& record = view_->compliance_site(triangle.site[i]);
      point.place.shear += weights[i] * static_cast<double>(record.shear);
      const std::int16_t* const values = view_->compliance_modes(triangle.site[i]);
      const double unit = static_cast<double>(record.unit);
      for (std::size_t k = 0; k < 3 * count; ++k) site[i][k] = unit * values[k];
    }
    for (std::size_t m = 0; m < count; ++m) {
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t k = 3 * m + i;
        point.modes[i][m] = weights[0] * site[0][k] + weights[1] * site[1][k] + weights[2] * site[2][k];
      }
    }
    const std::size_t positive = count - view_->compliance->negative;
    for (int i = 0; i < 3; ++i) {
      for (std::size_t m = 0; m < positive; ++m) point.loads[i][m] = point.modes[i][m];
      for (std::size_t m = positive; m < count; ++m) point.loads[i][m] = -point.modes[i][m];
    }
    if (tilt == nullptr) return;
    for (std::size_t m = 0; m < count; ++m) {
      tilt->load[m] = n.x * point.loads[0][m] + n.y * point.loads[1][m] + n.z * point.loads[2][m];
    }
    Vec3 slopes[3];
    site_weight_slopes(*view_, at.triangle, slopes);
    double along[3][layout::kMaxModes];  // the sites' parts along n
    for (int i = 0; i < 3; ++i) {
      for (std::size_t m = 0; m < count; ++m) {
        along[i][m] = n.x * site[i][3 * m] + n.y * site[i][3 * m + 1] + n.z * site[i][3 * m + 2];
      }
    }
    for (int i = 0; i < 2; ++i) {
      tilt->slope[i] = slopes[i + 1];
      for (std::size_t m = 0; m < count; ++m) tilt->rise[i][m] = along[i + 1][m] - along[0][m];
    }
  }

  /// C (m/N, body frame): a force f at `from` moves the surface at `to` by C f.
  [[nodiscard]] Matrix3 between(const CompliancePoint& from, const CompliancePoint& to) const {
    return with_modes(of_half_space(from, to), from, to);
  }
  /// The part of it that the half-space gives.
  [[nodiscard]] Matrix3 of_half_space(const CompliancePoint& from, const CompliancePoint& to) const {
    double c[9];
    half_space::compliance(from.place, to.place, view_->compliance->poisson, view_->compliance->rounding, c);
    return {{{c[0], c[1], c[2]}, {c[3], c[4], c[5]}, {c[6], c[7], c[8]}}};
  }
  /// `part` with the part that the modes give.
  [[nodiscard]] Matrix3 with_modes(const Matrix3& part, const CompliancePoint& from, const CompliancePoint& to) const {
    Matrix3 c = part;
    for (int i = 0; i < 3; ++i) {
      const double* const t = to.modes[i];
      c.row[i] = c.row[i] + Vec3{sum(t, from.loads[0]), sum(t, from.loads[1]), sum(t, from.loads[2])};
    }
    return c;
  }
  /// t (1/N, body frame): a force f at `from` tilts the surface at `to`, by the modes, by (f . n) t, which is the
  /// gradient over the surface of its displacement along the normal. Forces across the normal are left out.
  [[nodiscard]] Vec3 tilt(const ComplianceTilt& from, const ComplianceTilt& to) const {
    return sum(to.rise[0], from.load) * to.slope[0] + sum(to.rise[1], from.load) * to.slope[1];
  }
  [[nodiscard]] Matrix3 between(const BodyPoint& from, const BodyPoint& to) const {
    CompliancePoint a, b;
    locate(from, a);
    locate(to, b);
    return between(a, b);
  }

  /// C (m/N) of a place with itself: mean displacement of a disc of `radius` (m) by a unit force spread evenly over it.
  /// The half-space's part is (Johnson 1985, chapter 3)
  ///
  ///     1 / (4 pi G rho) (2 (1 - nu) I + nu (I - n n^T)),      rho = 3 pi radius / 16
  [[nodiscard]] Matrix3 within(const CompliancePoint& at, double radius) const {
    constexpr double kPi = kFullTurn / 2;
    const double nu = view_->compliance->poisson;
    const double scale = 16 / (3 * kPi * radius) / (4 * kPi * at.place.shear);
    const double* const n = at.place.normal;
    Matrix3 c;
    for (int i = 0; i < 3; ++i) {
      const Vec3 unit{i == 0 ? 1.0 : 0.0, i == 1 ? 1.0 : 0.0, i == 2 ? 1.0 : 0.0};
      c.row[i] = scale * ((2 - nu) * unit - (nu * n[i]) * Vec3{n[0], n[1], n[2]});
    }
    return with_modes(c, at, at);
  }

private:
  /// Sum over the modes of the products of two of their parts: eight partial sums, which compilers keep in wide
  /// registers.
  [[nodiscard]] double sum(const double* a, const double* b) const {
    constexpr std::size_t kLanes = layout::kModeStep;
    double lanes[kLanes] = {};
    for (std::size_t m = 0; m < view_->compliance->modes; m += kLanes) {
      for (std::size_t l = 0; l < kLanes; ++l) lanes[l] += a[m + l] * b[m + l];
    }
    return ((lanes[0] + lanes[4]) + (lanes[1] + lanes[5])) + ((lanes[2] + lanes[6]) + (lanes[3] + lanes[7]));
  }

  const View* view_;
  double bend_;
};

}  // namespace palpate::runtime
