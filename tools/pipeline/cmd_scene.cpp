// SPDX-License-Identifier: GPL-3.0-or-later
// palpate scene: checks a scene file, proposes one for an organ's file, or prints the reference of all keys or the
// tissues that it may name.
#include "formats/io/error.hpp"
#include "formats/io/file.hpp"
#include "formats/scene/scene.hpp"
#include "formats/scene/tissues.hpp"
#include "precompute/surface/propose.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/commands.hpp"
#include "tools/cli/output.hpp"

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

namespace palpate::cli {

namespace {

/// Files that the scene names and that are not there, found before hours of work rather than after.
void check_files(const Scene& scene) {
  for (const std::filesystem::path& file : files_of(scene)) {
    std::error_code error;
    if (std::filesystem::is_regular_file(file, error)) continue;
    const bool there = std::filesystem::exists(file, error);
    throw Error(ExitCode::io, file.string() + ": named by " + scene.file.string() +
                                  (there ? ", but it is no regular file" : ", but there is no such file"));
  }
}

std::string tissues_text() {
  std::string text;
  for (const Tissue& tissue : tissues()) {
    char line[300];
    std::snprintf(line, sizeof line, "%-14s shear modulus %6.0f Pa   %s\n", tissue.name, tissue.shear, tissue.source);
    text += line;
  }
  return text;
}

nlohmann::ordered_json tissues_json() {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Tissue& tissue : tissues()) {
    list.push_back({{"name", tissue.name}, {"shear_modulus", tissue.shear}, {"source", tissue.source}});
  }
  return {{"tissues", list}};
}

void run_scene(const std::string& file, const Globals& globals) {
  const Scene scene = read_scene(file);
  check_files(scene);
  if (!globals.json) {
    print(file + ": good\n" + canonical_text(scene));
    return;
  }
  nlohmann::ordered_json document;
  document["scene"] = file;
  document["name"] = scene.name;
  document["friction"] = scene.friction;
  document["regions"] = scene.regions.size();
  document["supports"] = scene.supports.size();
  for (const ToolScene& tool : scene.tools) document["tools"].push_back(tool.name);
  document["settings"] = canonical_text(scene);
  print_json(document);
}

void run_from(const std::string& from, const std::string& out, const Globals& globals) {
  std::filesystem::path folder;
  if (!out.empty()) {
    std::error_code error;
    // It may be a proposal that somebody has edited since, or one of the organs.
    if (std::filesystem::is_regular_file(out, error)) {
      throw Error(ExitCode::usage,
                  out + ": exists; a proposal replaces no file: give --out another name, or remove it");
    }
    check_writable(out);
    folder = std::filesystem::absolute(std::filesystem::path(out)).parent_path();
  }
  const surface::Proposal proposal = surface::propose_scene(from, folder);
  if (!out.empty()) write_file(out, proposal.scene);
  if (!globals.json) {
    print(out.empty() ? proposal.scene : out + "\n");
    if (!out.empty()) note(globals, "Next: palpate mesh " + shell_word(out));
    return;
  }
  nlohmann::ordered_json document{{"from", from}, {"scene", proposal.scene}};
  if (!out.empty()) document["written"] = out;
  for (const surface::Found& found : proposal.found) {
    nlohmann::ordered_json entry{{"name", found.name},
                                 {"role", found.role},
                                 {"volume", found.volume},
                                 {"extents", {found.extents[0], found.extents[1], found.extents[2]}}};
    if (!found.reason.empty()) entry["reason"] = found.reason;
    document["found"].push_back(entry);
  }
  print_json(document);
}

}  // namespace

void add_scene(CLI::App& app, Globals& globals) {
  struct Arguments {
    std::string file, from, out;
    bool reference = false, tissues = false;
  };
  auto arguments = std::make_shared<Arguments>();
  Command command(app, "scene",
                  "Checks a scene file, proposes one for an organ's file, or prints the reference of all keys");
  Option file = command.option("scene", arguments->file, "Scene file");
  Option reference =
      command.flag("--reference", arguments->reference, "Print every key with default, range and help, as TOML");
  Option tissues =
      command.flag("--tissues", arguments->tissues, "Print the tissues that a material may name, with sources");
  Option from = command.option("--from", arguments->from,
                               "Propose a scene: a surface file, a label image, or a folder with one organ a file");
  command
      .option("--out", arguments->out, "With --from: the scene file to write, not there yet; default: standard output")
      .needs("--from");
  file.excludes(reference).excludes(tissues).excludes(from);
  command.runs([arguments, &globals] {
    if (arguments->reference) {
      return globals.json ? print_json({{"reference", scene_reference()}}) : print(scene_reference());
    }
    if (arguments->tissues) return globals.json ? print_json(tissues_json()) : print(tissues_text());
    if (!arguments->from.empty()) return run_from(arguments->from, arguments->out, globals);
    if (arguments->file.empty()) throw Error(ExitCode::usage, "scene is required");
    run_scene(arguments->file, globals);
  });
}

}  // namespace palpate::cli
