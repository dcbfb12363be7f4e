// SPDX-License-Identifier: GPL-3.0-or-later
// `palpate verify`: baked against solved forces, with what a tick, a response and the bake cost.
#include "formats/error.hpp"
#include "formats/file.hpp"
#include "precompute/bake/reach.hpp"
#include "precompute/verify/recorded.hpp"
#include "tools/interrupt.hpp"
#include "tools/output.hpp"
#include "tools/pipeline_steps.hpp"
#include "tools/response_input.hpp"
#include "tools/tick_bench.hpp"

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

namespace palpate::cli {
namespace {

struct Options {
  std::string input, work, response, report, samples;
  std::uint32_t count = 40;
  std::uint64_t seed = 1;
  std::optional<double> max_p95;
};

struct Costs {
  double tick = 0.0;      // ns, median of a sticking (frictionless: pressing) tick
  double response = 0.0;  // bytes
};

Costs costs(const runtime::View& view) {
  TickBenchOptions options;
  options.contacts = 20;
  return {bench_ticks(view, options).press.quantile(0.5), bytes_per_response(view)};
}

struct PairCounts {
  std::size_t planned = 0, accepted = 0, refused = 0;
};

PairCounts count_pairs(const pipeline::Pipeline& p) {
  PairCounts counts{p.plan.pairs.size(), 0, 0};
  for (const auto& [index, pair] : read_journal(p.paths.journal, p.manifest).pairs) {
    if (!pair.outcome) continue;
    ++(pair.outcome->accepted ? counts.accepted : counts.refused);
  }
  return counts;
}

std::string line(const char* name, const ErrorStatistics& s) {
  if (s.count == 0) return {};
  char text[256];
  std::snprintf(text, sizeof text,
                "%-9s %6zu %8.2f %8.2f %8.2f   %5.1f %5.1f %5.1f %5.1f   contact %zu, depth %.2f mm\n", name, s.count,
                100 * s.median, 100 * s.p95, 100 * s.worst, 100 * s.within_1, 100 * s.within_2, 100 * s.within_5,
                100 * s.within_10, s.worst_contact, 1e3 * s.worst_depth);
  return text;
}

std::string table(const VerifyStatistics& s) {
  return "force error (% of the larger of the solved force and 2 % of its contact's peak)\n"
         "push       forces   median      p95    worst      <1%   <2%   <5%  <10%   worst at\n" +
         line("normal", s.normal) + line("sideways", s.sideways);
}

void check_limit(const Options& options, const VerifyStatistics& s) {
  if (options.max_p95 && !(s.normal.p95 <= *options.max_p95)) {
    char text[160];
    std::snprintf(text, sizeof text, "95th percentile of the normal force error is %.4g, asked %.4g", s.normal.p95,
                  *options.max_p95);
    throw Error(ExitCode::tolerance, text);
  }
}

void publish(const Options& options, const Globals& globals, nlohmann::ordered_json json, const std::string& text) {
  if (!options.report.empty()) write_file(options.report, json.dump(1) + "\n");
  if (globals.json) {
    print_json(json);
  } else {
    print(text);
  }
}

// Against recorded solves: nothing is solved, no scene is needed.
void compare(const Options& options, const Globals& globals) {
  const ResponseInput input(options.input);
  std::vector<HeldOut> contacts = read_recorded(options.samples);
  compare_with_file(input.view(), contacts);
  const VerifyStatistics s = summarise(contacts);
  if (s.normal.count == 0) throw Error(ExitCode::bad_input, options.samples + ": no solved normal push in it");
  publish(options, globals,
          {{"file", options.input},
           {"samples", options.samples},
           {"error", to_json(s.normal, contacts)},
           {"error_sideways", to_json(s.sideways, contacts)},
           {"held_out", to_json(contacts)}},
          table(s));
  check_limit(options, s);
}

void solve(const Options& options, const Globals& globals) {
  pipeline::Pipeline p = pipeline::prepare(options.input, {options.work, options.response});
  pipeline::plan(p);
  const ResponseInput input(p.paths.response);
  const runtime::View& view = input.view();
  HeldOutOptions held;
  held.count = options.count;
  held.seed = options.seed;
  held.threads = static_cast<unsigned>(globals.threads);
  held.stop = [] { return interrupted(); };
  held.touchable = [&](const ContactFrame& frame, const Tool& tool, const ToolVertex& vertex, double depth) {
    return !reaches_support(p.body, frame, contact_radius(vertex, depth)) &&
           can_touch_first(p.body, tool, vertex, frame);
  };
  held.progress = [&](std::size_t done, std::size_t total) {
    if (!globals.quiet && (done == total || done % 10 == 0)) {
      note(globals, "held-out solves: " + std::to_string(done) + " of " + std::to_string(total));
    }
  };
  const HeldOutSet set = solve_held_out(view, p.scene, p.body, p.tools, held);
  if (set.stopped) throw Interrupted("held-out solves are not kept; run the command again");
  const VerifyStatistics s = summarise(set.contacts);
  if (s.normal.count == 0) {
    throw Error(ExitCode::numerical, "every held-out solve was refused; the first: " + set.contacts.front().cause);
  }
  const Costs cost = costs(view);
  const PairCounts pairs = count_pairs(p);
  const double seconds = pipeline::bake_seconds(p);
  nlohmann::ordered_json json{
      {"file", p.paths.response.string()},
      {"scene", options.input},
      {"pairs", {{"planned", pairs.planned}, {"accepted", pairs.accepted}, {"refused", pairs.refused}}},
      {"error", to_json(s.normal, set.contacts)},
      {"error_sideways", to_json(s.sideways, set.contacts)},
      {"tick_ns", cost.tick},
      {"bytes_per_response", cost.response},
      {"bake_seconds", seconds},
      {"seed", options.seed},
      {"contacts", {{"solved", s.accepted}, {"refused", s.refused}}},
      {"untouchable_share", set.untouchable_share},
      {"held_out", to_json(set.contacts)}};
  char text[512];
  std::snprintf(text, sizeof text,
                "pairs: %zu planned, %zu accepted, %zu refused; held-out contacts: %zu solved, %zu refused "
                "(%.1f %% of the draws lay at a support, in a fold narrower than the tool or outside the region)\n",
                pairs.planned, pairs.accepted, pairs.refused, s.accepted, s.refused, 100 * set.untouchable_share);
  std::string out = text + table(s);
  std::snprintf(text, sizeof text, "run time: %.0f ns a tick, %.0f bytes a response, %.0f s of bake\n", cost.tick,
                cost.response, seconds);
  out += text;
  for (std::size_t k = 0; k < set.contacts.size(); ++k) {
    if (!set.contacts[k].accepted) out += "refused: contact " + std::to_string(k) + ": " + set.contacts[k].cause + "\n";
  }
  publish(options, globals, json, out);
  check_limit(options, s);
}

void run(const Options& options, const Globals& globals) {
  if (!options.samples.empty()) return compare(options, globals);
  if (options.input.ends_with(".palp")) {
    throw Error(ExitCode::usage, options.input +
                                     ": a response file is compared with recorded solves: add --samples "
                                     "FILE, or give the scene to solve new ones");
  }
  solve(options, globals);
}

}  // namespace

void add_verify(CLI::App& app, Globals& globals) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("verify", "Compares baked with solved forces; exit code 5 beyond --max-p95");
  command->add_option("input", options->input, "Scene (solves held-out contacts) or, with --samples, a response file")
      ->required();
  command->add_option("--count", options->count, "Held-out contacts")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "Seed of their places")->capture_default_str();
  command->add_option("--samples", options->samples, "Report of an earlier verify: compare without solving");
  command->add_option("--max-p95", options->max_p95, "Largest 95th percentile of the relative normal force error")
      ->check(CLI::PositiveNumber);
  command->add_option("--report", options->report, "Also write the JSON report to this file (usable as --samples)");
  command->add_option("--work", options->work, "Work folder (default: NAME.work beside the scene)");
  command->add_option("--response", options->response, "Response file (default: NAME.palp beside the scene)");
  command->callback([options, &globals] { run(*options, globals); });
}

}  // namespace palpate::cli
