// SPDX-License-Identifier: MIT
// Keys of a material, and what they must meet together.
#include "formats/scene/scene_key_kinds.hpp"
#include "formats/scene/tissues.hpp"

#include <algorithm>
#include <array>

namespace palpate::scene_io {

namespace {

using M = MaterialScene;
using Law = MaterialScene::Law;

constexpr Range kModulusOrNone{0, 1e12, false, "Pa"};
constexpr double kMostPlain = 0.45;  // Poisson's ratio of laws whose volume term is at every point: beyond it they lock

std::vector<std::string> tissue_names() {
  std::vector<std::string> names;
  for (const Tissue& tissue : tissues()) names.emplace_back(tissue.name);
  return names;
}

const std::vector<std::string> kLaws{"neo-hookean",     "mooney-rivlin",       "ogden", "veronda-westmann",
                                     "holzapfel-ogden", "st-venant-kirchhoff", "linear"};

/// Keys beside law and poisson; the first `needed` of them must be there.
struct LawKeys {
  std::vector<std::string> names;
  std::size_t needed = 0;
};

const LawKeys& keys_of(Law law) {
  static const std::array<LawKeys, 7> keys{{{{"young", "tissue"}, 0},
                                            {{"c10", "c01"}, 2},
                                            {{"terms"}, 1},
                                            {{"c1", "beta", "c2"}, 2},
                                            {{"k1", "k2", "fibre", "dispersion", "young"}, 3},
                                            {{"young"}, 0},
                                            {{"young"}, 0}}};
  return keys[static_cast<std::size_t>(law)];
}

std::vector<M::OgdenTerm> to_terms(const Place& place, const toml::node& value) {
  const char* allowed = "one to six pairs [[mu, alpha], ...]: mu in Pa, alpha not 0 and from -100 to 100";
  const auto* list = value.as_array();
  if (list == nullptr || list->empty() || list->size() > 6) fail_value(place, value, allowed);
  std::vector<M::OgdenTerm> terms;
  for (const toml::node& node : *list) {
    const auto* pair = node.as_array();
    if (pair == nullptr || pair->size() != 2) fail_value(place, node, allowed);
    const M::OgdenTerm term{to_number(place, *pair->get(0), {-1e12, 1e12, false, "Pa"}),
                            to_number(place, *pair->get(1), {-100, 100, false, ""})};
    if (term.alpha == 0) fail_value(place, *pair->get(1), "alpha not 0");
    terms.push_back(term);
  }
  return terms;
}

std::string show_terms(const std::vector<M::OgdenTerm>& terms) {
  std::string text;
  for (const M::OgdenTerm& t : terms) text += (text.empty() ? "[" : ", [") + show(t.mu) + ", " + show(t.alpha) + "]";
  return text.empty() ? "" : "[" + text + "]";
}

void read_centreline(M& m, const toml::node& value, const Place& place) {
  const toml::table& table = to_table(place, value);
  const auto beside = [](M&, const toml::node&, const toml::table&, const Place&) {};  // taken up with the file
  read_table(m, table,
             {{"centreline",
               Affects::nothing,
               "",
               "",
               [](M& target, const toml::node& file, const toml::table& parent, const Place& at) {
                 target.centreline = source_beside(to_text(at, file), parent, above(at));
               },
               {},
               ""},
              {"meshes", Affects::solves, "", "", beside, {}, ""},
              {"units", Affects::solves, "", "", beside, {}, ""}},
             place);
  if (!table.contains("centreline")) fail(place, &value, "the table has no 'centreline'");
}

std::string show_centreline(const SurfaceSource& source) {
  return "{centreline = " + show(source.file.string()) +
         (source.meshes.empty() ? "" : ", meshes = " + show(source.meshes)) + ", units = " + show_unit(source.unit) +
         "}";
}

/// Shown only where the law reads it: other laws' texts stay as they are when a law is added.
Key<M> of_law(Law law, Key<M> key, const char* example) {
  key.example = example;
  key.show = [law, show = key.show](const M& m) { return m.law == law ? show(m) : std::string(); };
  return key;
}

/// Shown only where it is not the default: other scenes' texts stay as they were without the key.
Key<M> volumetric_key() {
  Key<M> key = choice(
      "volumetric", &M::volumetric, {"coupled", "isochoric"},
      "How a change of volume, J = det F, enters. coupled: W(F) + K/2 (J - 1)^2 + p (J - 1), with K and p such that F "
      "= I "
      "is free of stress and Poisson's ratio holds there. isochoric: W(J^(-1/3) F) + K/2 (J - 1)^2 with the bulk "
      "modulus K, the split of FEBio, CalculiX and Abaqus. J of the second terms is an element's mean.");
  key.show = [show = key.show](const M& m) { return m.volumetric == M::Volumetric::coupled ? std::string() : show(m); };
  key.example = "\"isochoric\"";
  return key;
}

/// Shear modulus at small strain (Pa) of laws with moduli of their own.
double shear_modulus(const M& m) {
  switch (m.law) {
    case Law::mooney_rivlin:
      return 2 * (m.c10 + m.c01);
    case Law::veronda_westmann:
      return 2 * (m.c1 * m.beta + m.c2.value_or(-0.5 * m.c1 * m.beta));
    case Law::ogden: {
      double sum = 0;
      for (const M::OgdenTerm& t : m.terms) sum += 0.5 * t.mu * t.alpha;
      return sum;
    }
    default:
      return m.young / (2 * (1 + m.poisson));
  }
}

/// Modulus of the volume term of the exponential law (Pa): the bulk modulus minus the part of the exponential. Unless
/// it is positive, the width of a stretched body has no equilibrium.
double volume_modulus(const M& m) {
  const double bulk = 2 * shear_modulus(m) * (1 + m.poisson) / (3 * (1 - 2 * m.poisson));
  const double own = m.c1 * m.beta, c2 = m.c2.value_or(-0.5 * own);
  return bulk + (2 * own - 12 * own * m.beta - 4 * c2) / 3;
}

bool has_own_moduli(Law law) { return law == Law::mooney_rivlin || law == Law::ogden || law == Law::veronda_westmann; }

}  // namespace

const Keys<MaterialScene>& material_keys() {
  static const Keys<M> keys{
      choice("law", &M::law, kLaws,
             "Strain energy. linear and st-venant-kirchhoff are for comparison with closed forms, not for organs."),
      {"young", Affects::solves, "Young's modulus at small strain (of the matrix, where there are fibres).",
       kModulus.text(),
       [](M& m, const toml::node& value, const toml::table&, const Place& place) {
         m.young = to_number(place, value, kModulus);
       },
       [](const M& m) { return show(m.young); }, ""},
      {"tissue", Affects::nothing,
       "neo-hookean: Young's modulus of a tissue, from a publication (palpate scene --tissues).",
       show_choices(tissue_names()),
       [](M& m, const toml::node& value, const toml::table& parent, const Place& place) {
         if (parent.contains("young")) fail(place, &value, "either 'tissue' or 'young' sets the stiffness, not both");
         m.tissue = tissues()[to_choice(place, value, tissue_names())].name;
       },
       [](const M&) { return std::string(); }, "\"liver\""},
      number("poisson", &M::poisson, {0, 0.4999, false, ""}, "Poisson's ratio at small strain."),
      volumetric_key(),
      of_law(Law::mooney_rivlin, number("c10", &M::c10, kModulusOrNone, "mooney-rivlin: factor of I1 - 3."), "500"),
      of_law(Law::mooney_rivlin, number("c01", &M::c01, kModulusOrNone, "mooney-rivlin: factor of I2 - 3."), "300"),
      of_law(Law::ogden,
             {"terms", Affects::solves, "ogden: pairs of W = sum mu/alpha (l1^alpha + l2^alpha + l3^alpha - 3).",
              "[[mu, alpha], ...], mu in Pa, sum of mu alpha > 0",
              [](M& m, const toml::node& value, const toml::table&, const Place& place) {
                m.terms = to_terms(place, value);
              },
              [](const M& m) { return show_terms(m.terms); }, ""},
             "[[200, 8]]"),
      of_law(Law::veronda_westmann,
             number("c1", &M::c1, kModulus, "veronda-westmann: factor of exp(beta (I1 - 3)) - 1."), "150"),
      of_law(Law::veronda_westmann, number("beta", &M::beta, {0, 1000, true, ""}, "veronda-westmann: exponent."), "5"),
      of_law(Law::veronda_westmann,
             {"c2", Affects::solves,
              "veronda-westmann: factor of I2 - 3; left out: -c1 beta / 2 as in the paper; 0: Fung's exponential.",
              "-1e+12 <= x <= 1e+12 Pa",
              [](M& m, const toml::node& value, const toml::table&, const Place& place) {
                m.c2 = to_number(place, value, {-1e12, 1e12, false, "Pa"});
              },
              [](const M& m) { return m.c2 ? show(*m.c2) : std::string(); }, ""},
             "0"),
      of_law(Law::holzapfel, number("k1", &M::k1, kModulusOrNone, "holzapfel-ogden: stiffness of the fibres."), "2000"),
      of_law(Law::holzapfel, number("k2", &M::k2, {0, 1000, true, ""}, "holzapfel-ogden: their stiffening."), "1"),
      of_law(Law::holzapfel,
             number("dispersion", &M::dispersion, {0, 1.0 / 3, false, ""},
                    "holzapfel-ogden: from 0, aligned, to 1/3, the same in all directions."),
             "0.1"),
      of_law(Law::holzapfel,
             {"fibre", Affects::solves,
              "holzapfel-ogden: direction of the fibres, or the curves that they run along: at every place that of "
              "the nearest point of a curve (lines of an OBJ file, or a CSV file with a point a row).",
              "[x, y, z], not 0, or {centreline = \"FILE\", meshes, units}",
              [](M& m, const toml::node& value, const toml::table&, const Place& place) {
                if (value.is_table()) return read_centreline(m, value, place);
                m.fibre = to_vector(place, value, {-1e6, 1e6, false, ""});
                const double length = m.fibre.norm();
                if (!(length > 1e-9)) fail_value(place, value, "a vector of length > 1e-9");
                m.fibre /= length;
              },
              [](const M& m) { return m.fibre.isZero(0) ? show_centreline(m.centreline) : show(m.fibre); }, ""},
             "[1, 0, 0]")};
  return keys;
}

void check_material(MaterialScene& m, const toml::table& table, const Place& place) {
  const LawKeys& mine = keys_of(m.law);
  const std::string law = show(kLaws[static_cast<std::size_t>(m.law)]);
  for (const Key<M>& key : material_keys()) {
    const toml::node* node = table.get(key.name);
    if (node == nullptr || key.name == "law" || key.name == "poisson" || key.name == "volumetric") continue;
    if (std::find(mine.names.begin(), mine.names.end(), key.name) == mine.names.end()) {
      fail(place.below(key.name), node,
           "a material of law " + law + " has no such key; it has: poisson, " + show(mine.names));
    }
  }
  for (std::size_t k = 0; k < mine.needed; ++k) {
    if (!table.contains(mine.names[k]))
      fail(place.below(mine.names[k]), &table, "missing; a material of law " + law + " needs it");
  }
  const bool plain = m.law == Law::linear || m.law == Law::st_venant,
             isochoric = m.volumetric == M::Volumetric::isochoric;
  if (plain && isochoric) {
    fail(place.below("volumetric"), table.get("volumetric"),
         "got \"isochoric\"; the law " + law + " has its own change of volume: leave the key out");
  }
  if (plain && m.poisson > kMostPlain) {
    fail(place.below("poisson"), table.contains("poisson") ? table.get("poisson") : &table,
         "got " + show(m.poisson) + "; allowed 0 <= x <= " + show(kMostPlain) + " for the law " + law);
  }
  for (const Tissue& tissue : tissues()) {
    if (m.tissue == tissue.name) m.young = 2 * tissue.shear * (1 + m.poisson);
  }
  const double shear = shear_modulus(m);
  if (!(shear > 0)) {
    fail(place.below(mine.names.front()), &table,
         "the shear modulus at small strain is " + show(shear) + " Pa; allowed x > 0");
  }
  if (m.law == Law::veronda_westmann && !isochoric && !(volume_modulus(m) > 0)) {
    fail(place.below("poisson"), table.contains("poisson") ? table.get("poisson") : &table,
         "got " + show(m.poisson) + "; the exponential alone resists changes of volume more than that, so beta = " +
             show(m.beta) + " needs a Poisson's ratio nearer to 0.5");
  }
  m.young = small_strain_young(m);
}

}  // namespace palpate::scene_io

namespace palpate {

double small_strain_young(const MaterialScene& material) {
  return scene_io::has_own_moduli(material.law) ? 2 * scene_io::shear_modulus(material) * (1 + material.poisson)
                                                : material.young;
}

}  // namespace palpate
