// SPDX-License-Identifier: GPL-3.0-or-later
// palpate play: a recorded or synthetic motion in, forces and torques and a plot out.
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "formats/file.hpp"
#include "tools/command.hpp"
#include "tools/commands.hpp"
#include "tools/output.hpp"
#include "tools/play.hpp"
#include "tools/response_input.hpp"

namespace palpate::cli {
namespace {

struct Options {
  std::string file, motion, out, plot, tool;
};

const char* plural(std::size_t count) { return count == 1 ? "" : "s"; }

void run(const Options& options, const Globals& globals) {
  const ResponseInput input(options.file);
  const std::uint32_t tool = input.tool(options.tool);
  const std::vector<MotionRow> motion = read_motion(options.motion);
  PlaySummary s;
  const std::vector<PlayedRow> rows = play(input.view(), tool, motion, s);
  const std::string tool_name = input.view().tools[tool].name;
  if (!options.out.empty()) write_file(options.out, forces_csv(rows));
  if (!options.plot.empty()) write_file(options.plot, forces_svg(rows, "Force on the tool '" + tool_name + "'"));
  if (s.starts_inside) {
    warn(options.motion + ": the first pose lies inside the body; its contact starts at zero force there");
  }
  if (s.rows_beyond > 0) {
    warn(std::to_string(s.rows_beyond) + " of " + std::to_string(rows.size()) +
         " rows lie deeper than was sampled, there or on the way: these forces are extrapolated");
  }
  if (globals.json) {
    print_json({{"file", options.file},
                {"motion", options.motion},
                {"tool", tool_name},
                {"rows", rows.size()},
                {"ticks", s.ticks},
                {"contacts", s.contacts},
                {"contact_time", s.contact_time},
                {"slide_time", s.slide_time},
                {"peak_force", s.peak_force},
                {"peak_torque", s.peak_torque},
                {"peak_depth", s.peak_depth},
                {"starts_inside", s.starts_inside},
                {"rows_beyond", s.rows_beyond},
                {"rows_covered", s.rows_covered}});
    return;
  }
  char text[400];
  std::snprintf(text, sizeof text,
                "%zu row%s, %zu tick%s, %zu contact%s; %.3g s in contact, of these %.3g s sliding\n"
                "peak force %.4g N, peak torque %.4g N m, deepest %.3g mm\n",
                rows.size(), plural(rows.size()), s.ticks, plural(s.ticks), s.contacts, plural(s.contacts),
                s.contact_time, s.slide_time, s.peak_force, s.peak_torque, 1e3 * s.peak_depth);
  print(text);
}

}  // namespace

void add_play(CLI::App& app, Globals& globals) {
  auto options = std::make_shared<Options>();
  Command command(app, "play", "Plays a motion against a response file");
  command.option("file", options->file, "Response file (.palp)").required();
  command.option("motion", options->motion, "Motion (CSV: t,x,y,z,qw,qx,qy,qz in s and m)").required();
  command.option("--out", options->out, "Write forces and torques here (CSV)");
  command.option("--plot", options->plot, "Write a plot of force and depth here (SVG)");
  command.option("--tool", options->tool, "Name of the tool; default: the file's first");
  command.runs([options, &globals] { run(*options, globals); });
}

}  // namespace palpate::cli
