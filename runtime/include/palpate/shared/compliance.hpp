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

/// The part of each mode along the normal at a point of the surface.
struct ComplianceTilt {
  double normal[layout::kMaxModes];  ///< sqrt(m/N)
  Vec3 gradient[layout::kMaxModes];  ///< 1/sqrt(N m), over the surface
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

  /// Writes the modes' parts along the normal at a point whose part of the compliance is `point`.
  void locate_tilt(const BodyPoint& at, const CompliancePoint& point, ComplianceTilt& tilt) const {
    const Vec3 n{point.place.normal[0], point.place.normal[1], point.place.normal[2]};
    const std::uint32_t count = view_->compliance->modes;
    Vec3 slopes[3];
    site_weight_slopes(*view_, at.triangle, slopes);
    for (std::uint32_t m = 0; m < count; ++m) {
      tilt.normal[m] = n.x * point.modes[3 * m] + n.y * point.modes[3 * m + 1] + n.z * point.modes[3 * m + 2];
      tilt.gradient[m] = {};
    }
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t site = view_->triangle(at.triangle).site[i];
      const Vec3 slope = static_cast<double>(view_->compliance_site(site).unit) * slopes[i];
      const std::int16_t* const values = view_->compliance_modes(site);
      for (std::uint32_t m = 0; m < count; ++m) {
        const std::int16_t* const v = values + 3 * m;
        tilt.gradient[m] = tilt.gradient[m] + (n.x * v[0] + n.y * v[1] + n.z * v[2]) * slope;
      }
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
    const std::uint32_t count = view_->compliance->modes, positive = count - view_->compliance->negative;
    Matrix3 c = part;
    add(0, positive, 1, from, to, c);
    add(positive, count, -1, from, to, c);
    return c;
  }
  /// t (1/N, body frame): a force f at `from` tilts the surface at `to`, by the modes, by (f . n) t, which is the
  /// gradient over the surface of its displacement along the normal. Forces across the normal are left out.
  [[nodiscard]] Vec3 tilt(const ComplianceTilt& from, const ComplianceTilt& to) const {
    const std::uint32_t count = view_->compliance->modes, positive = count - view_->compliance->negative;
    Vec3 sum;
    for (std::uint32_t m = 0; m < positive; ++m) sum = sum + from.normal[m] * to.gradient[m];
    for (std::uint32_t m = positive; m < count; ++m) sum = sum - from.normal[m] * to.gradient[m];
    return sum;
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
  static void add(std::uint32_t begin, std::uint32_t end, double sign, const CompliancePoint& from,
                  const CompliancePoint& to, Matrix3& c) {
    for (std::uint32_t m = begin; m < end; ++m) {
      const double* const t = to.modes + 3 * m;
      const Vec3 f{from.modes[3 * m], from.modes[3 * m + 1], from.modes[3 * m + 2]};
      for (int i = 0; i < 3; ++i) c.row[i] = c.row[i] + (sign * t[i]) * f;
    }
  }

  const View* view_;
};

}  // namespace palpate::runtime
