// SPDX-License-Identifier: GPL-3.0-or-later
// From a scene's law to energies.
#include "precompute/fem/materials/scene_material.hpp"

#include "precompute/fem/materials/fibre.hpp"
#include "precompute/fem/materials/invariant_law.hpp"
#include "precompute/fem/materials/linear.hpp"
#include "precompute/fem/materials/ogden.hpp"

namespace palpate {

Material make_material(const MaterialScene& s) {
  using Choice = MaterialScene::Law;
  const double mu = s.young / (2 * (1 + s.poisson)), lambda = 2 * mu * s.poisson / (1 - 2 * s.poisson);
  switch (s.law) {
    case Choice::neo_hookean:
      break;
    case Choice::mooney_rivlin:
      return Material::of(2 * s.c10, {std::make_shared<SecondInvariant>(s.c01)}, s.poisson);
    case Choice::veronda_westmann: {
      const double c2 = s.c2.value_or(-0.5 * s.c1 * s.beta);
      return Material::of(0, {std::make_shared<Exponential>(s.c1, s.beta, c2)}, s.poisson);
    }
    case Choice::ogden: {
      std::vector<Ogden::Term> terms;
      for (const auto& t : s.terms) terms.push_back({t.mu, t.alpha});
      return Material::of(0, {std::make_shared<Ogden>(std::move(terms))}, s.poisson);
    }
    case Choice::holzapfel: {
      Material m = Material::of(mu, {std::make_shared<Fibres>(s.k1, s.k2, s.dispersion)}, s.poisson);
      m.fibre = s.fibre;
      return m;
    }
    case Choice::st_venant: {
      Material m;
      m.laws = {std::make_shared<StVenantKirchhoff>(mu, lambda)};
      return m;
    }
    case Choice::linear: {
      Material m;
      m.laws = {std::make_shared<Linear>(mu, lambda)};
      return m;
    }
  }
  return Material::neo_hookean(s.young, s.poisson);
}

}  // namespace palpate
