// SPDX-License-Identifier: MIT
// The keys of [[region]]: a shape, and the material in it.
#include "formats/scene_key_kinds.hpp"

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

// Of the table of a region's labels.
Keys<RegionScene> label_keys() {
  return {{"image",
           Affects::nothing,
           "",
           "",
           [](RegionScene& region, const toml::node& value, const toml::table& parent, const Place& place) {
             region.surface = source_beside(to_text(place, value), parent, above(place));
           },
           {},
           ""},
          integer("value", &RegionScene::label, {-2147483648.0, 2147483647.0, false, ""}, ""),
          {"units",
           Affects::solves,
           "",
           "",  // taken up with the image
           [](RegionScene&, const toml::node&, const toml::table&, const Place&) {},
           {},
           ""}};
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
                   "In place of a surface: the voxels of one value in a label image (NRRD, MetaImage), in the "
                   "coordinates of that file, which have to be the surface's (no turn from LPS to RAS).",
                   "{image = \"FILE\", value = n, units}, -2147483648 <= n <= 2147483647",
                   [](RegionScene& region, const toml::node& value, const toml::table&, const Place& place) {
                     const toml::table& table = to_table(place, value);
                     region.shape = RegionScene::Shape::labels;
                     read_table(region, table, label_keys(), place);
                     if (!table.contains("image") || !table.contains("value"))
                       fail(place, &value, "labels need both 'image' and 'value'");
                   },
                   [](const RegionScene& r) {
                     return r.shape == RegionScene::Shape::labels
                                ? "{image = " + show(r.surface.file.string()) + ", value = " + show(r.label) +
                                      ", units = " + show_unit(r.surface.unit) + "}"
                                : std::string();
                   },
                   "{image = \"FILE\", value = 1, units = \"mm\"}"});
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

}  // namespace palpate::scene_io
