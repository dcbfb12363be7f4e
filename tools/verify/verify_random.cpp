// SPDX-License-Identifier: GPL-3.0-or-later
// `palpate verify --battery random`.
#include "formats/io/error.hpp"
#include "precompute/verify/battery/random_battery.hpp"
#include "precompute/verify/battery/random_cells.hpp"
#include "tools/bench/tick_bench.hpp"
#include "tools/cli/output.hpp"
#include "tools/verify/verify_battery.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

namespace palpate::cli {
namespace {

using Json = nlohmann::ordered_json;

// Bounds of a run's figures.
struct Bounds {
  double coverage = 0.95;       // least share of forces whose error is at most their estimate
  double ratio = 5.0;           // largest median of estimate over error
  double refused_sound = 0.01;  // largest share of cells
  double seconds = 30.0;        // of processor time a cell
  double megabytes = 1000.0;    // a cell
};

constexpr verify::Verdict kVerdicts[] = {verify::Verdict::right, verify::Verdict::wrong, verify::Verdict::refused,
                                         verify::Verdict::refused_sound, verify::Verdict::open};

Json to_json(const verify::Spread& s) { return {{"median", s.median}, {"p95", s.p95}, {"worst", s.worst}}; }

Json to_json(const verify::BatteryCell& cell, const verify::JudgedCell& judged, std::uint64_t seed) {
  Json json{{"seed", seed},
            {"body", cell.family},
            {"cell", cell.name},
            {"verdict", verify::verdict_name(judged.verdict)},
            {"excess", judged.excess},
            {"seconds", judged.solve.processor},
            {"megabytes", judged.solve.megabytes},
            {"nodes", judged.solve.nodes},
            {"reference_seconds", judged.reference_seconds},
            {"reference_nodes", judged.reference_nodes}};
  if (!judged.solve.cause.empty()) json["cause"] = judged.solve.cause;
  if (!judged.reference_cause.empty()) json["reference_cause"] = judged.reference_cause;
  for (const verify::JudgedSample& s : judged.samples) {
    json["errors"].push_back(s.error);
    json["estimates"].push_back(s.estimate);
  }
  for (const Sample& s : judged.reference) {
    json["reference"].push_back({{"kind", static_cast<int>(s.kind)},
                                 {"deflection", {s.deflection.x(), s.deflection.y(), s.deflection.z()}},
                                 {"force", {s.force.x(), s.force.y(), s.force.z()}}});
  }
  return json;
}

std::string row(const char* name, const char* unit, double scale, const verify::Spread& s) {
  return fmt::format("| {}{} | {:.3g} | {:.3g} | {:.3g} |\n", name, unit, scale * s.median, scale * s.p95,
                     scale * s.worst);
}

std::string table(const verify::RandomFigures& f, const std::vector<verify::BatteryCell>& cells,
                  const std::vector<verify::JudgedCell>& judged) {
  std::string text = "| verdict | cells |\n|---|---|\n";
  for (const verify::Verdict v : kVerdicts) {
    const auto at = f.verdicts.find(v);
    text += fmt::format("| {} | {} |\n", verify::verdict_name(v), at != f.verdicts.end() ? at->second : 0);
  }
  text += "\n| figure | median | 95th percentile | worst |\n|---|---|---|---|\n";
  text += row("true error of a force", ", %", 100, f.error) + row("own estimate", ", %", 100, f.estimate) +
          row("estimate over error", "", 1, f.ratio) + row("a cell's processor time", ", s", 1, f.seconds) +
          row("a cell's peak memory", ", MB", 1, f.megabytes);
  text += fmt::format("\nThe estimate covers {:.1f} % of {} forces.\n", 100 * f.coverage(), f.samples);
  std::string notes;
  for (std::size_t k = 0; k < judged.size(); ++k) {
    const verify::JudgedCell& j = judged[k];
    if (j.verdict == verify::Verdict::right) continue;
    notes += fmt::format("- {}, {} {}: ", verify::verdict_name(j.verdict), cells[k].family, cells[k].name);
    notes += j.verdict == verify::Verdict::wrong  ? fmt::format("{:.2f} of what is allowed", j.excess)
             : j.verdict == verify::Verdict::open ? "the finer mesh: " + j.reference_cause
                                                  : j.solve.cause;
    notes += "\n";
  }
  return notes.empty() ? text : text + "\n" + notes;
}

// The bounds that a run breaks; empty: none.
std::string broken(const verify::RandomFigures& f) {
  const Bounds bounds;
  std::string all;
  const auto add = [&](bool is, const std::string& what) {
    if (is) all += (all.empty() ? "" : "; ") + what;
  };
  const auto count = [&](verify::Verdict v) {
    const auto at = f.verdicts.find(v);
    return at != f.verdicts.end() ? at->second : std::size_t{0};
  };
  add(count(verify::Verdict::wrong) > 0, fmt::format("{} cells are wrong, allowed 0", count(verify::Verdict::wrong)));
  const double refused = double(count(verify::Verdict::refused_sound)) / double(f.cells);
  add(refused > bounds.refused_sound, fmt::format("{:.1f} % of the cells are refused though sound, allowed {:.1f} %",
                                                  100 * refused, 100 * bounds.refused_sound));
  add(f.samples > 0 && f.coverage() < bounds.coverage,
      fmt::format("the estimate covers {:.1f} % of the forces, wanted {:.0f} %", 100 * f.coverage(),
                  100 * bounds.coverage));
  add(f.ratio.median > bounds.ratio, fmt::format("the estimate is {:.1f} times the error at the median, allowed {:.0f}",
                                                 f.ratio.median, bounds.ratio));
  add(f.seconds.worst > bounds.seconds,
      fmt::format("a cell takes {:.0f} s, allowed {:.0f}", f.seconds.worst, bounds.seconds));
  add(f.megabytes.worst > bounds.megabytes,
      fmt::format("a cell takes {:.0f} MB, allowed {:.0f}", f.megabytes.worst, bounds.megabytes));
  return all;
}

}  // namespace

void run_random_command(const BatteryCommand& command, const Globals& globals) {
  std::vector<verify::BatteryCell> cells = verify::random_cells(command.seed, command.first - 1 + command.count);
  cells.erase(cells.begin(), cells.begin() + (command.first - 1));
  std::erase_if(cells, [&](const verify::BatteryCell& cell) {
    return (!command.family.empty() && cell.family != command.family) ||
           cell.name.find(command.cells) == std::string::npos;
  });
  if (cells.empty()) {
    throw Error(ExitCode::usage, "no such cell; the families are: block, slab, ball, ellipsoid");
  }
  std::ofstream lines;
  if (!command.report.empty()) lines.open(command.report);
  verify::RandomBatteryOptions options;
  options.threads = static_cast<unsigned>(globals.threads);
  std::vector<verify::JudgedCell> judged(cells.size());
  std::size_t done = 0;
  verify::run_random_battery(cells, options, [&](std::size_t k, const verify::JudgedCell& cell) {
    judged[k] = cell;
    if (lines.is_open()) lines << to_json(cells[k], cell, command.seed).dump() << std::endl;
    note(globals, fmt::format("{} of {}: {}", ++done, cells.size(), verify::verdict_name(cell.verdict)));
  });
  if (lines.is_open() && !lines) throw Error(ExitCode::io, command.report + ": cannot be written");

  const verify::RandomFigures f = verify::random_figures(judged);
  if (globals.json) {
    Json json{{"battery", "random"},
              {"machine", machine_name()},
              {"seed", command.seed},
              {"cells", f.cells},
              {"verdicts", Json::object()},
              {"forces", f.samples},
              {"coverage", f.coverage()},
              {"error", to_json(f.error)},
              {"estimate", to_json(f.estimate)},
              {"estimate_over_error", to_json(f.ratio)},
              {"seconds", to_json(f.seconds)},
              {"megabytes", to_json(f.megabytes)}};
    for (const auto& [verdict, count] : f.verdicts) json["verdicts"][verify::verdict_name(verdict)] = count;
    print_json(json);
  } else {
    print(
        fmt::format("Random battery, seed {}: {} contacts at default settings, judged by a mesh of half the edges and "
                    "half the growth;\nwrong: off by more than {:.0f} % and than {:.0f} times the own estimate.\n\n",
                    command.seed, f.cells, 100 * options.tolerance, options.estimates) +
        table(f, cells, judged));
  }
  if (const std::string what = broken(f); !what.empty()) throw Error(ExitCode::tolerance, what);
}

}  // namespace palpate::cli
