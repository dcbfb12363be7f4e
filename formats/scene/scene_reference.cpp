// SPDX-License-Identifier: MIT
// Texts made from the table of keys: the reference for users and the canonical text for content hashes.
#include "formats/scene/scene.hpp"
#include "formats/scene/scene_keys.hpp"

namespace palpate {

namespace {

using namespace scene_io;

/// Appends one section of the reference; lines of a section that is not there by default are commented out.
template <class T>
void append_reference(std::string& text, const std::string& header, const std::string& help, const Keys<T>& keys,
                      const T& defaults, bool present) {
  if (!header.empty()) text += "\n# " + help + "\n" + (present ? "" : "# ") + header + "\n";
  for (const Key<T>& key : keys) {
    std::string value = key.show(defaults);
    const bool set = present && !value.empty();
    if (value.empty()) value = key.example;
    text += "#   " + key.help + " Allowed: " + key.allowed + ".\n";
    text += (set ? "" : "# ") + key.name + " = " + value + "\n";
  }
}

template <class T>
void append_canonical(std::string& text, const std::string& section, const Keys<T>& keys, const T& values,
                      bool only_solves) {
  for (const Key<T>& key : keys) {
    if (key.affects == Affects::nothing || (only_solves && key.affects != Affects::solves)) continue;
    const std::string value = key.show(values);
    if (!value.empty()) text += section + "." + key.name + " = " + value + "\n";
  }
}

}  // namespace

std::string scene_reference() {
  Scene scene;
  scene.body.surfaces.emplace_back().file = "FILE";
  std::string text =
      "# Every key of a Palpate scene, with its default. Lengths in m, moduli in Pa.\n"
      "# Lines that begin with '# ' are left out by default. Only [body] surface (or labels) is required.\n\n";
  append_reference(text, "", "", scene_keys(), scene, true);
  append_reference(text, "[body]", "The organ.", body_keys(), scene.body, true);
  append_reference(text, "[material]", "The organ's material; a law has the keys that name it, and no others.",
                   material_keys(), scene.material, true);
  append_reference(text, "[[region]]", "An inclusion with its own material; any number of them.", region_keys(), {},
                   false);
  append_reference(text, "[[cavity]]", "A hollow inside the organ; any number of them.", cavity_keys(), {}, false);
  append_reference(text, "[[support]]",
                   "Supports of the organ, exactly one place each; any number of them. None: the lowest tenth along z.",
                   support_keys(), {}, false);
  append_reference(text, "[prestress]",
                   "Loads on the organ before an instrument touches it: they are solved first, and contact "
                   "starts from there.",
                   prestress_keys(), scene.prestress, true);
  append_reference(text, "[[tool]]",
                   "An instrument; any number of them. Keys that do not belong to its shape are errors.", tool_keys(),
                   {}, false);
  append_reference(text, "[contact]", "Contact of instrument and organ.", contact_keys(), scene, true);
  append_reference(text, "[sampling]", "Sites and depths of the solves.", sampling_keys(), scene.sampling, true);
  append_reference(text, "[response]", "The response fitted to the solves.", response_keys(), scene.response, true);
  append_reference(text, "[solver]", "Meshes and limits of the solves.", solver_keys(), scene.solver, true);
  append_reference(text, "[compliance]",
                   "Contacts near each other on one organ feel each other. Left out: their forces are added.",
                   compliance_keys(), scene.compliance, false);
  append_reference(text, "[sources]", "Responses of sites without a recording and without a law.", sources_keys(),
                   SceneSources{}, true);
  append_reference(text, "[[measured]]",
                   "A recording with a real tool; any number of them. At the sites nearest to it, it replaces "
                   "the solves.",
                   measured_keys(), {}, false);
  append_reference(text, "[[analytic]]",
                   "A closed form in place of solves; any number of them. It holds where all of within_box, mesh and "
                   "sites that are given do, left out: everywhere.",
                   analytic_keys(), {}, false);
  return text;
}

std::string canonical_text(const Scene& scene, CanonicalScope scope) {
  const bool only_solves = scope == CanonicalScope::solves;
  std::string text;
  // Per file, since the keys of [body] speak of one file only.
  for (const SurfaceSource& source : scene.body.surfaces) {
    text += "body.surface.unit = " + show(source.unit) + "\n";
    text += "body.surface.meshes = " + show(source.meshes) + "\n";
  }
  if (scene.frame != Frame::unstated) text += scene.frame == Frame::lps ? "frame = LPS\n" : "frame = RAS\n";
  BodyScene body = scene.body;
  body.labels.file.clear();
  append_canonical(text, "body", body_keys(), body, only_solves);
  MaterialScene material = scene.material;
  material.centreline.file.clear();
  append_canonical(text, "material", material_keys(), material, only_solves);
  for (const RegionScene& region : scene.regions) {
    text += "[region]\n";
    RegionScene without_path = region;
    without_path.material.centreline.file.clear();
    without_path.labels.file.clear();
    append_canonical(text, "region", region_keys(), without_path, only_solves);
  }
  for (const CavityScene& cavity : scene.cavities) {
    text += "[cavity]\n";
    CavityScene without_path = cavity;
    without_path.labels.file.clear();
    append_canonical(text, "cavity", cavity_keys(), without_path, only_solves);
  }
  for (const SupportScene& support : scene.supports) {
    text += "[support]\n";
    SupportScene without_path = support;
    without_path.other.file.clear();
    append_canonical(text, "support", support_keys(), without_path, only_solves);
  }
  append_canonical(text, "prestress", prestress_keys(), scene.prestress, only_solves);
  for (const ToolScene& tool : scene.tools) {
    text += "[tool]\n";
    append_canonical(text, "tool", tool_keys(), tool, only_solves);
  }
  append_canonical(text, "contact", contact_keys(), scene, only_solves);
  append_canonical(text, "sampling", sampling_keys(), scene.sampling, only_solves);
  // The name of the line is that of earlier programs, so that their work folders stay valid.
  if (only_solves && scene.friction > 0) text += "sampling.coupled = " + show(scene.response.path_share) + "\n";
  append_canonical(text, "response", response_keys(), scene.response, only_solves);
  append_canonical(text, "solver", solver_keys(), scene.solver, only_solves);
  append_canonical(text, "compliance", compliance_keys(), scene.compliance, only_solves);
  return text;
}

std::vector<std::string> earlier_canonical_texts(const Scene& scene) {
  constexpr int kDepths = SamplingScene{}.tangential_depths, kEarlierDepths = 2;
  std::vector<std::string> texts;
  for (const bool fewer : {false, true}) {
    if (fewer && scene.sampling.tangential_depths != kDepths) continue;
    Scene earlier = scene;
    if (fewer) earlier.sampling.tangential_depths = kEarlierDepths;
    const std::string text = canonical_text(earlier, CanonicalScope::solves);
    const auto line = text.find("sampling.coupled = ");
    if (fewer) texts.push_back(text);
    if (line == std::string::npos) continue;
    texts.push_back(text.substr(0, line) + text.substr(text.find('\n', line) + 1));
  }
  return texts;
}

std::string canonical_text(const SceneSources& sources) {
  std::string text;
  if (sources.measured.empty() && sources.analytic.empty()) return text;
  append_canonical(text, "sources", sources_keys(), sources, false);
  for (const MeasuredScene& measured : sources.measured) {
    text += "[measured]\n";
    append_canonical(text, "measured", measured_keys(), measured, false);
  }
  for (const AnalyticScene& analytic : sources.analytic) {
    text += "[analytic]\n";
    append_canonical(text, "analytic", analytic_keys(), analytic, false);
  }
  return text;
}

}  // namespace palpate
