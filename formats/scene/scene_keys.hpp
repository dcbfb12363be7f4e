// SPDX-License-Identifier: MIT
// The one table of all scene keys: how each is read, its range, its default and its help text.
#pragma once

#include "formats/scene/scene.hpp"
#include "formats/scene/scene_sources.hpp"
#include "formats/scene/scene_value.hpp"

#include <functional>

namespace palpate::scene_io {

/// The part of a bake that a key changes; canonical_text keeps some and leaves out others.
enum class Affects {
  nothing,  ///< a name or a path
  solves,   ///< what is solved
  file,     ///< only what is made of the solves
};

/// One key of a table that fills a T.
template <class T>
struct Key {
  std::string name;
  Affects affects = Affects::solves;
  std::string help;     ///< one sentence
  std::string allowed;  ///< the range, as messages print it
  /// Checks `value` and stores it. `parent` is the table the key stands in, for keys that belong together.
  std::function<void(T& target, const toml::node& value, const toml::table& parent, const Place& place)> read;
  /// TOML text of the value in `target`; empty: not set.
  std::function<std::string(const T& target)> show;
  std::string example;   ///< for the reference, where there is no default
  std::string former{};  ///< name in earlier programs: refused with the new one
};

template <class T>
using Keys = std::vector<Key<T>>;

// One table of keys a section, in the order they are read and documented.
const Keys<Scene>& scene_keys();  ///< keys outside any section
const Keys<BodyScene>& body_keys();
const Keys<MaterialScene>& material_keys();    ///< with check_material, in scene_material.cpp
const Keys<RegionScene>& region_keys();        ///< in scene_region.cpp
const Keys<CavityScene>& cavity_keys();        ///< in scene_region.cpp
const Keys<SupportScene>& support_keys();      ///< in scene_support.cpp
const Keys<PrestressScene>& prestress_keys();  ///< with check_prestress, in scene_prestress.cpp
const Keys<ToolScene>& tool_keys();
const Keys<Scene>& contact_keys();
const Keys<SamplingScene>& sampling_keys();
const Keys<ResponseScene>& response_keys();
const Keys<SolverScene>& solver_keys();
const Keys<ComplianceScene>& compliance_keys();  ///< in scene_compliance.cpp
const Keys<SceneSources>& sources_keys();
const Keys<MeasuredScene>& measured_keys();  ///< with what their keys must meet together, in scene_sources.cpp
const Keys<AnalyticScene>& analytic_keys();

/// Checks a material's keys together; sets `young` where the law has moduli of its own.
void check_material(MaterialScene& material, const toml::table& table, const Place& place);

/// Keys that would change nothing without another one are errors.
void check_prestress(const PrestressScene& prestress, const toml::table& table, const Place& place);

/// Checks that a recording and a law have the keys that they need, and none that they do not use.
void check_measured(const toml::table& table, const Place& place);
void check_analytic(const AnalyticScene& analytic, const toml::table& table, const Place& place);

/// Names of the sections, as they stand in a scene.
const std::vector<std::string>& section_names();

/// Reads `table` into `target` by `keys`, in their order. Throws Error(bad_input) on a key that is not in them
/// and not in `more_names` (sub-tables that the caller reads).
template <class T>
void read_table(T& target, const toml::table& table, const Keys<T>& keys, const Place& place,
                const std::vector<std::string>& more_names = {}) {
  std::vector<std::string> names = more_names;
  for (const Key<T>& key : keys) names.push_back(key.name);
  for (const auto& [name, value] : table) {
    if (std::find(names.begin(), names.end(), name.str()) != names.end()) continue;
    for (const Key<T>& key : keys) {
      if (name.str() != key.former) continue;
      fail(place.below(name.str()), &value, "the name of this key is now '" + key.name + "'");
    }
    const std::string near = nearest(name.str(), names);
    std::string all;
    for (const std::string& known : names) all += (all.empty() ? "" : ", ") + known;
    fail(place.below(name.str()), &value,
         "unknown key; " + (near.empty() ? "" : "did you mean '" + near + "'? ") + "Allowed here: " + all);
  }
  for (const Key<T>& key : keys) {
    if (const toml::node* value = table.get(key.name)) key.read(target, *value, table, place.below(key.name));
  }
}

}  // namespace palpate::scene_io
