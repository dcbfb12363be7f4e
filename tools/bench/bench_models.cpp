// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/bench/bench_models.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>

#include "formats/io/error.hpp"
#include "precompute/fit/laws/pair_samples.hpp"
#include "precompute/fit/laws/path_errors.hpp"
#include "precompute/fit/laws/potential_degrees.hpp"
#include "precompute/pipeline/pipeline.hpp"
#include "precompute/verify/baselines/radial_basis.hpp"
#include "precompute/verify/baselines/separable_fit.hpp"
#include "tools/bench/tick_bench.hpp"
#include "tools/cli/output.hpp"
#include "tools/cli/response_input.hpp"
#include "tools/cli/verify_checks.hpp"

namespace palpate::cli {
namespace {

using Json = nlohmann::ordered_json;

struct Row {
  std::string model;
  double bytes = 0;
  fit::SampleFigures error;
  std::optional<fit::ErrorFigures> paths;
  double stick = 0;  // ns
  double force = 0;  // ns, of the force at one place alone
  std::optional<double> slide;
};

/// Samples of the pairs that were solved in full.
std::vector<const std::vector<Sample>*> accepted_pairs(const JournalContent& journal) {
  std::vector<const std::vector<Sample>*> pairs;
  for (const auto& [pair, solved] : journal.pairs) {
    const bool full = std::any_of(solved.samples.begin(), solved.samples.end(),
                                  [](const Sample& s) { return s.kind == SampleKind::tangential; });
    if (solved.outcome && solved.outcome->accepted && full) pairs.push_back(&solved.samples);
  }
  return pairs;
}

/// Nothing where no sample lies along a path.
std::optional<fit::ErrorFigures> measured(const fit::ErrorFigures& paths) {
  return paths.samples > 0 ? std::optional(paths) : std::nullopt;
}

Row measure_potential(const pipeline::Pipeline& p, const JournalContent& journal, int contacts,
                      fit::ResponseScales& scales) {
  const pipeline::FittedFile file = pipeline::fit_file(p, journal, pipeline::fit_settings(p));
  scales = file.fitted.scales;
  const runtime::OpenResult opened = runtime::View::open(file.bytes.data(), file.bytes.size());
  if (!opened) throw Error(ExitCode::numerical, std::string("quadratic potential: ") + opened.error);
  TickBenchOptions timing;
  timing.contacts = contacts;
  const TickBench bench = bench_ticks(opened.view, timing);
  return {"quadratic potential",
          bytes_per_response(opened.view),
          fit::part_figures(accepted_pairs(journal), scales).left_out,
          measured(file.fitted.report.paths),
          bench.press.quantile(0.5),
          bench.field.quantile(0.5),
          bench.slide.quantile(0.5)};
}

// A baseline is in no file. Its time is that of the three evaluations of a contact inside a patch.
double evaluation_time(const fit::ForceLaw& law, const fit::ResponseScales& scales) {
  using Clock = std::chrono::steady_clock;
  constexpr int kRounds = 20, kCalls = 2000;
  double best = HUGE_VAL, sum = 0;
  for (int round = 0; round < kRounds; ++round) {
    const auto start = Clock::now();
    for (int k = 0; k < 3 * kCalls; ++k) {
      const double share = (k % 97 + 1) / 98.0;
      sum += law({0.1 * share * scales.tangential, 0, share * scales.depth}).z();
    }
    best = std::min(best, std::chrono::duration<double, std::nano>(Clock::now() - start).count() / kCalls);
  }
  return std::isfinite(sum) ? best : HUGE_VAL;
}

/// Relative errors along paths. A baseline has no state: its force depends on the deflection alone.
fit::ErrorFigures path_figures(const std::vector<const std::vector<Sample>*>& pairs, const fit::LawFitter& fitter) {
  std::vector<std::pair<double, std::uint32_t>> errors;
  for (const auto* samples : pairs) {
    const fit::ForceLaw law = fitter(*samples);
    const fit::PairSamples data = fit::sort_samples(*samples, "paths");
    for (const double e : fit::path_errors(
             *samples, data,
             [&](const Eigen::Vector2d&at, double depth) {
               return law({at.x(), at.y(), depth});
             },
             [](double, double, const Eigen::Vector2d&at) { return at; })) {
      errors.emplace_back(e, 0);
    }
  }
  return fit::error_figures(errors);
}

Row measure_baseline(const std::string& name, double bytes, const JournalContent& journal,
                     const fit::ResponseScales& scales, const fit::LawFitter& fitter) {
  const std::vector<const std::vector<Sample>*> pairs = accepted_pairs(journal);
  Row row;
  row.model = name;
  row.bytes = bytes;
  row.error = fit::part_figures(pairs, fitter).left_out;
  row.paths = measured(path_figures(pairs, fitter));
  row.stick = row.force = evaluation_time(fitter(*pairs.at(0)), scales);
  return row;
}

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f %%", 100 * share);
  return text;
}

std::string nanoseconds(double time) {
  char text[32];
  std::snprintf(text, sizeof text, "%.0f ns", time);
  return text;
}

std::string as_text(const Row& row) {
  std::string line = "| " + row.model + " | " + std::to_string(std::lround(row.bytes));
  for (const double share : {row.error.median, row.error.p95, row.error.worst}) line += " | " + percent(share);
  if (row.paths) {
    for (const double share : {row.paths->median, row.paths->p95, row.paths->worst}) line += " | " + percent(share);
  } else {
    line += " | - | - | -";
  }
  return line + " | " + nanoseconds(row.stick) + " | " + (row.slide ? nanoseconds(*row.slide) : "-") + " |\n";
}

Json figures(std::size_t count, double median, double p95, double worst) {
  return {{"count", count}, {"median", median}, {"p95", p95}, {"worst", worst}};
}

Json as_json(const Row& row) {
  Json json{{"model", row.model},
            {"bytes_per_response", row.bytes},
            {"error", figures(row.error.samples, row.error.median, row.error.p95, row.error.worst)},
            {"tick_ns", row.stick},
            {"force_ns", row.force}};
  if (row.paths) json["error_paths"] = figures(row.paths->samples, row.paths->median, row.paths->p95, row.paths->worst);
  if (row.slide) json["slide_ns"] = *row.slide;
  return json;
}

std::vector<Row> measure_models(const pipeline::Pipeline& p, const JournalContent& journal, int contacts,
                                const Globals& globals) {
  std::vector<Row> rows;
  fit::ResponseScales scales;
  note(globals, "fitting and timing the quadratic potential");
  rows.push_back(measure_potential(p, journal, contacts, scales));
  note(globals, "fitting and timing the baselines");
  fit::ResponseScales spring = scales;
  spring.degrees = response::kSpring;
  spring.bits = 16;
  rows.push_back(measure_baseline("linear spring", layout::coefficients_size(spring.degrees, 16), journal, scales,
                                  [&](const std::vector<Sample>& samples) -> fit::ForceLaw {
                                    return [law = fit::Potential(fit::fit_potential(samples, spring, "linear spring"),
                                                                 spring)](const Eigen::Vector3d& at) {
                                      return law.force(at);
                                    };
                                  }));
  rows.push_back(measure_baseline("separable", verify::SeparableField::bytes(true), journal, scales,
                                  [&](const std::vector<Sample>& samples) -> fit::ForceLaw {
                                    return [field = verify::fit_separable(samples, scales.depth, scales.tangential,
                                                                          "separable")](const Eigen::Vector3d& at) {
                                      return field.force(at);
                                    };
                                  }));
  for (const int centres : {6, 24}) {
    rows.push_back(measure_baseline("radial basis, " + std::to_string(centres), verify::RadialBasis::bytes(centres),
                                    journal, scales, [&](const std::vector<Sample>& samples) -> fit::ForceLaw {
                                      return [network = verify::fit_radial_basis(
                                                  samples, scales.depth, scales.tangential, centres, "radial basis")](
                                                 const Eigen::Vector3d& at) { return network.force(at); };
                                    }));
  }
  return rows;
}

}  // namespace

Json model_rows_json(const pipeline::Pipeline& p, const JournalContent& journal, int contacts, const Globals& globals) {
  Json rows = Json::array();
  if (!(p.scene.friction > 0) || accepted_pairs(journal).empty()) return rows;
  for (const Row& row : measure_models(p, journal, contacts, globals)) rows.push_back(as_json(row));
  return rows;
}

void run_model_bench(const ModelBenchCommand& command, const Globals& globals) {
  pipeline::Pipeline p = pipeline::prepare(command.scene, {command.work, {}});
  if (!(p.scene.friction > 0)) {
    throw Error(ExitCode::bad_input, command.scene +
                                         ": got [contact] friction = 0; allowed above 0: the models are compared by "
                                         "tangential samples");
  }
  pipeline::plan_baked(p);
  const JournalContent journal = pipeline::samples(p);
  if (accepted_pairs(journal).empty()) {
    throw Error(ExitCode::bad_input,
                command.scene + ": no pair of it was solved: the models are compared by solved samples");
  }
  const std::vector<Row> rows = measure_models(p, journal, command.contacts, globals);
  char line[200];
  std::snprintf(line, sizeof line, "%s; %zu forces left out, %zu along paths\n", machine_name().c_str(),
                rows[0].error.samples, rows[0].paths ? rows[0].paths->samples : 0);
  std::string text = line;
  text +=
      "| model | bytes | median | 95th | worst | paths: median | 95th | worst | sticking tick | sliding |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n";
  Json json{{"machine", machine_name()}, {"scene", command.scene}, {"rows", Json::array()}};
  for (const Row& row : rows) {
    text += as_text(row);
    json["rows"].push_back(as_json(row));
  }
  globals.json ? print_json(json) : print(text);
}

}  // namespace palpate::cli
