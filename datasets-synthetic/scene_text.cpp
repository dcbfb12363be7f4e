// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the scene as a user would: only what differs from the defaults or is worth seeing.
#include "datasets-synthetic/scene_text.hpp"

#include <array>
#include <charconv>

namespace palpate::synth {

namespace {

std::string text(double value) {
  std::array<char, 32> buffer{};
  return {buffer.data(),
          std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::general, 9).ptr};
}

std::string text(const Eigen::Vector3d& v) {
  std::string result("[");
  result += text(v.x());
  for (const double value : {v.y(), v.z()}) {
    result += ", ";
    result += text(value);
  }
  result += "]";
  return result;
}

void set(std::string& out, const char* key, const std::string& value) {
  out += key;
  out += " = ";
  out += value;
  out += "\n";
}

std::string quoted(const std::string& value) {
  std::string result("\"");
  result += value;
  result += "\"";
  return result;
}

void append_tool(std::string& out, const DatasetOptions& options, const SceneFacts& facts) {
  out += "\n[[tool]]\n";
  if (!facts.tool_file.empty()) {
    set(out, "shape", "\"mesh\"");
    set(out, "surface", quoted(facts.tool_file));
    return;
  }
  static constexpr std::array<const char*, 3> names{"sphere", "punch", "capsule"};
  set(out, "shape", quoted(names[static_cast<std::size_t>(options.instrument)]));
  set(out, "radius", text(options.tool_radius));
  if (options.instrument == Instrument::punch) set(out, "length", text(4 * options.tool_radius));
  if (options.instrument == Instrument::capsule) set(out, "length", text(options.tool_length));
}

void append_region(std::string& out, const DatasetOptions& options, const EllipsoidFacts& region) {
  out += "\n[[region]]\n";
  set(out, "name", quoted(region.name));
  const bool ball = region.radii.isConstant(region.radii.x(), 0);
  set(out, ball ? "sphere" : "ellipsoid",
      "{center = " + text(region.centre) +
          (ball ? ", radius = " + text(region.radii.x()) : ", radii = " + text(region.radii)) + "}");
  if (region.tissue.empty()) {
    set(out, "young", text(region.young));
  } else {
    set(out, "tissue", quoted(region.tissue));
  }
  set(out, "poisson", text(options.poisson));
}

}  // namespace

std::string scene_text(const DatasetOptions& options, const SceneFacts& facts) {
  std::string out = "# Made by `palpate synth`. All keys: `palpate scene --reference`. Lengths in m, moduli in Pa.\n";
  out += "\n[body]\n";
  set(out, "surface", quoted(facts.organ_file));
  out += "\n[material]\n";
  if (facts.tissue.empty()) {
    set(out, "young", text(facts.young));
  } else {
    set(out, "tissue", quoted(facts.tissue));
  }
  set(out, "poisson", text(options.poisson));
  if (!facts.inclusion_file.empty()) {
    out += "\n[[region]]\n";
    set(out, "name", "\"inclusion\"");
    set(out, "surface", quoted(facts.inclusion_file));
    set(out, "young", text(options.inclusion_young));
    set(out, "poisson", text(options.poisson));
  }
  for (const EllipsoidFacts& region : facts.regions) append_region(out, options, region);
  for (const HalfSpace& support : facts.held) {
    out += "\n[[support]]\n";
    set(out, "half_space", "{point = " + text(support.point) + ", normal = " + text(support.normal) + "}");
  }
  if (facts.pressure > 0) {
    out += "\n[prestress]\n";
    set(out, "pressure", text(facts.pressure));
  }
  append_tool(out, options, facts);
  out += "\n[contact]\n";
  set(out, "friction", text(options.friction));
  out += "\n[sampling]\n";
  if (facts.spacing > 0) set(out, "spacing", text(facts.spacing));
  if (facts.uniform && facts.spacing > 0) set(out, "margin_spacing", text(facts.spacing));
  set(out, "depth", text(options.depth));
  if (facts.sampled_box) {
    set(out, "within_box",
        "{min = " + text(facts.sampled_box->first) + ", max = " + text(facts.sampled_box->second) + "}");
  }
  return out;
}

}  // namespace palpate::synth
