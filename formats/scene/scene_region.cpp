// SPDX-License-Identifier: MIT
// The keys of [[region]]: a shape, and the material in it.
#include "formats/scene/scene_key_kinds.hpp"

#include <algorithm>

namespace palpate::scene_io {
namespace {

/// Regions are written to files of their names.
bool names_a_file(const std::string& name) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_' ||
           c == '.' || c == ' ';
  };
  return name.front() != '.' && std::all_of(name.begin(), name.end(), plain);
}

// A table of these two keys and no others.
const toml::table& two_of(const toml::node& value, const Place& place, const char* first, const char* second) {
  const toml::table& table = to_table(place, value);
  if (table.size() != 2 || !table.contains(first) || !table.contains(second)) {
    fail(place, &value, std::string("needs '") + first + "' and '" + second + "', and nothing else");
  }
  return table;
}

}  // namespace

const Keys<RegionScene>& region_keys() {
  static const Keys<RegionScene> keys = [] {
    Keys<RegionScene> all{text("name", &RegionScene::name, "Name; left out: region, region2, ...", "\"tumour\"",
                               "letters, digits, spaces and - _ . in any order, but no '.' at the beginning",
                               names_a_file)};
    all = join(all, surface_keys(&RegionScene::surface, "Closed surface strictly inside the body."));
    all.push_back({"sphere", Affects::solves, "In place of a surface: a ball.",
                   "{center = [x, y, z], radius = r}, 0 < r <= 10 m",
                   [](RegionScene& region, const toml::node& value, const toml::table&, const Place& place) {
                     const toml::table& table = two_of(value, place, "center", "radius");
                     region.shape = RegionScene::Shape::ellipsoid;
                     region.centre = to_vector(place.below("center"), *table.get("center"), kCoordinate);
                     region.radii.setConstant(to_number(place.below("radius"), *table.get("radius"), kLength));
                   },
                   [](const RegionScene&) { return std::string(); }, "{center = [0, 0, 0.1], radius = 0.01}"});
    all.push_back({"ellipsoid", Affects::solves, "In place of a surface: an ellipsoid along the axes.",
                   "{center = [x, y, z], radii = [a, b, c]}, 0 < a, b, c <= 10 m",
                   [](RegionScene& region, const toml::node& value, const toml::table&, const Place& place) {
                     const toml::table& table = two_of(value, place, "center", "radii");
                     region.shape = RegionScene::Shape::ellipsoid;
                     region.centre = to_vector(place.below("center"), *table.get("center"), kCoordinate);
                     region.radii = to_vector(place.below("radii"), *table.get("radii"), kLength);
                   },
                   [](const RegionScene& r) {
                     return r.shape == RegionScene::Shape::ellipsoid
                                ? "{center = " + show(r.centre) + ", radii = " + show(r.radii) + "}"
                                : std::string();
                   },
                   "{center = [0, 0, 0.1], radii = [0.01, 0.02, 0.01]}"});
    all.push_back({"box", Affects::solves, "In place of a surface: a box along the axes.",
                   "{min = [x, y, z], max = [x, y, z]}, min < max, m",
                   [](RegionScene& region, const toml::node& value, const toml::table&, const Place& place) {
                     region.shape = RegionScene::Shape::box;
                     std::tie(region.box_min, region.box_max) = to_box(place, value);
                   },
                   [](const RegionScene& r) {
                     return r.shape == RegionScene::Shape::box ? show_box(r.box_min, r.box_max) : std::string();
                   },
                   "{min = [0, 0, 0.1], max = [0.02, 0.02, 0.12]}"});
    all.push_back({"labels", Affects::solves,
                   "In place of a surface: voxels of a label image (NIfTI, NRRD, MetaImage), by value or by the "
                   "segment's name.",
                   kLabelsAllowed,
                   [](RegionScene& region, const toml::node& value, const toml::table&, const Place& place) {
                     region.shape = RegionScene::Shape::labels;
                     region.labels = to_labels(place, value);
                   },
                   [](const RegionScene& r) {
                     return r.shape == RegionScene::Shape::labels ? show_labels(r.labels) : std::string();
                   },
                   kLabelsExample});
    for (const Key<MaterialScene>& key : material_keys()) {
      all.push_back({key.name, key.affects, key.help, key.allowed,
                     [=](RegionScene& region, const toml::node& value, const toml::table& parent, const Place& place) {
                       key.read(region.material, value, parent, place);
                     },
                     [=](const RegionScene& region) { return key.show(region.material); }, key.example});
    }
    return all;
  }();
  return keys;
}

const Keys<CavityScene>& cavity_keys() {
  static const Keys<CavityScene> keys = [] {
    Keys<CavityScene> all{
        text("name", &CavityScene::name, "Name, by which prestress may choose it; left out: cavity, cavity2, ...",
             "\"lumen\"", "letters, digits, spaces and - _ . in any order, but no '.' at the beginning", names_a_file)};
    all = join(all, surface_keys(&CavityScene::surface, "Closed surface strictly inside the body."));
    all.push_back({"labels", Affects::solves, "In place of a surface: voxels of a label image.", kLabelsAllowed,
                   [](CavityScene& cavity, const toml::node& value, const toml::table&, const Place& place) {
                     cavity.labels = to_labels(place, value);
                   },
                   [](const CavityScene& c) {
                     return c.labels.values.empty() && c.labels.segments.empty() ? "" : show_labels(c.labels);
                   },
                   kLabelsExample});
    return all;
  }();
  return keys;
}

}  // namespace palpate::scene_io
