// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/verify/verify_ccx.hpp"

#include "formats/io/error.hpp"
#include "precompute/verify/ccx/ccx_compare.hpp"
#include "precompute/verify/error_time.hpp"
#include "tools/bench/tick_bench.hpp"
#include "tools/cli/interrupt.hpp"
#include "tools/cli/output.hpp"
#include "tools/cli/verify_checks.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

namespace palpate::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kSameMesh = 0.01, kFinerMesh = 0.02;
constexpr double kSettings = 0.0025;  // what a setting counts as converged with: a quarter of what is allowed
constexpr double kFaster = 40;

// Element sizes: the first three are timed, the last one has CalculiX on a quarter of the block.
const std::vector<double> kSizes{std::numbers::sqrt2, 1.0, std::numbers::sqrt2 / 2, 0.5};
constexpr std::size_t kBase = 1, kFine = 3;

struct Outcome {
  verify::CcxSolve plain;              // ours, the plain element, on the base mesh
  std::vector<verify::CcxSolve> ours;  // the default element, per size
  std::vector<verify::CcxSolve> ccx;   // per size
  double meshing = 0.0;        // s, of the base mesh
};

class Comparison {
public:
  Comparison(const CcxCommand& command, const Globals& globals) : globals_(globals), ccx_(verify::find_ccx()) {
    if (ccx_.empty()) {
      throw Error(ExitCode::io, "no ccx in PATH; on Debian: apt-get install --no-install-recommends calculix-ccx");
    }
    for (verify::CcxCase& c : verify::ccx_cases()) {
      if (c.name.find(command.cases) != std::string::npos) cases_.push_back(std::move(c));
    }
    if (cases_.empty()) throw Error(ExitCode::usage, "--case " + command.cases + ": no case has this in its name");
  }

  void run() {
    for (const verify::CcxCase& c : cases_) outcomes_.push_back(solve(c));
    forces();
    settings();
    times();
  }

  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] const Json& json() const { return json_; }

  void judge() const {
    const auto beyond = [](const char* what, double change) {
      return fmt::format("{} changes a force by {:.2f} %, allowed {:.2f}", what, 100 * change, 100 * kSettings);
    };
    if (!(changed_ <= kSettings)) throw Error(ExitCode::tolerance, beyond("a finer setting", changed_));
    if (!(same_ <= kSameMesh)) throw Error(ExitCode::tolerance, off("on the same mesh", same_, kSameMesh));
    if (!(finer_ <= kFinerMesh)) throw Error(ExitCode::tolerance, off("against the finer mesh", finer_, kFinerMesh));
    if (!(least_ratio_ >= kFaster)) {
      throw Error(ExitCode::tolerance,
                  fmt::format("at equal error {:.0f} times as fast as CalculiX, wanted {:.0f}", least_ratio_, kFaster));
    }
  }

private:
  static std::string off(const char* where, double difference, double limit) {
    return fmt::format("forces differ from CalculiX' by {:.2f} % {}, allowed {:.0f} %", 100 * difference, where,
                       100 * limit);
  }

  verify::CcxSolve checked(verify::CcxSolve solve, const verify::CcxCase& c, const char* who) const {
    note(globals_, fmt::format("{}: {}, {} nodes, {:.1f} s{}", c.name, who, solve.nodes, solve.seconds,
                               solve.cause.empty() ? "" : ": " + solve.cause));
    if (interrupted()) throw Interrupted("no comparison is kept; run the command again");
    if (solve.forces.empty()) throw Error(ExitCode::numerical, c.name + ": " + who + ": " + solve.cause);
    return solve;
  }

  Outcome solve(const verify::CcxCase& c) {
    Outcome outcome;
    for (std::size_t k = 0; k < kSizes.size(); ++k) {
      const verify::CcxMesh mesh = verify::ccx_mesh(c, kSizes[k], settings_);
      if (k == kBase) {
        outcome.plain = checked(verify::solve_ours(c, mesh, true, settings_), c, "ours, plain element");
        outcome.meshing = mesh.seconds;
      }
      outcome.ours.push_back(checked(verify::solve_ours(c, mesh, false, settings_), c, "ours"));
      const bool quarter = k == kFine;
      const verify::CcxMesh part = quarter ? verify::ccx_mesh(c, kSizes[k], settings_, true) : verify::CcxMesh{};
      outcome.ccx.push_back(checked(verify::solve_ccx(ccx_, c, quarter ? part : mesh, settings_), c,
                                    quarter ? "CalculiX on a quarter" : "CalculiX"));
    }
    return outcome;
  }

  void forces() {
    text_ = fmt::format(
        "{}\n\nForces (mN). Same mesh: ten-node tetrahedra without a mean dilatation on both sides. Finer mesh: our "
        "default\nelement on that mesh against CalculiX with elements half as large.\n\n"
        "| case | depth, mm | ours, plain | ccx, same mesh | difference | ours, default | ccx, finer mesh | difference "
        "|\n|---|---|---|---|---|---|---|---|\n",
        machine_name());
    json_ = {{"machine", machine_name()}, {"cases", Json::array()}};
    for (std::size_t k = 0; k < cases_.size(); ++k) {
      const verify::CcxCase& c = cases_[k];
      const Outcome& o = outcomes_[k];
      const verify::CcxSolve &same = o.ccx[kBase], &fine = o.ccx[kFine], &ours = o.ours[kBase];
      for (std::size_t d = 0; d < c.depths.size(); ++d) {
        text_ += fmt::format("| {} | {:.2f} | {:.3f} | {:.3f} | {:.2f} % | {:.3f} | {:.3f} | {:.2f} % |\n", c.name,
                             1e3 * c.depths[d], 1e3 * o.plain.forces[d], 1e3 * same.forces[d],
                             100 * (o.plain.forces[d] / same.forces[d] - 1), 1e3 * ours.forces[d], 1e3 * fine.forces[d],
                             100 * (ours.forces[d] / fine.forces[d] - 1));
      }
      same_ = std::max(same_, verify::largest_difference(o.plain, same));
      finer_ = std::max(finer_, verify::largest_difference(ours, fine));
      json_["cases"].push_back({{"case", c.name},
                                {"depths_m", c.depths},
                                {"plain_N", o.plain.forces},
                                {"ccx_same_mesh_N", same.forces},
                                {"default_N", ours.forces},
                                {"ccx_finer_mesh_N", fine.forces}});
    }
    text_ += fmt::format(
        "\nLargest difference: {:.2f} % on the same mesh (allowed {:.0f}), {:.2f} % against the finer "
        "mesh (allowed {:.0f}).\n",
        100 * same_, 100 * kSameMesh, 100 * finer_, 100 * kFinerMesh);
    json_["same_mesh"] = same_;
    json_["finer_mesh"] = finer_;
  }

  // The first case of each tool, on the base mesh: what a finer setting changes.
  void settings() {
    text_ +=
        "\nLargest change of a force when a setting is made finer (base mesh; allowed 0.25 %):\n\n"
        "| case | ccx: facets half as large | ccx: contact 3 times as stiff | ccx: 2 increments a depth | ours: "
        "contact 3 times as stiff |\n|---|---|---|---|---|\n";
    json_["settings"] = Json::array();
    for (std::size_t k = 0; k < cases_.size(); ++k) {
      const verify::CcxCase& c = cases_[k];
      if (k > 0 && c.tool.scene.shape == cases_[k - 1].tool.scene.shape) continue;
      verify::CcxSettings facets = settings_, stiff = settings_, steps = settings_, penalty = settings_;
      facets.facets /= 2;
      stiff.stiffness *= 3;
      steps.increments *= 2;
      penalty.penalty *= 3;
      const verify::CcxMesh mesh = verify::ccx_mesh(c, kSizes[kBase], settings_);
      std::vector<double> changes;
      for (const verify::CcxSettings* s : {&facets, &stiff, &steps}) {
        changes.push_back(verify::largest_difference(
            checked(verify::solve_ccx(ccx_, c, mesh, *s), c, "CalculiX, finer setting"), outcomes_[k].ccx[kBase]));
      }
      changes.push_back(verify::largest_difference(
          checked(verify::solve_ours(c, mesh, false, penalty), c, "ours, finer setting"), outcomes_[k].ours[kBase]));
      text_ += fmt::format("| {} | {:.3f} % | {:.3f} % | {:.3f} % | {:.3f} % |\n", c.name, 100 * changes[0],
                           100 * changes[1], 100 * changes[2], 100 * changes[3]);
      for (const double change : changes) changed_ = change <= changed_ ? changed_ : change;  // keeps a NaN
      json_["settings"].push_back({{"case", c.name},
                                   {"ccx_facets", changes[0]},
                                   {"ccx_stiffness", changes[1]},
                                   {"ccx_increments", changes[2]},
                                   {"ours_stiffness", changes[3]}});
    }
  }

  static verify::ErrorTime study(const std::vector<verify::CcxSolve>& solves) {
    verify::SizeStudy study;
    study.sizes = kSizes;
    for (std::size_t k = 0; k < solves.size(); ++k) {
      study.values.push_back(solves[k].forces);
      study.seconds.push_back(k < kFine ? solves[k].seconds : 0.0);
    }
    return verify::error_against_time(study);
  }

  void times() {
    text_ +=
        "\nError against time. An error is the root mean square over the depths of a force's distance to the "
        "program's own\nRichardson limit (last two sizes, order seen over the last three; in brackets: assumed). "
        "Times: processor seconds of\none thread for the whole curve, mesh aside.\n\n"
        "| case | elements | nodes | ours, s | ours, error | ccx, s | ccx, error |\n|---|---|---|---|---|---|---|\n";
    std::string ratios, limits;
    for (std::size_t k = 0; k < cases_.size(); ++k) {
      const verify::CcxCase& c = cases_[k];
      const Outcome& o = outcomes_[k];
      const verify::ErrorTime ours = study(o.ours), ccx = study(o.ccx);
      Json& json = json_["cases"][k];
      for (std::size_t n = 0; n < kFine; ++n) {
        text_ +=
            fmt::format("| {} | {:.2f} | {} | {:.2f} | {:.2f} % | {:.1f} | {:.2f} % |\n", c.name, kSizes[n],
                        o.ours[n].nodes, ours.seconds[n], 100 * ours.errors[n], ccx.seconds[n], 100 * ccx.errors[n]);
        json["sizes"].push_back({{"size", kSizes[n]},
                                 {"nodes", o.ours[n].nodes},
                                 {"ours_s", ours.seconds[n]},
                                 {"ours_error", ours.errors[n]},
                                 {"ccx_s", ccx.seconds[n]},
                                 {"ccx_error", ccx.errors[n]}});
      }
      const auto order = [](const verify::ErrorTime& e) {
        return fmt::format(fmt::runtime(e.observed ? "{:.1f}" : "({:.1f})"), e.order);
      };
      limits += fmt::format("| {} | {} | {} | {:.2f} % |\n", c.name, order(ours), order(ccx),
                            100 * (ours.limit.back() / ccx.limit.back() - 1));
      json["limit_difference"] = ours.limit.back() / ccx.limit.back() - 1;
      for (const verify::TimeRatio& r : verify::time_ratios(ours, ccx)) {
        ratios += fmt::format("| {} | {:.2f} % | {:.2f} | {:.1f} | {:.0f} | {:.0f} |\n", c.name, 100 * r.error, r.ours,
                              r.other, r.other / r.ours, (r.other + o.meshing) / (r.ours + o.meshing));
        least_ratio_ = std::min(least_ratio_, r.other / r.ours);
        json["ratios"].push_back(
            {{"error", r.error}, {"ours_s", r.ours}, {"ccx_s", r.other}, {"ratio", r.other / r.ours}});
      }
    }
    text_ += "\n| case | our order | ccx' order | our limit against ccx', full depth |\n|---|---|---|---|\n" + limits;
    text_ +=
        "\nTimes at equal error: both curves as power laws between the sizes above, at the smallest and the "
        "largest error that\nboth reached and midway. The last column adds the making of the base mesh to both.\n\n"
        "| case | error | ours, s | ccx, s | ratio | with the mesh |\n|---|---|---|---|---|---|\n" +
        ratios;
  }

  const Globals& globals_;
  std::filesystem::path ccx_;
  verify::CcxSettings settings_;
  std::vector<verify::CcxCase> cases_;
  std::vector<Outcome> outcomes_;
  double same_ = 0.0, finer_ = 0.0, changed_ = 0.0;
  double least_ratio_ = std::numeric_limits<double>::infinity();
  std::string text_;
  Json json_;
};

}  // namespace

void run_ccx_command(const CcxCommand& command, const Globals& globals) {
  Comparison comparison(command, globals);
  {
    const InterruptPolling polling;
    comparison.run();
  }
  if (!command.report.empty()) write_report(command.report, comparison.json());
  if (globals.json) {
    print_json(comparison.json());
  } else {
    print(comparison.text());
  }
  comparison.judge();
}

}  // namespace palpate::cli
