// SPDX-License-Identifier: GPL-3.0-or-later
// From a scene's law to energies.
#include "precompute/fem/materials/scene_material.hpp"

#include "precompute/fem/materials/distortion.hpp"
#include "precompute/fem/materials/fibre.hpp"
#include "precompute/fem/materials/invariant_law.hpp"
#include "precompute/fem/materials/linear.hpp"
#include "precompute/fem/materials/ogden.hpp"

namespace palpate::fem {

namespace {

using Laws = std::vector<std::shared_ptr<const Law>>;

// mu/2 (F:F - 3) + laws, of the whole deformation or of its distortion.
Material material_of(const MaterialScene& s, double mu, Laws laws) {
  if (s.volumetric == MaterialScene::Volumetric::coupled) return Material::of(mu, std::move(laws), s.poisson);
  return Material::of(0, {std::make_shared<Distortion>(mu, std::move(laws))}, s.poisson);
}

}  // namespace

Material make_material(const MaterialScene& s) {
  using Choice = MaterialScene::Law;
  const double mu = s.young / (2 * (1 + s.poisson)), lambda = 2 * mu * s.poisson / (1 - 2 * s.poisson);
  switch (s.law) {
    case Choice::neo_hookean:
      break;
    case Choice::mooney_rivlin:
      return material_of(s, 2 * s.c10, {std::make_shared<SecondInvariant>(s.c01)});
    case Choice::veronda_westmann: {
      const double c2 = s.c2.value_or(-0.5 * s.c1 * s.beta);
      return material_of(s, 0, {std::make_shared<Exponential>(s.c1, s.beta, c2)});
    }
    case Choice::ogden: {
      std::vector<Ogden::Term> terms;
      for (const auto& t : s.terms) terms.push_back({t.mu, t.alpha});
      return material_of(s, 0, {std::make_shared<Ogden>(std::move(terms))});
    }
    case Choice::holzapfel: {
      Material m = material_of(s, mu, {std::make_shared<Fibres>(s.k1, s.k2, s.dispersion)});
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
  return material_of(s, mu, {});
}

}  // namespace palpate::fem
