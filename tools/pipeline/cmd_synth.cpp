// SPDX-License-Identifier: GPL-3.0-or-later
// palpate synth: writes a synthetic organ with scene and motion.
#include "datasets-synthetic/dataset.hpp"
#include "formats/io/error.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/commands.hpp"
#include "tools/cli/output.hpp"

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

namespace palpate::cli {

namespace {

// In the order of the enumerators.
const std::vector<std::string> kOrgans{"slab", "ball", "liver", "kidney", "bladder", "sheet"};
const std::vector<std::string> kInstruments{"sphere", "punch", "capsule", "stylus"};
const std::vector<std::string> kMotions{"probe", "scan"};

// The options that make an inclusion.
constexpr const char* kOfInclusion[] = {"--inclusion-radius", "--inclusion-gap", "--inclusion-young"};

struct SynthArguments {
  synth::DatasetOptions options;
  std::string folder, organ, instrument = kInstruments[0], motion = kMotions[0];
};

template <class E>
E enumerator(const std::vector<std::string>& names, const std::string& name) {
  return static_cast<E>(std::find(names.begin(), names.end(), name) - names.begin());
}

void run_synth(const SynthArguments& arguments, const Globals& globals) {
  synth::DatasetOptions options = arguments.options;
  options.organ = enumerator<synth::Organ>(kOrgans, arguments.organ);
  options.instrument = enumerator<synth::Instrument>(kInstruments, arguments.instrument);
  options.motion = enumerator<synth::MotionKind>(kMotions, arguments.motion);
  const auto files = synth::write_dataset(options, arguments.folder);
  if (globals.json) {
    nlohmann::ordered_json document;
    document["scene"] = files[0].string();
    document["motion"] = files[1].string();
    for (const auto& file : files) document["files"].push_back(file.string());
    print_json(document);
    return;
  }
  for (const auto& file : files) print(file.string() + "\n");
  note(globals, "Next: palpate build " + shell_word(files[0].string()));
}

}  // namespace

void add_synth(CLI::App& app, Globals& globals) {
  auto arguments = std::make_shared<SynthArguments>();
  synth::DatasetOptions& o = arguments->options;
  Command command(app, "synth", "Writes a synthetic organ with scene and motion, from a seed");

  command
      .option("organ", arguments->organ,
              "slab, ball, liver, kidney (with its pyramids), bladder or sheet (held at two ends)")
      .required()
      .check(one_of(kOrgans))
      .named("ORGAN");
  command.option("--out", arguments->folder, "Folder to write to; created when missing").required();
  command.option("--seed", o.seed, "Seed of the liver's shape and of the probed place").shows_default();
  command.option("--scale", o.scale, "Size of the organ, 1: adult").check(number_in(0.1, 10.0)).shows_default();
  const Check length = number_in(1e-4, 1.0);
  command.option("--edge", o.edge, "Edge length of the organ's surface (m)").check(length);
  command.option("--young", o.young, "Young's modulus (Pa); left out: the organ's").check(number_in(1e-3, 1e12));
  command.option("--poisson", o.poisson, "Poisson's ratio").check(number_in(0.0, 0.4999)).shows_default();
  command.flag("--inclusion", o.inclusion, "With a stiff ball inside");
  command.option(kOfInclusion[0], o.inclusion_radius, "Its radius (m)").check(length);
  command.option(kOfInclusion[1], o.inclusion_gap, "Tissue over it (m)").check(length);
  command.option(kOfInclusion[2], o.inclusion_young, "Its modulus (Pa)").check(number_in(1e-3, 1e12)).shows_default();
  command.flag("--tumour", o.tumour, "liver: with an inclusion, a tumour; both tissues have published stiffnesses");
  command.option("--pressure", o.pressure, "bladder: pressure inside (Pa)").check(number_in(0.0, 1e9)).shows_default();
  command.option("--tool", arguments->instrument, "sphere, punch, capsule or stylus")
      .check(one_of(kInstruments))
      .named("TOOL")
      .shows_default();
  command.flag("--tool-mesh", o.instrument_as_mesh,
               "Write the instrument as a closed mesh (sphere, capsule; a stylus always is one)");
  command.option("--tool-radius", o.tool_radius, "Radius of the tip (m)").check(length).shows_default();
  command.option("--tool-length", o.tool_length, "Length of capsule or stylus (m)").check(length).shows_default();
  command.option("--friction", o.friction, "Coulomb coefficient").check(number_in(0.0, 2.0)).shows_default();
  command.option("--spacing", o.spacing, "Edge length of the body's patches (m); 0: automatic sampling")
      .check(number_in(0.0, 1.0));
  command.option("--depth", o.depth, "Deepest push (m)").check(length).shows_default();
  command.option("--motion", arguments->motion, "probe or scan")
      .check(one_of(kMotions))
      .named("MOTION")
      .shows_default();
  command.option("--rate", o.motion_rate, "Rows of the motion a second").check(number_in(1.0, 1e4)).shows_default();
  command.runs([arguments, command, &globals] {
    synth::DatasetOptions& options = arguments->options;
    options.inclusion = options.inclusion || options.tumour;
    for (const char* option : kOfInclusion) {
      if (command.given(option) && !options.inclusion) {
        throw Error(ExitCode::usage, std::string(option) + " belongs to --inclusion or --tumour");
      }
    }
    run_synth(*arguments, globals);
  });
}

}  // namespace palpate::cli
