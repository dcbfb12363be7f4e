// SPDX-License-Identifier: GPL-3.0-or-later
// A plate on the spring of a handle, pressed on a half-space at 40 places with friction: 120 rows.
#pragma once

#include "palpate/format/half_space.hpp"
#include "palpate/mechanism/rows.hpp"

#include <array>
#include <cmath>
#include <cstddef>

namespace palpate::cli {

/// The places lie in eight columns of five, `spacing` apart; the plate is a paraboloid with 8 / m of curvature.
struct Plate {
  static constexpr int kPlaces = 40, kRows = 3 * kPlaces;
  using Rows = runtime::Rows<kRows>;
  using Values = std::array<double, kRows>;

  double young = 5e3;  ///< Pa, of the half-space
  double poisson = 0.49;
  double spring = 500;      ///< N/m; per radian a thousandth of it
  double spacing = 3.5e-3;  ///< m; 0: all rows at one place
  double radius = 1.7e-3;   ///< m, of the patch of each place
  double friction = 0.3;

  [[nodiscard]] std::array<double, 2> place(int k) const { return {spacing * (k % 8 - 3.5), spacing * (k / 8 - 2)}; }

  /// Fills empty rows; null, or why they cannot be solved.
  [[nodiscard]] const char* fill(Rows& rows) const {
    for (int k = 0; k < kPlaces; ++k) rows.add_contact(friction);
    for (int i = 0; i < kPlaces; ++i) {
      for (int j = 0; j <= i; ++j) {
        double c[3][3];
        block(i, j, c);
        for (int r = 0; r < 3; ++r) {
          for (int s = 0; s < (i == j ? r + 1 : 3); ++s) rows.add_compliance(3 * i + r, 3 * j + s, c[r][s]);
        }
      }
    }
    return rows.prepare();
  }

  /// m, gaps without forces: the plate is `depth` into the half-space, tilted by 0.05 about y, and `aside` along x.
  [[nodiscard]] Values gaps(double depth, double aside) const {
    Values gap{};
    for (int k = 0; k < kPlaces; ++k) {
      const auto [x, y] = place(k);
      const auto row = static_cast<std::size_t>(3 * k);
      gap[row] = -depth + 0.05 * x + 8 * (x * x + y * y);
      gap[row + 1] = -aside;
    }
    return gap;
  }

  /// The forces of these gaps to 1e-12, from others.
  [[nodiscard]] static Values converged(Rows& rows, const Values& gaps, Values force = {}) {
    constexpr int kSweeps = 64, kRounds = 2000;
    for (int round = 0; round < kRounds; ++round) {
      if (rows.solve(gaps.data(), force.data(), kSweeps).error <= 1e-12) break;
    }
    return force;
  }

  /// N: along the normal, along x, along y.
  [[nodiscard]] static std::array<double, 3> force(const Values& rows) {
    std::array<double, 3> sum{};
    for (std::size_t k = 0; k < rows.size(); ++k) sum[k % 3] += rows[k];
    return sum;
  }
  /// |a - b| over |b|, of the plate's forces.
  [[nodiscard]] static double difference(const Values& a, const Values& b) {
    const auto x = force(a), y = force(b);
    return std::hypot(x[0] - y[0], x[1] - y[1], x[2] - y[2]) / std::hypot(y[0], y[1], y[2]);
  }

private:
  /// Rows n, x, y of a place by forces at another.
  void block(int i, int j, double (&c)[3][3]) const {
    const auto [xi, yi] = place(i);
    const auto [xj, yj] = place(j);
    const double shear = young / (2 * (1 + poisson)), dx = xi - xj, dy = yi - yj, apart = std::hypot(dx, dy);
    const double size = apart > 0 ? apart : 3 * M_PI * radius / 16, scale = 1 / (4 * M_PI * shear * size);
    const double tx = apart > 0 ? dx / apart : std::sqrt(0.5), ty = apart > 0 ? dy / apart : std::sqrt(0.5);
    const double normal = 2 * (1 - poisson) * scale, along = 2 * poisson * scale;
    const double cross = apart > 0 ? along * tx * ty : 0;  // the mean over a disc has none
    const double lever = 1e3 / spring;
    c[0][0] = normal + 1 / spring + lever * (xi * xj + yi * yj);
    c[1][1] = normal + along * tx * tx + 1 / spring;
    c[2][2] = normal + along * ty * ty + 1 / spring;
    c[1][2] = c[2][1] = cross;
    c[0][1] = c[1][0] = c[0][2] = c[2][0] = 0;
  }
};

}  // namespace palpate::cli
