// SPDX-License-Identifier: MIT
// The keys of [prestress]. Loads that are absent leave no trace in the canonical text: solves of scenes without them
// stay valid.
#include "formats/scene/scene_key_kinds.hpp"

namespace palpate::scene_io {
namespace {

using P = PrestressScene;

constexpr Range kGravity{-1000, 1000, false, "m/s^2"};
constexpr Range kDensity{0, 1e5, true, "kg/m^3"};
constexpr Range kPressure{0, 1e9, false, "Pa"};
constexpr Range kStretch{0.2, 5, false, ""};

/// Shown only where `matters`.
Key<P> where(bool (*matters)(const P&), Key<P> key, const char* example) {
  key.example = example;
  key.show = [matters, show = key.show](const P& p) { return matters(p) ? show(p) : std::string(); };
  return key;
}

bool has_weight(const P& p) { return !p.gravity.isZero(0); }
bool has_pressure(const P& p) { return p.pressure > 0; }
bool has_stretch(const P& p) { return !p.stretch.isOnes(0); }

Key<P> vector(const char* name, Eigen::Vector3d P::*member, Range range, const char* help) {
  return {name,
          Affects::solves,
          help,
          "[x, y, z], each " + range.text(),
          [=](P& target, const toml::node& value, const toml::table&, const Place& place) {
            target.*member = to_vector(place, value, range);
          },
          [=](const P& target) { return show(target.*member); },
          ""};
}

}  // namespace

const Keys<PrestressScene>& prestress_keys() {
  static const Keys<P> keys{
      where(has_weight,
            vector("gravity", &P::gravity, kGravity, "Gravity; the surface file is the organ without its weight."),
            "[0, 0, -9.81]"),
      where(has_weight, number("density", &P::density, kDensity, "gravity: density of the organ and its regions."),
            "1060"),
      where(has_pressure,
            number("pressure", &P::pressure, kPressure,
                   "Pressure in the cavities, across their walls as these move (a filled bladder)."),
            "1000"),
      where(has_pressure,
            affecting(Affects::solves,
                      text("cavity", &P::cavity,
                           "pressure: only in the cavity whose wall came from this mesh; left out: in every one.",
                           "\"NAME\"", "a text", [](const std::string&) { return true; })),
            "\"NAME\""),
      where(has_stretch,
            vector("stretch", &P::stretch, kStretch,
                   "Factors by which the supports of the organ are moved apart, about the centre of its "
                   "bounding box."),
            "[1.1, 1, 1]")};
  return keys;
}

void check_prestress(const PrestressScene& prestress, const toml::table& table, const Place& place) {
  const auto needs = [&](const char* key, bool met, const char* what) {
    if (!met && table.contains(key))
      fail(place.below(key), table.get(key), std::string("changes nothing without ") + what);
  };
  needs("density", has_weight(prestress), "gravity");
  needs("cavity", has_pressure(prestress), "pressure");
}

}  // namespace palpate::scene_io
