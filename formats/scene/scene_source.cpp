// SPDX-License-Identifier: MIT
// Reads surface sources and boxes.
#include "formats/scene/scene_source.hpp"

#include "formats/scene/scene_keys.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace palpate::scene_io {

namespace {

const std::vector<std::string> kUnits{"m", "cm", "mm", "in"};
const std::vector<std::string> kIslands{"auto", "largest", "all"};  // in the order of the enumerators
constexpr std::array<double, 4> kUnitLengths{1.0, 0.01, 0.001, 0.0254};

}  // namespace

const std::vector<std::string>& unit_names() { return kUnits; }

std::string show_unit(double unit) {
  const auto at = std::find(kUnitLengths.begin(), kUnitLengths.end(), unit);
  return show(kUnits[static_cast<std::size_t>(at - kUnitLengths.begin())]);
}

SurfaceSource source_beside(const std::string& file, const toml::table& table, const Place& place) {
  SurfaceSource source;
  source.file = place.file.parent_path() / std::filesystem::path(file);
  if (const auto* meshes = table.get("meshes")) source.meshes = to_texts(place.below("meshes"), *meshes);
  if (const auto* units = table.get("units")) {
    source.unit = kUnitLengths[to_choice(place.below("units"), *units, kUnits)];
  }
  return source;
}

Place above(const Place& place) { return {place.file, place.key.substr(0, place.key.rfind('.'))}; }

std::vector<SurfaceSource> to_sources(const Place& place, const toml::node& node, const toml::table& parent) {
  const char* allowed = "a file name, or an array of file names or of tables {file, meshes, units}";
  if (node.is_string()) return {source_beside(to_text(place, node), parent, above(place))};
  const auto* array = node.as_array();
  if (array == nullptr || array->empty()) fail_value(place, node, allowed);
  const bool simple = array->size() == 1 && array->front().is_string();
  if (!simple && parent.contains("meshes")) {
    fail(above(place).below("meshes"), parent.get("meshes"),
         "name the meshes of each file: surface = [{file = \"FILE\", meshes = [\"NAME\"]}]");
  }
  std::vector<SurfaceSource> sources;
  for (const toml::node& element : *array) {
    if (element.is_string()) {
      sources.push_back(source_beside(to_text(place, element), parent, above(place)));
      continue;
    }
    const auto* table = element.as_table();
    if (table == nullptr) fail_value(place, element, allowed);
    const auto checked_later = [](std::string&, const toml::node&, const toml::table&, const Place&) {};
    std::string file;
    read_table(file, *table,
               {{"file",
                 Affects::nothing,
                 "",
                 "",
                 [](std::string& target, const toml::node& value, const toml::table&, const Place& at) {
                   target = to_text(at, value);
                 },
                 {},
                 ""},
                {"meshes", Affects::solves, "", "", checked_later, {}, ""},
                {"units", Affects::solves, "", "", checked_later, {}, ""}},
               place);
    if (file.empty()) fail(place, &element, "the table has no 'file'");
    sources.push_back(source_beside(file, *table, place));
    if (!table->contains("units")) sources.back().unit = source_beside(file, parent, above(place)).unit;
  }
  return sources;
}

LabelSource to_labels(const Place& place, const toml::node& node) {
  constexpr Range kValue{std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max(), false, ""};
  using Read = std::function<void(LabelSource&, const toml::node&, const toml::table&, const Place&)>;
  const auto key = [](const char* name, Read read) {
    return Key<LabelSource>{name, Affects::solves, "", "", std::move(read), {}, ""};
  };
  const Keys<LabelSource> keys{
      key("image",
          [](LabelSource& labels, const toml::node& value, const toml::table&, const Place& at) {
            labels.file = at.file.parent_path() / std::filesystem::path(to_text(at, value));
          }),
      key("value",
          [&](LabelSource& labels, const toml::node& value, const toml::table&, const Place& at) {
            const auto* array = value.as_array();
            if (array != nullptr && array->empty()) fail_value(at, value, "a whole number, or several");
            if (array == nullptr) {
              labels.values = {to_integer(at, value, kValue, 1)};
            } else {
              for (const toml::node& element : *array) labels.values.push_back(to_integer(at, element, kValue, 1));
            }
          }),
      key("segment", [](LabelSource& labels, const toml::node& value, const toml::table&,
                        const Place& at) { labels.segments = to_texts(at, value); }),
      key("units", [](LabelSource& labels, const toml::node& value, const toml::table&,
                      const Place& at) { labels.unit = kUnitLengths[to_choice(at, value, kUnits)]; }),
      key("islands", [](LabelSource& labels, const toml::node& value, const toml::table&, const Place& at) {
        labels.islands = static_cast<Islands>(to_choice(at, value, kIslands));
      })};
  const toml::table& table = to_table(place, node);
  LabelSource labels;
  read_table(labels, table, keys, place);
  if (labels.file.empty() || (labels.values.empty() && labels.segments.empty())) {
    fail(place, &node, "labels need both 'image' and 'value' (or 'segment')");
  }
  return labels;
}

std::string show_labels(const LabelSource& labels) {
  std::vector<std::string> parts;
  if (!labels.file.empty()) parts.push_back("image = " + show(labels.file.string()));
  std::string values;
  for (const int value : labels.values) values += (values.empty() ? "" : ", ") + show(value);
  if (labels.values.size() == 1) parts.push_back("value = " + values);
  if (labels.values.size() > 1) parts.push_back("value = [" + values + "]");
  if (labels.segments.size() == 1) parts.push_back("segment = " + show(labels.segments.front()));
  if (labels.segments.size() > 1) parts.push_back("segment = " + show(labels.segments));
  if (labels.unit > 0) parts.push_back("units = " + show_unit(labels.unit));
  if (labels.islands != Islands::automatic) {
    parts.push_back("islands = " + show(kIslands[static_cast<std::size_t>(labels.islands)]));
  }
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "{" : ", ") + part;
  return text + "}";
}

std::pair<Eigen::Vector3d, Eigen::Vector3d> to_box(const Place& place, const toml::node& node) {
  struct Box {
    Eigen::Vector3d min{0, 0, 0}, max{0, 0, 0};
  } box;
  const auto corner = [](const char* name, Eigen::Vector3d Box::*member) {
    return Key<Box>{name,
                    Affects::solves,
                    "",
                    "",
                    [=](Box& target, const toml::node& value, const toml::table&, const Place& at) {
                      target.*member = to_vector(at, value, kCoordinate);
                    },
                    {},
                    ""};
  };
  const toml::table& table = to_table(place, node);
  read_table(box, table, Keys<Box>{corner("min", &Box::min), corner("max", &Box::max)}, place);
  if (!table.contains("min") || !table.contains("max")) fail(place, &node, "a box needs both 'min' and 'max'");
  if (!(box.min.array() < box.max.array()).all()) {
    fail(place, &node,
         "got min = " + show(box.min) + ", max = " + show(box.max) +
             "; allowed: every component of min below that of max");
  }
  return {box.min, box.max};
}

std::string show_box(const Eigen::Vector3d& min, const Eigen::Vector3d& max) {
  return "{min = " + show(min) + ", max = " + show(max) + "}";
}

}  // namespace palpate::scene_io
