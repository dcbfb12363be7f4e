// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/verify/verify_battery.hpp"

#include "formats/io/error.hpp"
#include "precompute/verify/battery/battery.hpp"
#include "precompute/verify/battery/stiff_cells.hpp"
#include "tools/bench/tick_bench.hpp"
#include "tools/cli/output.hpp"
#include "tools/cli/verify_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

namespace palpate::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kCore = 0.9, kOverall = 0.7;

std::vector<std::string> families_of(const std::vector<verify::BatteryCell>& cells) {
  std::vector<std::string> names;
  for (const verify::BatteryCell& cell : cells) {
    if (std::find(names.begin(), names.end(), cell.family) == names.end()) names.push_back(cell.family);
  }
  return names;
}

// The gate's name: what a refusal has before its figures.
std::string gate_of(const std::string& cause) {
  std::string gate = cause.substr(0, cause.find_first_of(":("));
  // Figures, like "no convergence in 100 iterations at ...", are no part of it.
  gate = gate.substr(0, gate.find_first_of("0123456789"));
  for (const char* place : {" at depth", " in the push"}) gate = gate.substr(0, gate.find(place));
  while (!gate.empty() && gate.back() == ' ') gate.pop_back();
  return gate.empty() ? cause : gate;
}

Json to_json(const verify::BatteryFigures& f) {
  return {{"cells", f.cells},       {"converged", f.converged},
          {"core", f.core},         {"core_converged", f.core_converged},
          {"verified", f.verified}, {"by_augmented_lagrange", f.augmented},
          {"wrong", f.wrong},       {"unchecked", f.unchecked},
          {"compared", f.compared}, {"within_estimate", f.within_estimate},
          {"slowest_s", f.slowest}};
}

Json to_json(const verify::BatteryCell& cell, const verify::CellResult& result) {
  Json json{{"family", cell.family}, {"cell", cell.name}, {"core", cell.core}, {"converged", result.accepted}};
  if (!result.cause.empty()) json["cause"] = result.cause;
  if (!result.samples.empty()) {
    double force = 0;
    for (const Sample& s : result.samples) {
      if (s.kind == SampleKind::normal) force = s.force.z();
    }
    json["force_N"] = force;
  }
  json["seconds"] = result.seconds;
  json["nodes"] = result.nodes;
  if (result.difference) {
    json["difference"] = *result.difference;
    json["checked_by"] = result.augmented ? "augmented Lagrange" : "finer mesh";
  }
  if (!result.check_cause.empty()) json["check_cause"] = result.check_cause;
  return json;
}

std::string row(const std::string& name, const verify::BatteryFigures& f) {
  return fmt::format("| {} | {} | {} | {} of {} | {} | {} | {} | {} | {:.1f} |\n", name, f.cells, f.converged,
                     f.core_converged, f.core, f.verified, f.augmented, f.wrong, f.unchecked, f.slowest);
}

}  // namespace

void run_battery_command(const BatteryCommand& command, const Globals& globals) {
  if (command.battery == "random") return run_random_command(command, globals);
  std::vector<verify::BatteryCell> cells = verify::stiff_cells();
  const std::vector<std::string> families = families_of(cells);
  const bool all_cells = command.family.empty() && command.cells.empty();
  std::erase_if(cells, [&](const verify::BatteryCell& cell) {
    return (!command.family.empty() && cell.family != command.family) ||
           cell.name.find(command.cells) == std::string::npos;
  });
  if (cells.empty()) {
    std::string known;
    for (const std::string& name : families) known += (known.empty() ? "" : ", ") + name;
    throw Error(ExitCode::usage, "no such cell; the families are: " + known);
  }
  verify::BatteryOptions options;
  options.seed = command.seed;
  options.threads = static_cast<unsigned>(globals.threads);
  options.progress = [&](std::size_t done, std::size_t total) {
    if (done == total || done % 10 == 0)
      note(globals, "cells: " + std::to_string(done) + " of " + std::to_string(total));
  };
  const verify::BatteryResult result = verify::run_battery(cells, options);

  const verify::BatteryFigures all = verify::battery_figures(cells, result, options.tolerance);
  Json json{{"battery", "stiff"},   {"machine", machine_name()},
            {"seed", command.seed}, {"tolerance", options.tolerance},
            {"all", to_json(all)},  {"families", Json::object()}};
  std::string text = fmt::format(
      "Stiff battery, seed {}: {} cells, none may take longer than {:.0f} s; verified: within {:.0f} % of elements at "
      "most 0.6 times as\nlarge or, where these are not solved, of the augmented-Lagrange solve (AL).\n\n",
      command.seed, all.cells, options.limit, 100 * options.tolerance);
  text +=
      "| family | cells | converged | of the core range | verified | of these by AL | wrong | not checked | slowest, s "
      "|\n|---|---|---|---|---|---|---|---|---|\n";
  for (const std::string& name : families) {
    const verify::BatteryFigures f = verify::battery_figures(cells, result, options.tolerance, name);
    if (f.cells == 0) continue;
    json["families"][name] = to_json(f);
    text += row(name, f);
  }
  text += row("all", all) + "\n| refused by | cells |\n|---|---|\n";
  std::map<std::string, int> causes;
  std::string wrong, unchecked;
  json["cells"] = Json::array();
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const verify::CellResult& cell = result.cells[k];
    json["cells"].push_back(to_json(cells[k], cell));
    if (!cell.accepted) ++causes[gate_of(cell.cause)];
    if (!cell.difference && !cell.check_cause.empty())
      unchecked += "- " + cells[k].family + ", " + cells[k].name + ": " + cell.check_cause + "\n";
    if (!cell.difference || *cell.difference <= options.tolerance) continue;
    wrong += fmt::format("- {}, {}: off by {:.1f} %\n", cells[k].family, cells[k].name, 100 * *cell.difference);
  }
  for (const auto& [cause, count] : causes) text += "| " + cause + " | " + std::to_string(count) + " |\n";
  if (all.compared > 0) {
    text +=
        fmt::format("\nOf {} samples of checked cells {:.0f} % differ by no more than the error estimates of both.\n",
                    all.compared, 100.0 * double(all.within_estimate) / double(all.compared));
  }
  if (!wrong.empty()) text += "\nWrong:\n" + wrong;
  if (!unchecked.empty()) text += "\nNot checked:\n" + unchecked;
  if (!command.report.empty()) write_report(command.report, json);
  if (globals.json) {
    print_json(json);
  } else {
    print(text);
  }
  if (all.wrong > 0) throw Error(ExitCode::tolerance, std::to_string(all.wrong) + " cells differ from their checks");
  if (all.slowest > options.limit) {
    throw Error(ExitCode::tolerance, fmt::format("a cell took {:.0f} s, allowed {:.0f}", all.slowest, options.limit));
  }
  const bool few =
      double(all.core_converged) < kCore * double(all.core) || double(all.converged) < kOverall * double(all.cells);
  if (double(all.verified) < options.verified_share * double(all.converged)) {
    throw Error(ExitCode::tolerance, fmt::format("{} of {} converged cells are verified, wanted {:.0f} %", all.verified,
                                                 all.converged, 100 * options.verified_share));
  }
  if (all_cells && few) {
    throw Error(ExitCode::tolerance, "fewer than 90 % of the core range or 70 % of all cells converged");
  }
}

}  // namespace palpate::cli
