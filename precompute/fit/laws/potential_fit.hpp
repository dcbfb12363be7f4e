// SPDX-License-Identifier: GPL-3.0-or-later
// The coefficients of the quadratic potential of one pair: least squares under the inequalities that make it passive.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "formats/journal/samples.hpp"
#include "palpate/response/response_law.hpp"

namespace palpate::fit {

/// Properties that all responses of a file share.
struct ResponseScales {
  double depth = 0.0;       ///< Z, m, > 0
  double tangential = 0.0;  ///< X, m; 0 in a frictionless scene
  response::Degrees degrees;
  int bits = 16;  ///< of a coefficient in the file, those of mu excepted: 8, 12 or 16

  [[nodiscard]] bool friction() const noexcept { return tangential > 0; }
};

/// Fits normal and tangential samples and passes over the others. A sample counts by 1 / max(|force|, 2 % of the peak),
/// and less where its error estimate is large. The coefficients are in N (those of mu as they are), in the file's order,
/// and meet response::broken_rule. Throws Error(numerical) naming `what` on samples that are too few or not finite, and
/// when the fit does not converge.
Eigen::VectorXd fit_potential(const std::vector<Sample>& samples, const ResponseScales& scales,
                              const std::string& what);

/// The quadratic potential with such coefficients, as the runtime evaluates it.
class Potential {
public:
  Potential(const Eigen::VectorXd& coefs, const ResponseScales& scales);

  /// Force (x, y, n; N) at a tangential deflection and a depth (m). Zero at depths that are not positive.
  [[nodiscard]] Eigen::Vector3d force(const Eigen::Vector2d& tangential, double depth) const;
  [[nodiscard]] Eigen::Vector3d force(const Eigen::Vector3d& deflection) const {
    return force(Eigen::Vector2d(deflection.head<2>()), deflection.z());
  }
  /// mu at a depth > 0 (m). 0 in a frictionless scene.
  [[nodiscard]] double friction(double depth) const;
  /// The tangential deflection (m) that remains of `tangential` after a deepening without tangential motion.
  [[nodiscard]] Eigen::Vector2d deepened(double from, double to, const Eigen::Vector2d& tangential) const;

private:
  runtime::ResponseLaw law_;
};

/// Coefficients as the file has them: integers, those of forces times `unit` N, those of mu times
/// layout::kFrictionUnit.
struct Quantised {
  float unit = 0.0f;
  std::vector<std::int16_t> coefs;
};

/// The nearest integers that keep the inequalities, of `bits` (8, 12 or 16) each, those of mu of 16. Throws
/// Error(numerical) where a mu is above 10.
Quantised quantise(const Eigen::VectorXd& coefs, const response::Degrees& degrees, int bits, const std::string& what);

/// The values of the quantised coefficients.
Eigen::VectorXd rounded(const Eigen::VectorXd& coefs, const response::Degrees& degrees, int bits,
                        const std::string& what);

}  // namespace palpate::fit
