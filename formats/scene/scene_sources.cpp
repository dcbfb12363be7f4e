// SPDX-License-Identifier: MIT
// The keys of [sources], [[measured]] and [[analytic]]. They change the file that is made, never a solve: a bake stays
// valid.
#include "formats/scene/scene_key_kinds.hpp"

#include <algorithm>
#include <array>

namespace palpate::scene_io {
namespace {

using A = AnalyticScene;

constexpr Range kPoisson{0, 0.5, false, ""};
constexpr Range kReach{0, 1, true, "m"};
constexpr Range kStiffness{0, 1e15, true, "N/m^3 (winkler), N/m (spring)"};
constexpr Range kSite{0, 2147483647, false, ""};

const std::vector<std::string>& laws() {
  static const std::vector<std::string> names{"hertz", "punch", "cone", "layer", "winkler", "spring"};
  return names;
}

bool any(const std::string& /*text*/) { return true; }

/// A number that is there only where it is given: `set` stores it, `get` has it or nothing.
template <class T>
Key<T> given(const char* name, Range range, const char* help, const char* example, std::function<void(T&, double)> set,
             std::function<std::optional<double>(const T&)> get) {
  return {name,
          Affects::file,
          help,
          range.text(),
          [=](T& target, const toml::node& value, const toml::table&, const Place& place) {
            set(target, to_number(place, value, range));
          },
          [=](const T& target) {
            const std::optional<double> value = get(target);
            return value ? show(*value) : std::string();
          },
          example};
}

Key<A> given(const char* name, std::optional<double> A::*member, Range range, const char* help, const char* example) {
  return given<A>(
      name, range, help, example, [=](A& target, double value) { target.*member = value; },
      [=](const A& target) { return target.*member; });
}

template <class T>
Key<T> given(const char* name, double T::*member, Range range, const char* help, const char* example) {
  return given<T>(
      name, range, help, example, [=](T& target, double value) { target.*member = value; },
      [=](const T& target) { return target.*member > 0 ? std::optional(target.*member) : std::nullopt; });
}

std::vector<int> to_sites(const Place& place, const toml::node& node) {
  const auto* array = node.as_array();
  if (array == nullptr || array->empty()) fail_value(place, node, "one or more whole numbers: [0, 7]");
  std::vector<int> sites;
  for (const toml::node& element : *array) sites.push_back(to_integer(place, element, kSite, 1));
  std::sort(sites.begin(), sites.end());
  return sites;
}

std::string show_sites(const A& analytic) {
  std::string text;
  for (const int site : analytic.sites) text += (text.empty() ? "[" : ", ") + show(site);
  return text.empty() ? text : text + "]";
}

}  // namespace

const Keys<SceneSources>& sources_keys() {
  static const Keys<SceneSources> keys{affecting(
      Affects::file, choice("rest", &SceneSources::rest, {"solved", "filled"},
                            "Sites without a recording and without a law: solved, or filled from their neighbours."))};
  return keys;
}

const Keys<MeasuredScene>& measured_keys() {
  using M = MeasuredScene;
  static const Keys<M> keys{
      {"file", Affects::nothing, "Required. Recorded contacts (formats/recording/recording-file.md).",
       "a CSV file, relative to the scene file",
       [](M& target, const toml::node& value, const toml::table&, const Place& place) {
         target.file = place.file.parent_path() / to_text(place, value);
       },
       [](const M& target) { return target.file.empty() ? "" : show(target.file.string()); }, "\"FILE.csv\""},
      affecting(Affects::file,
                text("tool", &M::tool, "Tool of the rows that name none; left out: the scene's only one.", "\"probe\"",
                     "a tool's name", any)),
      given<M>("reach", &M::reach, kReach,
               "Farthest that a recorded contact may lie from the body's surface; left out: a quarter of "
               "sampling.spacing.",
               "0.003")};
  return keys;
}

const Keys<AnalyticScene>& analytic_keys() {
  static const Keys<A> keys{
      affecting(Affects::file,
                choice("law", &A::law, laws(),
                       "Required. A tool on a half-space: sphere (Hertz), flat punch, cone (Sneddon; sharp: for "
                       "depths from its tip's radius on); of a sphere on a thin bonded layer (Dimitriadis, "
                       "incompressible); a bed of springs under a sphere or punch; a spring.")),
      affecting(Affects::file,
                text("tool", &A::tool, "Only this tool's; left out: every tool's.", "\"probe\"", "a tool's name", any)),
      given("young", &A::young, kModulus, "Not winkler, spring: modulus; left out: the body's.", "5000"),
      given("poisson", &A::poisson, kPoisson, "hertz, punch, cone: Poisson's ratio; left out: the body's.", "0.49"),
      given<A>("thickness", &A::thickness, kLength,
               "layer: its thickness, at least twice the sampled depth; left out: of the wall at each site.", "0.01"),
      given<A>("stiffness", &A::stiffness, kStiffness, "winkler, spring: required, traction or force over depth.",
               "1e6"),
      formerly("sideways_stiffness",
               given<A>("tangential_stiffness", &A::tangential_stiffness, kStiffness,
                        "winkler, spring, with friction: the same for tangential pushes; left out: as large.", "1e6")),
      {"within_box", Affects::file, "Only at the sites inside this box.",
       "{min = [x, y, z], max = [x, y, z]}, min < max, m",
       [](A& target, const toml::node& value, const toml::table&, const Place& place) {
         target.within_box = to_box(place, value);
       },
       [](const A& a) { return a.within_box ? show_box(a.within_box->first, a.within_box->second) : std::string(); },
       "{min = [-1, -1, 0], max = [1, 1, 1]}"},
      affecting(Affects::file,
                text("mesh", &A::mesh, "Only at the sites on the part of the body's surface that came from this mesh.",
                     "\"NAME\"", "a text", any)),
      {"sites", Affects::file, "Only at these sites of the haptic mesh.", "[a, b, ...], whole numbers from 0",
       [](A& target, const toml::node& value, const toml::table&, const Place& place) {
         target.sites = to_sites(place, value);
         target.sites_line = static_cast<int>(value.source().begin.line);
       },
       show_sites, "[0, 7]"}};
  return keys;
}

void check_measured(const toml::table& table, const Place& place) {
  if (!table.contains("file")) fail(place.below("file"), &table, "missing; a recording is a CSV file");
}

void check_analytic(const AnalyticScene& analytic, const toml::table& table, const Place& place) {
  static const std::array<std::vector<std::string>, 6> used{{{"young", "poisson"},
                                                             {"young", "poisson"},
                                                             {"young", "poisson"},
                                                             {"young", "thickness"},
                                                             {"stiffness", "tangential_stiffness"},
                                                             {"stiffness", "tangential_stiffness"}}};
  if (!table.contains("law")) {
    fail(place.below("law"), &table, "missing; allowed " + show_choices(laws()));
  }
  const std::string& law = laws()[static_cast<std::size_t>(analytic.law)];
  const auto& own = used[static_cast<std::size_t>(analytic.law)];
  for (const char* key : {"young", "poisson", "thickness", "stiffness", "tangential_stiffness"}) {
    if (table.contains(key) && std::find(own.begin(), own.end(), key) == own.end()) {
      fail(place.below(key), table.get(key), "the law " + show(law) + " has no such key; it has: " + show(own));
    }
  }
  const bool bed = analytic.law == A::Law::winkler || analytic.law == A::Law::spring;
  if (bed && !table.contains("stiffness")) {
    fail(place.below("stiffness"), &table, "missing; the law " + show(law) + " needs it");
  }
}

}  // namespace palpate::scene_io
