// SPDX-License-Identifier: MIT
// The keys of [[support]]: where the surface is held, and how.
#include "formats/scene/scene_key_kinds.hpp"

namespace palpate::scene_io {
namespace {

constexpr Range kBed{0, 1e15, true, "N/m^3"};

Key<SupportScene> support_kind(const char* name, SupportScene::Kind kind, const char* help, const char* allowed,
                               const char* example,
                               std::function<void(SupportScene&, const toml::node&, const Place&)> read,
                               std::function<std::string(const SupportScene&)> show_value) {
  return {name,
          Affects::solves,
          help,
          allowed,
          [=](SupportScene& target, const toml::node& value, const toml::table&, const Place& place) {
            target.kind = kind;
            read(target, value, place);
          },
          [=](const SupportScene& target) { return target.kind == kind ? show_value(target) : ""; },
          example};
}

void read_half_space(SupportScene& target, const toml::node& value, const Place& place) {
  const auto vector = [](const char* name, Eigen::Vector3d SupportScene::*member) {
    return Key<SupportScene>{name,
                             Affects::solves,
                             "",
                             "",
                             [=](SupportScene& support, const toml::node& node, const toml::table&, const Place& at) {
                               support.*member = to_vector(at, node, kCoordinate);
                             },
                             {},
                             ""};
  };
  const toml::table& table = to_table(place, value);
  read_table(target, table, {vector("point", &SupportScene::point), vector("normal", &SupportScene::normal)}, place);
  if (!table.contains("point") || !table.contains("normal")) {
    fail(place, &value, "a half-space needs both 'point' and 'normal'");
  }
  const double length = target.normal.norm();
  if (!(length > 1e-9)) fail_value(place.below("normal"), *table.get("normal"), "a vector of length > 1e-9");
  target.normal /= length;
}

void read_distance(SupportScene& target, const toml::node& value, const Place& place) {
  const toml::table& table = to_table(place, value);
  Keys<SupportScene> keys = surface_keys(&SupportScene::other, "");
  keys.push_back(number("within", &SupportScene::within, kLength, ""));
  read_table(target, table, keys, place);
  if (!table.contains("surface") || !table.contains("within")) {
    fail(place, &value, "a distance support needs both 'surface' and 'within'");
  }
}

std::string show_distance(const SupportScene& support) {
  std::string text = "{surface = " + show(support.other.file.string());
  if (!support.other.meshes.empty()) text += ", meshes = " + show(support.other.meshes);
  return text + ", units = " + show_unit(support.other.unit) + ", within = " + show(support.within) + "}";
}

}  // namespace

const Keys<SupportScene>& support_keys() {
  using Kind = SupportScene::Kind;
  static const Keys<SupportScene> keys{
      support_kind(
          "mesh", Kind::mesh, "Held: the part of the body's surface that came from this mesh.", "a text", "\"NAME\"",
          [](SupportScene& s, const toml::node& value, const Place& place) { s.mesh = to_text(place, value); },
          [](const SupportScene& s) { return show(s.mesh); }),
      support_kind(
          "box", Kind::box, "Held: the surface inside this box.", "{min = [x, y, z], max = [x, y, z]}, min < max, m",
          "{min = [-1, -1, -1], max = [1, 1, 0]}",
          [](SupportScene& s, const toml::node& value, const Place& place) {
            std::tie(s.box_min, s.box_max) = to_box(place, value);
          },
          [](const SupportScene& s) { return show_box(s.box_min, s.box_max); }),
      support_kind(
          "half_space", Kind::half_space, "Held: the surface where (x - point) . normal <= 0.",
          "{point = [x, y, z], normal = [x, y, z]}, m", "{point = [0, 0, 0], normal = [0, 0, 1]}", read_half_space,
          [](const SupportScene& s) { return "{point = " + show(s.point) + ", normal = " + show(s.normal) + "}"; }),
      support_kind("distance", Kind::distance, "Held: the surface within this distance of another surface.",
                   "{surface, meshes, units, within}, 0 < within <= 10 m", "{surface = \"FILE\", within = 0.002}",
                   read_distance, show_distance),
      choice("type", &SupportScene::type, {"fixed", "spring", "slider"},
             "fixed; an elastic bed; or free to slide along the surface and held across it."),
      {"stiffness", Affects::solves, "spring: required, traction over displacement.", kBed.text(),
       [](SupportScene& s, const toml::node& value, const toml::table&, const Place& place) {
         s.stiffness = to_number(place, value, kBed);
       },
       [](const SupportScene& s) { return s.type == SupportScene::Type::spring ? show(s.stiffness) : std::string(); },
       "1e5"}};
  return keys;
}

}  // namespace palpate::scene_io
