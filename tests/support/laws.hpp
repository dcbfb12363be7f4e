// SPDX-License-Identifier: GPL-3.0-or-later
// Every material law with moduli that organs have, as a scene would give them.
#pragma once

#include "formats/scene/scene.hpp"

#include <array>

namespace palpate::test {

using LawChoice = MaterialScene::Law;

inline constexpr std::array kEveryLaw{
    LawChoice::neo_hookean, LawChoice::mooney_rivlin, LawChoice::ogden, LawChoice::veronda_westmann,
    LawChoice::holzapfel,   LawChoice::st_venant,     LawChoice::linear};

/// Shear modulus about 2 kPa; the fibres' direction is askew to the axes.
inline MaterialScene law_scene(LawChoice law, double poisson) {
  MaterialScene s;
  s.law = law;
  s.poisson = poisson;
  s.c10 = 700;
  s.c01 = 300;
  s.terms = {{630, 1.3}, {1.2, 5.0}, {-10, -2.0}};  // Ogden's own three terms for rubber, a thousandth of each
  s.c1 = 300;
  s.beta = 2;
  s.k1 = 2363;
  s.k2 = 0.84;
  s.dispersion = 0.1;
  s.fibre = Eigen::Vector3d(1, 2, -0.5).normalized();
  return s;
}

/// The largest Poisson's ratio near which a law is used here: those for comparison are not for soft tissue.
inline double usual_poisson(LawChoice law) {
  return law == LawChoice::linear || law == LawChoice::st_venant ? 0.3 : 0.49;
}

}  // namespace palpate::test
