// SPDX-License-Identifier: MIT
// Surface files and boxes in a scene: values of several keys that belong together.
#pragma once

#include "formats/scene/scene.hpp"
#include "formats/scene/scene_value.hpp"

#include <utility>

namespace palpate::scene_io {

/// Names of length units, for `units`.
const std::vector<std::string>& unit_names();
/// TOML text of the unit of that many metres.
std::string show_unit(double unit);

/// The place of the table that `place` is a key of.
Place above(const Place& place);

/// `file` (relative to the scene file) with the `meshes` and `units` that stand in `table`.
SurfaceSource source_beside(const std::string& file, const toml::table& table, const Place& place);

/// A file name, or an array of file names or of tables {file, meshes, units}.
std::vector<SurfaceSource> to_sources(const Place& place, const toml::node& node, const toml::table& parent);

/// {image = "FILE", value = n or segment = "NAME", units, islands}; several values or segments as arrays.
LabelSource to_labels(const Place& place, const toml::node& node);
/// The same as TOML text; without the image where the path is empty.
std::string show_labels(const LabelSource& labels);
/// Keys that to_labels allows, and an example, for the reference.
inline constexpr const char* kLabelsAllowed =
    "{image = \"FILE\", value = n (or [n, ...]) or segment = \"NAME\" (or several), units, islands = \"auto\" | "
    "\"largest\" | \"all\"}";
inline constexpr const char* kLabelsExample = "{image = \"FILE\", value = 1}";

/// {min = [x, y, z], max = [x, y, z]} with min below max (m).
std::pair<Eigen::Vector3d, Eigen::Vector3d> to_box(const Place& place, const toml::node& node);
std::string show_box(const Eigen::Vector3d& min, const Eigen::Vector3d& max);

/// Allowed ranges of a coordinate and of an extent.
inline constexpr Range kCoordinate{-100, 100, false, "m"};
inline constexpr Range kLength{0, 10, true, "m"};

}  // namespace palpate::scene_io
