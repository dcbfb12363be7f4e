// SPDX-License-Identifier: MIT
// Displacement of the body's surface at one contact by the force of another.
#pragma once

#include "palpate/format/half_space.hpp"
#include "palpate/geometry/surface.hpp"
#include "palpate/math/pose.hpp"

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

/// A point of the surface with its part of the compliance, blended from its three sites once a move.
struct CompliancePoint {
  half_space::Point place;
  double modes[3 * layout::kMaxModes];  ///< sqrt(m/N): x, y, z of each mode
};

/// The compliance of a body between two points of its surface, by the file's COMPLIANCE. It is linear about the
/// equilibrium from which contact starts. It has no state.
class Compliance {
public:
  /// `view`: a file with layout::feature_compliance, which must outlive this.
  explicit Compliance(const View& view) : view_(&view) {}

  /// Writes the point's part. 3 modes multiply-adds for each of its three sites.
  void locate(const BodyPoint& at, CompliancePoint& point) const {
    double weights[3];
    site_weights(*view_, at, weights);
    const Vec3 c = position(*view_, at), n = smooth_normal(*view_, at, weights);
    point.place = {{c.x, c.y, c.z}, {n.x, n.y, n.z}, 0};
    const std::uint32_t count = 3 * view_->compliance->modes;
    for (std::uint32_t k = 0; k < count; ++k) point.modes[k] = 0;
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t site = view_->triangle(at.triangle).site[i];
      const layout::ComplianceSite& record = view_->compliance_site(site);
      point.place.shear += weights[i] * static_cast<double>(record.shear);
      const double unit = weights[i] * static_cast<double>(record.unit);
      const std::int16_t* const values = view_->compliance_modes(site);
      for (std::uint32_t k = 0; k < count; ++k) point.modes[k] += unit * values[k];
    }
  }

  /// C (m/N, body frame): a force f at `from` moves the surface at `to` by C f.
  [[nodiscard]] Matrix3 between(const CompliancePoint& from, const CompliancePoint& to) const {
    double c[9];
    half_space::compliance(from.place, to.place, view_->compliance->poisson, view_->compliance->rounding, c);
    add_modes(from, to, c);
    return matrix(c);
  }
  /// The part of it that the half-space gives.
  [[nodiscard]] Matrix3 of_half_space(const CompliancePoint& from, const CompliancePoint& to) const {
    double c[9];
    half_space::compliance(from.place, to.place, view_->compliance->poisson, view_->compliance->rounding, c);
    return matrix(c);
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
    double c[9];
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) c[3 * i + j] = scale * ((i == j ? 2 - nu : 0) - nu * n[i] * n[j]);
    }
    add_modes(at, at, c);
    return matrix(c);
  }

private:
  static Matrix3 matrix(const double (&c)[9]) { return {{{c[0], c[1], c[2]}, {c[3], c[4], c[5]}, {c[6], c[7], c[8]}}}; }
  void add_modes(const CompliancePoint& from, const CompliancePoint& to, double (&c)[9]) const {
    const std::uint32_t count = view_->compliance->modes, positive = count - view_->compliance->negative;
    add(0, positive, 1, from, to, c);
    add(positive, count, -1, from, to, c);
  }
  static void add(std::uint32_t begin, std::uint32_t end, double sign, const CompliancePoint& from,
                  const CompliancePoint& to, double (&c)[9]) {
    for (std::uint32_t m = begin; m < end; ++m) {
      const double* const f = from.modes + 3 * m;
      const double* const t = to.modes + 3 * m;
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) c[3 * i + j] += sign * t[i] * f[j];
      }
    }
  }

  const View* view_;
};

}  // namespace palpate::runtime
