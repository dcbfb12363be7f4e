// SPDX-License-Identifier: GPL-3.0-or-later
// Closed forms of contact mechanics, sampled as a bake samples its solves.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "formats/journal/samples.hpp"
#include "formats/scene/scene_sources.hpp"
#include "precompute/solve/pair/pair.hpp"

namespace palpate::fit {

/// A rigid tool on a body that is flat beside the contact, at small strain. Contact radius a at depth d:
/// hertz: F = 4/3 E* sqrt(R) d^1.5, a = sqrt(R d) (Hertz 1882); punch: F = 2 E* a d; cone of half angle theta:
/// F = 2/pi E* tan(theta) d^2, a = 2/pi tan(theta) d (Sneddon 1965; sharp: a tool's rounded tip is neglected); layer,
/// incompressible and bonded to a rigid base: F = 16/9 E sqrt(R) d^1.5 (1 + 1.133 x + 1.283 x^2 + 0.769 x^3 + 0.0975
/// x^4), x = sqrt(R d) / thickness (Dimitriadis et al. 2002); winkler, a bed of springs: stiffness times the volume
/// that the tool displaces, pi R d^2 under a sphere, pi a^2 d under a punch; spring: stiffness d. A contact that sticks
/// has the tangential stiffness 8 G a / (2 - nu) (Mindlin 1949), the bed that of its area times `tangential`, the
/// spring `tangential`.
struct ClosedForm {
  AnalyticScene::Law law = AnalyticScene::Law::hertz;
  double young = 0.0, poisson = 0.0;  ///< Pa
  double radius = 0.0;                ///< m, of the sphere or of the flat face
  bool flat = false;
  double slope = 0.0;      ///< tan(theta)
  double thickness = 0.0;  ///< m
  double stiffness = 0.0, tangential = 0.0;

  [[nodiscard]] double push(double depth) const;                ///< N
  [[nodiscard]] double tangential_stiffness(double depth) const;  ///< N/m; 0 for layer, which has no closed form
};

/// The samples that a bake along `path` would have of a contact with this force (N) at a deflection (m): normal
/// indentations and, with friction, tangential ones.
std::vector<Sample> sample_along(const solve::PairPath& path,
                                 const std::function<Eigen::Vector3d(const Eigen::Vector3d& deflection)>& force);

/// The same of a law.
std::vector<Sample> sample_law(const ClosedForm& law, const solve::PairPath& path);

}  // namespace palpate::fit
