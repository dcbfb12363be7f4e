// SPDX-License-Identifier: GPL-3.0-or-later
// palpate play: a recorded or synthetic motion, or the recording of a run, in; forces and torques and a plot out.
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "formats/io/error.hpp"
#include "formats/io/file.hpp"
#include "formats/io/same_file.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/commands.hpp"
#include "tools/cli/output.hpp"
#include "tools/cli/response_input.hpp"
#include "tools/play/frames.hpp"
#include "tools/play/play.hpp"
#ifdef PALPATE_DRIVE
#include "tools/play/play_run.hpp"

#include <filesystem>
#endif

namespace palpate::cli {
namespace {

struct PlayArguments {
  std::string file, motion, out, plot, tool, frames;
  bool single = false;
};

const char* plural(std::size_t count) { return count == 1 ? "" : "s"; }

nlohmann::ordered_json json_of(const PlayArguments& options, const std::string& tool, std::size_t rows,
                               const PlaySummary& s) {
  return {{"file", options.file},
          {"motion", options.motion},
          {"tool", tool},
          {"rows", rows},
          {"ticks", s.ticks},
          {"contacts", s.contacts},
          {"contact_time", s.contact_time},
          {"slide_time", s.slide_time},
          {"peak_force", s.peak_force},
          {"peak_torque", s.peak_torque},
          {"peak_depth", s.peak_depth},
          {"starts_inside", s.starts_inside},
          {"rows_extrapolated", s.rows_extrapolated},
          {"rows_filled", s.rows_filled},
          {"rows_other_contacts", s.rows_other_contacts},
          {"rows_near", s.rows_near}};
}

/// Files, warnings; the summary as text where it is not wanted as JSON.
void report(const PlayArguments& options, const Globals& globals, const std::string& tool_name,
            const std::vector<PlayedRow>& rows, const PlaySummary& s) {
  if (!options.out.empty()) write_file(options.out, forces_csv(rows));
  if (!options.plot.empty()) write_file(options.plot, forces_svg(rows, "Force on the tool '" + tool_name + "'"));
  const auto rows_of = [&](std::size_t count) {
    return std::to_string(count) + " of " + std::to_string(rows.size()) + " rows ";
  };
  if (s.starts_inside) {
    warn(options.motion + ": the first pose lies inside the body; its contact starts at zero force there");
  }
  if (s.rows_extrapolated > 0) {
    warn(rows_of(s.rows_extrapolated) +
         "lie deeper than was sampled, there or on the way: these forces are extrapolated");
  }
  if (s.rows_other_contacts > 0) {
    warn("in " + rows_of(s.rows_other_contacts) + "the tool overlaps another wall, which --single leaves out");
  }
  if (s.rows_near > 0) {
    warn("in " + rows_of(s.rows_near) + "the places lie so near each other that their sum is more than 7 % too large");
  }
  if (globals.json) return;
  char text[400];
  std::snprintf(text, sizeof text,
                "%zu row%s, %zu tick%s, %zu contact%s; %.3g s in contact, of these %.3g s sliding\n"
                "peak force %.4g N, peak torque %.4g N m, deepest %.3g mm\n",
                rows.size(), plural(rows.size()), s.ticks, plural(s.ticks), s.contacts, plural(s.contacts),
                s.contact_time, s.slide_time, s.peak_force, s.peak_torque, 1e3 * s.peak_depth);
  print(text);
}

#ifdef PALPATE_DRIVE

/// The response file that a run names. The recording may lie in another folder than this one, with the file beside it.
std::string response_of(const device::RunLog& log, const std::string& run) {
  const std::filesystem::path named = log.header.response;
  if (named.is_absolute() || std::filesystem::exists(named)) return named.string();
  const std::filesystem::path beside = std::filesystem::path(run).parent_path() / named;
  return std::filesystem::exists(beside) ? beside.string() : named.string();
}

/// The same forces as in the run, bit for bit, or an error; of another response file, how different they are.
void replay(PlayArguments options, const Globals& globals) {
  if (!options.frames.empty()) throw Error(ExitCode::usage, "--frames draws a motion; " + options.motion + " is a run");
  if (options.single)
    throw Error(ExitCode::usage,
                "--single: " + options.motion + " is played as it was recorded; palpate drive has --single as well");
  const device::RunLog log = read_run(options.motion);
  if (log.records.empty()) throw Error(ExitCode::bad_input, options.motion + ": the recording has no ticks");
  const bool named_by_run = options.file.empty();
  if (named_by_run) options.file = response_of(log, options.motion);
  if (named_by_run && !std::filesystem::exists(options.file)) {
    throw Error(ExitCode::io, options.file + ": there is no such file, and " + options.motion +
                                  " names it as its response file; give it: palpate play FILE.palp " + options.motion);
  }
  refuse_same({options.out, options.plot}, {options.motion, options.file});
  const ResponseInput input(options.file);
  const std::uint32_t tool = input.tool(options.tool.empty() ? log.header.tool_name : options.tool);
  const PlayedRun played = play_run(log, input, tool);
  const device::Replay& r = played.replay;
  const std::string tool_name = input.view().tools[tool].name;
  if (!played.same_response) {
    warn(options.file + ": not the response file of the run (its hash differs): the forces are what this one gives");
  }
  if (!log.complete) {
    warn(options.motion + ": the recording was cut short after " + std::to_string(r.ticks) + " ticks" +
         (log.torn > 0 ? " and " + std::to_string(log.torn) + " bytes of the next" : ""));
  }
  const std::size_t missing = log.complete ? log.end.dropped : r.missing;
  if (missing > 0) {
    warn(options.motion + ": " + std::to_string(missing) + " ticks are missing; only the first " +
         std::to_string(r.compared) + " are compared with the run");
  }
  report(options, globals, tool_name, played.rows, played.summary);
  if (globals.json) {
    nlohmann::ordered_json json = json_of(options, tool_name, played.rows.size(), played.summary);
    json["run"] = {{"device", log.header.device},    {"rate", log.header.rate},
                   {"complete", log.complete},       {"same_response", played.same_response},
                   {"ticks_missing", missing},       {"ticks_compared", r.compared},
                   {"ticks_different", r.different}, {"first_different", r.first_different},
                   {"largest_difference", r.largest}};
    print_json(json);
  } else {
    char text[200];
    std::snprintf(text, sizeof text, "%zu of %zu tick%s of the run compared: %zu differ%s, by up to %.3g N\n",
                  r.compared, r.ticks, plural(r.ticks), r.different, r.different == 1 ? "s" : "", r.largest);
    print(text);
  }
  if (played.same_response && tool_name == log.header.tool_name && r.different > 0) {
    throw Error(ExitCode::tolerance,
                options.motion + ": tick " + std::to_string(r.first_different) + " does not give the force of the run");
  }
}

#endif

std::pair<runtime::Vec3, runtime::Vec3> body_box(const runtime::View& view) {
  constexpr double kFar = 1e30;
  runtime::Vec3 low{kFar, kFar, kFar}, high{-kFar, -kFar, -kFar};
  for (std::uint32_t t = 0; t < view.meta->triangle_count; ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      runtime::BodyPoint at{t, {0, 0, 0}};
      at.bary[corner] = 1;
      const runtime::Vec3 p = position(view, at);
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
  }
  return {low, high};
}

void run_play(PlayArguments options, const Globals& globals) {
#ifdef PALPATE_DRIVE
  if (is_run(options.file)) std::swap(options.file, options.motion);  // alone, or in the other order
  if (!options.motion.empty() && is_run(options.motion)) return replay(options, globals);
#endif
  if (options.motion.empty())
    throw Error(ExitCode::usage, "motion is required: " + options.file + " is no recording of a run");
  refuse_same({options.out, options.plot}, {options.motion, options.file});
  const ResponseInput input(options.file);
  const std::uint32_t tool = input.tool(options.tool);
  const std::vector<MotionRow> motion = read_motion(options.motion);
  const auto [low, high] = body_box(input.view());
  if (const std::string hint = motion_hint(motion, low, high); !hint.empty()) warn(options.motion + ": " + hint);
  PlaySummary s;
  const std::vector<PlayedRow> rows = play(input.view(), tool, motion, s, options.single);
  const std::string tool_name = input.view().tools[tool].name;
  if (!options.frames.empty()) {
    DentFrames frames;
    frames.folder = options.frames;
    note(globals,
         std::to_string(write_frames(input.view(), tool, motion, rows, frames)) + " frames in " + options.frames);
  }
  report(options, globals, tool_name, rows, s);
  if (globals.json) print_json(json_of(options, tool_name, rows.size(), s));
}

}  // namespace

void add_play(CLI::App& app, Globals& globals) {
  auto options = std::make_shared<PlayArguments>();
  Command command(app, "play", "Plays a motion against a response file");
  command.option("file", options->file, "Response file (.palp), or a run alone: its own response file").required();
  command.option("motion", options->motion,
                 "Motion (CSV: t,x,y,z,qw,qx,qy,qz in s and m), or a run of 'palpate drive'");
  command.option("--out", options->out, "Write forces and torques here (CSV)");
  command.option("--plot", options->plot, "Write a plot of force and depth here (SVG)");
  command.option("--frames", options->frames,
                 "Write the dented body here, a GLB file for each thirtieth of a second (files with compliance)");
  command.option("--tool", options->tool, "Name of the tool; default: the file's first");
  command.flag("--single", options->single, "Follow the nearest wall alone; without it up to three walls are felt");
  command.runs([options, &globals] { run_play(*options, globals); });
}

}  // namespace palpate::cli
