// SPDX-License-Identifier: GPL-3.0-or-later
// `palpate verify`: baked against solved forces, with what a tick, a response and the bake cost.
#include "formats/io/error.hpp"
#include "formats/io/file.hpp"
#include "formats/io/same_file.hpp"
#include "precompute/bake/reach.hpp"
#include "precompute/verify/held_out/limits.hpp"
#include "precompute/verify/held_out/recorded.hpp"
#include "tools/bench/tick_bench.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/commands.hpp"
#include "tools/cli/output.hpp"
#include "tools/cli/response_input.hpp"
#include "tools/cli/verify_checks.hpp"
#include "tools/pipeline/pipeline_steps.hpp"
#include "tools/play/closed_motions.hpp"
#include "tools/play/plot.hpp"
#include "tools/verify/verify_battery.hpp"
#include "tools/verify/verify_ccx.hpp"
#include "tools/verify/verify_closed_forms.hpp"
#include "tools/verify/verify_contacts.hpp"
#ifdef PALPATE_DEVICES
#include "tools/verify/verify_device.hpp"
#endif
#include "tools/verify/verify_paper.hpp"
#include "tools/verify/verify_shape.hpp"
#include "tools/verify/verify_strokes.hpp"
#include "tools/verify/verify_together.hpp"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

namespace palpate::cli {
namespace {

using Json = nlohmann::ordered_json;

struct VerifyArguments {
  std::string input, work, response, report, plot, samples, battery, family, other, cases, paper, device;
  std::uint32_t first = 1, count = 40;
  std::uint64_t seed = 1;
  bool closed_forms = false, loops = false, slide = false, strokes = false, two_tips = false, shape = false;
  int contacts = 3, together = 0;
  std::string layout = "line";
  double radii = 3.5, rate = 1000, scale = 1, max_together = 0.05, aside = 0;
  verify::VerifyLimits limits;
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

std::string line(const char* name, const verify::ErrorStatistics& s) {
  if (s.count == 0) return {};
  char text[256];
  std::snprintf(text, sizeof text,
                "%-10s %6zu %8.2f %8.2f %8.2f   %5.1f %5.1f %5.1f %5.1f   contact %zu, depth %.2f mm\n", name, s.count,
                100 * s.median, 100 * s.p95, 100 * s.worst, 100 * s.within_1, 100 * s.within_2, 100 * s.within_5,
                100 * s.within_10, s.worst_contact, 1e3 * s.worst_depth);
  return text;
}

std::string table(const verify::VerifyStatistics& s) {
  return "error (forces, and torques of turns: % of the larger of the solved one and 2 % of its contact's peak, forces "
         "at "
         "least of response.floor; limit: % of the solved one)\n"
         "push        forces   median      p95    worst      <1%   <2%   <5%  <10%   worst at\n" +
         line("normal", s.normal) + line("tangential", s.tangential) + line("paths", s.paths) +
         line("grasped", s.grasped) + line("turned", s.turned) + line("limit", s.limit) + line("spins", s.spins);
}

/// Errors (%) of each kind of push.
void write_plot(const std::string& file, const std::vector<verify::HeldOut>& contacts) {
  if (file.empty()) return;
  std::vector<PlotSeries> series{{"normal", {}}, {"tangential", {}}, {"paths", {}}};
  for (const verify::HeldOut& contact : contacts) {
    for (const verify::ForcePair& f : contact.forces) {
      const std::size_t kind = f.kind == SampleKind::normal ? 0 : f.kind == SampleKind::tangential ? 1 : 2;
      if (kind < 2 || f.kind == SampleKind::path) series[kind].values.push_back(100 * f.error);
    }
  }
  write_file(file, distribution_svg("Forces at held-out contacts", "error (%)", series));
}

Json contacts_json(const verify::VerifyStatistics& s) { return {{"solved", s.accepted}, {"refused", s.refused}}; }

void check_limits(const VerifyArguments& options, const verify::VerifyStatistics& s) {
  if (const auto broken = verify::broken_limits(s, options.limits)) throw Error(ExitCode::tolerance, *broken);
}

void publish(const VerifyArguments& options, const Globals& globals, const Json& json, const std::string& text) {
  if (!options.report.empty()) write_report(options.report, json);
  if (globals.json) {
    print_json(json);
  } else {
    print(text);
  }
}

// Against recorded solves: nothing is solved, no scene is needed.
void compare(const VerifyArguments& options, const Globals& globals) {
  const ResponseInput input(options.input);
  std::vector<verify::HeldOut> contacts = verify::read_recorded(options.samples);
  verify::compare_with_file(input.view(), contacts, options.samples);
  const verify::VerifyStatistics s = verify::summarise(contacts);
  if (s.normal.count == 0) throw Error(ExitCode::bad_input, options.samples + ": no solved normal push in it");
  publish(options, globals,
          {{"file", options.input},
           {"samples", options.samples},
           {"error", to_json(s.normal, contacts)},
           {"error_tangential", to_json(s.tangential, contacts)},
           {"error_friction_limit", to_json(s.limit, contacts)},
           {"error_paths", to_json(s.paths, contacts)},
           {"error_grasped", to_json(s.grasped, contacts)},
           {"error_turned", to_json(s.turned, contacts)},
           {"error_spins", to_json(s.spins, contacts)},
           {"contacts", contacts_json(s)},
           {"held_out", to_json(contacts)}},
          table(s));
  write_plot(options.plot, contacts);
  check_limits(options, s);
}

verify::HeldOutSet solve_contacts(const VerifyArguments& options, const Globals& globals, const pipeline::Pipeline& p,
                                  const runtime::View& view) {
  verify::HeldOutOptions held;
  held.count = options.count;
  held.seed = options.seed;
  held.threads = static_cast<unsigned>(globals.threads);
  held.touchable = bake::can_be_pressed;
  held.progress = [&](std::size_t done, std::size_t total) {
    if (!globals.quiet && (done == total || done % 10 == 0)) {
      note(globals, "held-out solves: " + std::to_string(done) + " of " + std::to_string(total));
    }
  };
  verify::HeldOutSet set = verify::solve_held_out(view, p.scene, p.body, p.tools, held);
  return set;
}

std::string solved_text(const verify::HeldOutSet& set, const verify::VerifyStatistics& s, const PairCounts& pairs,
                        const Costs& cost, double bake, double tolerance, double expected) {
  char text[512];
  std::snprintf(text, sizeof text,
                "pairs: %zu planned, %zu accepted, %zu refused; held-out contacts: %zu solved, %zu refused "
                "(%.1f %% of the draws lay at a support, in a fold narrower than the tool or outside the region)\n",
                pairs.planned, pairs.accepted, pairs.refused, s.accepted, s.refused, 100 * set.untouchable_share);
  std::string out = text + table(s) + to_text(pairs.checks);
  std::snprintf(text, sizeof text,
                "normal pushes %s the scene's tolerance: 95th percentile %.2f %%, required %.2f %%\n"
                "run time: %.0f ns a tick, %.0f bytes a response, %.0f s of bake\n",
                s.normal.p95 <= tolerance ? "meet" : "do not meet", 100 * s.normal.p95, 100 * tolerance, cost.tick,
                cost.response, bake);
  out += text;
  if (expected > 0) {
    std::snprintf(text, sizeof text, "the bake expected a 95th percentile of %.2f %%\n", 100 * expected);
    out += text;
  }
  for (std::size_t k = 0; k < set.contacts.size(); ++k) {
    if (!set.contacts[k].accepted) out += "refused: contact " + std::to_string(k) + ": " + set.contacts[k].cause + "\n";
  }
  return out;
}

void solve(const VerifyArguments& options, const Globals& globals) {
  // Every failure that is not of a solve comes before the first solve.
  pipeline::Pipeline p = pipeline::prepare(options.input, {options.work, options.response});
  if (options.limits.p95_tangential && !(p.scene.friction > 0)) {
    throw Error(ExitCode::usage, "--max-p95-tangential: the scene has no friction, and no tangential force to compare");
  }
  const auto has_spins = [](const tool::Tool& tool) { return tool.scene.spins > 1; };
  if (options.limits.p95_spins && std::none_of(p.tools.begin(), p.tools.end(), has_spins)) {
    throw Error(ExitCode::usage, "--max-p95-spins: no tool of the scene has spins");
  }
  pipeline::plan_baked(p);
  const PairCounts pairs = count_pairs(p);
  const double bake = pipeline::bake_seconds(p);
  const ResponseInput input(p.paths.response);
  check_same_plan(p, input.view());
  const Costs cost = costs(input.view());

  const verify::HeldOutSet set = solve_contacts(options, globals, p, input.view());
  const verify::VerifyStatistics s = verify::summarise(set.contacts);
  const double tolerance = p.scene.response.tolerance, expected = expected_error(input.view());
  publish(options, globals,
          {{"file", p.paths.response.string()},
           {"scene", options.input},
           {"pairs", {{"planned", pairs.planned}, {"accepted", pairs.accepted}, {"refused", pairs.refused}}},
           {"finer_mesh", to_json(pairs.checks)},
           {"error", to_json(s.normal, set.contacts)},
           {"error_tangential", to_json(s.tangential, set.contacts)},
           {"error_friction_limit", to_json(s.limit, set.contacts)},
           {"error_paths", to_json(s.paths, set.contacts)},
           {"error_grasped", to_json(s.grasped, set.contacts)},
           {"error_turned", to_json(s.turned, set.contacts)},
           {"error_spins", to_json(s.spins, set.contacts)},
           {"tolerance", tolerance},
           {"expected_p95", expected},
           {"within_tolerance", s.normal.count > 0 && s.normal.p95 <= tolerance},
           {"tick_ns", cost.tick},
           {"bytes_per_response", cost.response},
           {"bake_seconds", bake},
           {"seed", options.seed},
           {"contacts", contacts_json(s)},
           {"untouchable_share", set.untouchable_share},
           {"held_out", to_json(set.contacts)}},
          solved_text(set, s, pairs, cost, bake, tolerance, expected));
  write_plot(options.plot, set.contacts);
  if (s.normal.count == 0) {
    throw Error(ExitCode::numerical, "every held-out solve was refused; the first: " + set.contacts.front().cause);
  }
  check_limits(options, s);
}

// The contact law's sixth promise: a closed motion gives back no more than it took, plus a share of the work on the
// way.
void run_loops(const VerifyArguments& options, const Globals& globals) {
  constexpr double kMost = 1e-3;
  const ResponseInput input(options.input);
  ClosedMotionsOptions motions;
  motions.seed = options.seed;
  motions.progress = [&](const char* what, std::uint64_t done, std::uint64_t total) {
    note(globals, printed("%s: %llu of %llu", what, static_cast<unsigned long long>(done),
                          static_cast<unsigned long long>(total)));
  };
  const ClosedMotionsReport r = play_closed_motions(input.view(), motions);
  char text[400];
  std::snprintf(text, sizeof text,
                "%llu random closed motions: the hand gets back at most %.1e of the work on the way; the worst of %d "
                "searches: %.1e\n",
                static_cast<unsigned long long>(r.motions), 0 - r.worst, motions.searches, 0 - r.searched);
  publish(options, globals,
          {{"file", options.input},
           {"motions", r.motions},
           {"worst", r.worst},
           {"searches", motions.searches},
           {"searched_worst", r.searched}},
          text);
  if (std::min(r.worst, r.searched) < -kMost) {
    throw Error(ExitCode::tolerance,
                options.input + ": a closed motion gives back more than 0.1 % of the work on the way");
  }
}

// Checks that one kind of verification is chosen, and that no option belongs to another kind.
void check_usage(const VerifyArguments& options) {
  const std::pair<const char*, bool> kinds[] = {{"--battery", !options.battery.empty()},
                                                {"--closed-forms", options.closed_forms},
                                                {"--compare", !options.other.empty()},
                                                {"--device", !options.device.empty()},
                                                {"--loops", options.loops},
                                                {"--paper", !options.paper.empty()},
                                                {"--samples", !options.samples.empty()},
                                                {"--shape", options.shape},
                                                {"--slide", options.slide},
                                                {"--strokes", options.strokes},
                                                {"--together", options.together > 0},
                                                {"--two-tips", options.two_tips}};
  const char* chosen = nullptr;
  for (const auto& [name, given] : kinds) {
    if (!given) continue;
    if (chosen != nullptr) throw Error(ExitCode::usage, std::string(chosen) + " and " + name + " exclude each other");
    chosen = name;
  }
  const bool own = !options.battery.empty() || options.closed_forms || !options.other.empty() || !options.paper.empty();
  if (own && !options.input.empty()) {
    throw Error(ExitCode::usage, std::string(chosen) + " makes its own bodies; leave the scene out");
  }
  const verify::VerifyLimits& limits = options.limits;
  const bool limited = limits.p95 || limits.p95_tangential || limits.p95_spins || limits.refused_share;
  if (limited && chosen != nullptr && options.samples.empty()) {
    throw Error(ExitCode::usage, std::string(chosen) +
                                     " has no limits to set; --max-... is for held-out contacts, of a "
                                     "scene or --samples");
  }
  if (!options.family.empty() && options.battery.empty()) {
    throw Error(ExitCode::usage, "--family belongs to --battery");
  }
  if (!options.cases.empty() && options.other.empty() && options.battery.empty()) {
    throw Error(ExitCode::usage, "--case belongs to --battery and --compare");
  }
  const bool held_out = chosen == nullptr || !options.samples.empty();
  if (!options.plot.empty() && !options.strokes && !held_out) {
    throw Error(ExitCode::usage, std::string("--plot shows held-out contacts and --strokes, not ") + chosen);
  }
  if (options.together == 0 && (options.aside > 0 || options.layout != "line")) {
    throw Error(ExitCode::usage, "--layout and --aside belong to --together");
  }
  if (options.device.empty() && (options.rate != 1000 || options.scale != 1)) {
    throw Error(ExitCode::usage, "--rate and --scale belong to --device");
  }
  if (options.input.empty() && !own && !options.slide && !options.two_tips && !options.shape && options.together == 0) {
    throw Error(
        ExitCode::usage,
        "verify needs a scene (alone or with --strokes), a response file (with --samples, --loops or --device), "
        "or --battery, --closed-forms, --compare, --paper, --shape, --slide, --together, --two-tips");
  }
}

/// Checks where the report and the plot go, before the first solve.
void check_results(const VerifyArguments& options) {
  std::vector<std::filesystem::path> read{options.input, options.samples, options.response};
  const bool of_file = !options.samples.empty() || !options.device.empty() || options.loops;
  if (!options.input.empty() && !of_file && !options.input.ends_with(".palp")) {
    for (auto& file : pipeline::files_of(options.input, {options.work, options.response})) read.push_back(file);
  }
  for (const std::string& result : {options.report, options.plot}) {
    if (!result.empty()) check_writable(result);
  }
  refuse_same({options.report, options.plot}, read);
}

void run_verify(const VerifyArguments& options, const Globals& globals) {
  check_usage(options);
  check_results(options);
  const ContactsCommand contacts{options.input, options.report, options.contacts, options.radii};
  if (options.slide) return run_slide(contacts, globals);
  if (options.strokes) {
    return run_strokes({options.input, options.work, options.response, options.report, options.plot, options.contacts},
                       globals);
  }
  if (options.two_tips) return run_two_tips(contacts, globals);
  if (options.shape) {
    ShapeCommand shape;
    shape.scene = options.input;
    shape.response = options.response;
    shape.report = options.report;
    shape.contacts = options.contacts;
    return run_shape(shape, globals);
  }
  if (options.together > 0) {
    TogetherCommand together;
    together.scene = options.input;
    together.response = options.response;
    together.report = options.report;
    together.count = options.together;
    together.layout = options.layout;
    together.contacts = options.contacts;
    together.max_p95 = options.max_together;
    together.aside = options.aside;
    return run_together(together, globals);
  }
  if (!options.battery.empty())
    return run_battery_command(
        {options.battery, options.report, options.family, options.cases, options.seed, options.first, options.count},
        globals);
  if (options.closed_forms) return run_closed_forms({options.report}, globals);
  if (!options.other.empty()) return run_ccx_command({options.report, options.cases}, globals);
  if (!options.paper.empty()) return run_paper_command({options.paper, options.report}, globals);
  if (!options.samples.empty()) return compare(options, globals);
  if (options.loops) return run_loops(options, globals);
#ifdef PALPATE_DEVICES
  if (!options.device.empty()) {
    return run_device_command({options.input, options.device, options.report, options.rate, options.scale}, globals);
  }
#endif
  if (options.input.ends_with(".palp")) {
    throw Error(ExitCode::usage, options.input +
                                     ": a response file is compared with recorded solves: add --samples "
                                     "FILE, or with --device, or give the scene to solve new ones");
  }
  solve(options, globals);
}

}  // namespace

void add_verify(CLI::App& app, Globals& globals) {
  auto options = std::make_shared<VerifyArguments>();
  Command command(app, "verify", "Compares baked with solved forces; exit code 5 beyond a limit");
  command.option("input", options->input,
                 "Scene (solves held-out contacts) or, with --samples or --device, a response file");
  command
      .option("--battery", options->battery,
              "Instead of a scene: the cells of the stability table, or random contacts judged by a much finer mesh")
      .check(one_of({"stiff", "random"}));
  command.option("--family", options->family, "Only this family of the battery");
  command.flag("--closed-forms", options->closed_forms,
               "Instead of a scene: Hertz, Sneddon, Dimitriadis, Mindlin and Cattaneo, on bodies of two sizes");
  command.option("--compare", options->other, "Instead of a scene: forces and times beside another program's")
      .check(one_of({"ccx"}));
  command.option("--case", options->cases, "Only the cells or cases with this in their name");
  command.flag(
      "--loops", options->loops,
      "Check a response file of the coupled model: 100 000 random closed motions of contacts that stick, and searches "
      "for the worst; exit code 5 where the hand gets work back");
  command.flag(
      "--shape", options->shape,
      "The surface that runtime::Dent draws beside the solved one, at a few contacts of a baked scene, or on a "
      "block");
  command.flag("--slide", options->slide, "Slides the tool over a few contacts of the scene, or over a block");
  command.flag("--strokes", options->strokes,
               "Draws the tool through whole motions at a few contacts of a baked scene, solved and played");
  command.option("--plot", options->plot,
                 "Plot (SVG) of the errors at held-out contacts; with --strokes those of the first contact");
  command.flag("--two-tips", options->two_tips, "Two tips at once at a few contacts of the scene, or on a block");
  command
      .option("--together", options->together,
              "As many tools at once at a few contacts of a baked scene, or on a block: the runtime's forces, by the "
              "file's compliance, beside solved ones")
      .check(whole_in(2, 5));
  command.option("--layout", options->layout, "Of --together, how the tools lie; a pinch has 2, on opposite walls")
      .check(one_of({"line", "ring", "pinch", "random"}))
      .shows_default();
  command
      .option("--aside", options->aside,
              "Of --together with friction, how far the first tool goes aside once all are down, in its depth")
      .check(number_in(0, 2))
      .shows_default();
  command
      .option("--max-p95-together", options->max_together,
              "Largest 95th percentile of the error of --together; two tools in a line on the block have limits of "
              "their own")
      .check(number_in(0, 1000))
      .shows_default();
  command
      .option("--contacts", options->contacts,
              "Of --shape, --slide, --strokes, --together and --two-tips, spread evenly over the scene's plan")
      .check(whole_in(1, 10000))
      .shows_default();
  command.option("--radii", options->radii, "Length of a slide in contact radii")
      .check(number_in(0.1, 100))
      .shows_default();
  command.option("--paper", options->paper,
                 "Instead of a scene: figures 2 and 4 of Hayward and Mahvash (2004); scenes and plots (SVG) go to "
                 "this folder");
  command.option("--first", options->first, "Of --battery random, the first contact, to go on from an earlier run")
      .check(whole_in(1, 100000))
      .shows_default();
  command.option("--count", options->count, "Held-out contacts, or contacts of --battery random")
      .check(whole_in(1, 100000))
      .shows_default();
  command.option("--seed", options->seed, "Seed of their places, or of the battery's draw").shows_default();
  command.option("--samples", options->samples, "Report of an earlier verify: compare without solving");
  const Check error = number_in(0, 1000);
  command.option("--max-p95", options->limits.p95, "Largest 95th percentile of the relative normal force error")
      .check(error);
  command.option("--max-p95-tangential", options->limits.p95_tangential, "The same of the tangential pushes' error")
      .check(error);
  command
      .option("--max-p95-spins", options->limits.p95_spins,
              "The same of all pushes at sampled pairs, between the spins of a tool")
      .check(error);
  command
      .option("--max-refused-share", options->limits.refused_share,
              "Largest share of held-out contacts that no solve was accepted for; 0.1 where another limit is set")
      .check(number_in(0, 1));
  command.option(
      "--report", options->report,
      "Also write the JSON report to this file (usable as --samples); of --battery random one line a contact");
#ifdef PALPATE_DEVICES
  command.option("--device", options->device,
                 "Check whether a response file is safe to touch with this device (sim, woody, falcon, ...)");
  command.option("--rate", options->rate, "Rate of the force loop for --device (Hz)")
      .check(number_in(1, 1e5))
      .shows_default();
  command.option("--scale", options->scale, "Of --device: N/m in the hand per N/m of the scene")
      .check(number_in(1e-6, 1e6))
      .shows_default();
#endif
  command.option("--work", options->work, "Work folder (default: NAME.work beside the scene)");
  command.option("--response", options->response, "Response file (default: NAME.palp beside the scene)");
  command.runs([options, &globals] { run_verify(*options, globals); });
}

}  // namespace palpate::cli
