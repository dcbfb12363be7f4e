// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/verify/verify_strokes.hpp"

#include "formats/io/error.hpp"
#include "formats/io/file.hpp"
#include "precompute/pipeline/pipeline.hpp"
#include "precompute/verify/contact_checks.hpp"
#include "precompute/verify/held_out/statistics.hpp"
#include "tools/bench/tick_bench.hpp"
#include "tools/cli/contact_case.hpp"
#include "tools/cli/output.hpp"
#include "tools/cli/response_input.hpp"
#include "tools/cli/verify_checks.hpp"
#include "tools/play/play.hpp"
#include "tools/play/plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

namespace palpate::cli {
namespace {

using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

// Share of the friction limit at points that slip, below which a contact sticks: the rim of one that is pressed
// straight into a soft body slips outwards with up to a quarter of it.
constexpr double kStuck = 0.3;
constexpr double kOthers = 0.05;  // of a force that was taken from neighbours: beyond is not what the scene has sampled
constexpr double kFloor = 0.02;   // of the stroke's peak force: errors of smaller forces are relative to that

enum Phase : std::size_t { sticking, partial, sliding, kPhases };
constexpr std::array<const char*, kPhases> kNames{"sticking", "partial slip", "sliding"};

struct StrokeStation {
  Vector3d baked{0, 0, 0};  // N on the tool, contact frame
  bool compared = false;
  Phase phase = sticking;
  double error = 0.0;
};

using Errors = std::array<std::vector<double>, kPhases>;

// The stroke as a motion of the tool, from where it touches the body's own surface, not the mesh'.
std::vector<MotionRow> motion(const tool::ToolVertex& vertex, const ContactFrame& frame,
                              const solve::StrokeResult& stroke) {
  const Eigen::Isometry3d touch = tool::touching_pose(vertex, frame);
  const Eigen::Quaterniond q(touch.linear());
  std::vector<MotionRow> rows;
  for (const solve::StrokeStep& s : stroke.steps) {
    const Vector3d at = touch.translation() + frame.to_world(s.station);
    rows.push_back({double(rows.size()), {at.x(), at.y(), at.z()}, {q.w(), q.x(), q.y(), q.z()}});
  }
  return rows;
}

// Stations where the body answers from other than this scene's own samples are not its errors.
std::vector<StrokeStation> compare(const runtime::View& view, const ContactCase& c,
                                   const verify::CheckedStroke& stroke) {
  const ContactFrame& frame = c.contacts[stroke.contact].frame;
  PlaySummary summary;
  const std::vector<PlayedRow> rows = play(view, 0, motion(c.tool.vertices.at(0), frame, stroke.result), summary);
  double peak = 0;
  for (const solve::StrokeStep& s : stroke.result.steps) peak = std::max(peak, s.force.norm());
  std::vector<StrokeStation> all;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const solve::StrokeStep& s = stroke.result.steps[k];
    const runtime::Tick& tick = rows[k].tick;
    StrokeStation at;
    at.baked = frame.to_local({tick.force.x, tick.force.y, tick.force.z});
    at.compared = s.resolved && tick.filled_share < kOthers && !tick.extrapolated;
    at.phase = s.gross ? sliding : s.slipping > kStuck ? partial : sticking;
    at.error = (at.baked - s.force).norm() / std::max(s.force.norm(), kFloor * peak);
    all.push_back(at);
  }
  return all;
}

Json figures(const std::vector<double>& errors) {
  return {{"count", errors.size()},
          {"median", verify::quantile(errors, 0.5)},
          {"p95", verify::quantile(errors, 0.95)},
          {"worst", verify::quantile(errors, 1.0)}};
}

Json to_json(const ContactCase& c, const verify::CheckedStroke& stroke, const std::vector<StrokeStation>& stations) {
  const solve::StrokeResult& r = stroke.result;
  Json steps = Json::array();
  for (std::size_t k = 0; k < stations.size(); ++k) {
    const solve::StrokeStep& s = r.steps[k];
    steps.push_back({{"at_m", list(s.station)},
                     {"solved_N", list(s.force)},
                     {"baked_N", list(stations[k].baked)},
                     {"slipping", s.slipping},
                     {"points", s.points},
                     {"compared", stations[k].compared},
                     {"state", kNames[stations[k].phase]},
                     {"error", stations[k].error},
                     {"dissipated_J", s.dissipated}});
  }
  const verify::BenchContact& contact = c.contacts[stroke.contact];
  return {{"stroke", stroke.name},
          {"c", list(contact.frame.origin)},
          {"n", list(contact.frame.n)},
          {"x", list(contact.frame.x)},
          {"angle", stroke.angle},
          {"usable", r.usable},
          {"cause", r.cause},
          {"contact_radius_m", r.contact_radius},
          {"energy_imbalance", r.imbalance},
          {"nodes", r.nodes},
          {"seconds", stroke.seconds},
          {"steps", steps}};
}

std::string cell(const std::vector<double>& errors) {
  if (errors.empty()) return " - |";
  return fmt::format(" {}: {:.1f} / {:.1f} / {:.1f} |", errors.size(), 100 * verify::quantile(errors, 0.5),
                     100 * verify::quantile(errors, 0.95), 100 * verify::quantile(errors, 1.0));
}

std::string row(const std::string& name, const Errors& errors) {
  std::string text = "| " + name + " |";
  for (const std::vector<double>& e : errors) text += cell(e);
  return text + "\n";
}

// Solved and baked along the strokes of the first contact, one after the other.
std::string drawing(const std::vector<verify::CheckedStroke>& strokes,
                    const std::vector<std::vector<StrokeStation>>& stations) {
  std::vector<double> at;
  PlotPanel normal{"normal force (N)", {{"solved", {}}, {"baked", {}}}};
  PlotPanel tangential{"tangential force (N)", {{"solved", {}}, {"baked", {}}}};
  PlotPanel way{"depth, way (mm)", {{"depth", {}}, {"way", {}}}};
  for (std::size_t k = 0; k < strokes.size() && strokes[k].contact == strokes[0].contact; ++k) {
    const Vector3d main(std::cos(strokes[k].angle), std::sin(strokes[k].angle), 0);
    for (std::size_t i = 0; i < stations[k].size(); ++i) {
      const solve::StrokeStep& s = strokes[k].result.steps[i];
      at.push_back(double(at.size()));
      normal.series[0].values.push_back(s.force.z());
      normal.series[1].values.push_back(stations[k][i].baked.z());
      tangential.series[0].values.push_back(s.force.dot(main));
      tangential.series[1].values.push_back(stations[k][i].baked.dot(main));
      way.series[0].values.push_back(-1e3 * std::min(s.station.z(), 0.0));
      way.series[1].values.push_back(1e3 * s.station.dot(main));
    }
  }
  std::string title = "Strokes:";
  for (std::size_t k = 0; k < strokes.size() && strokes[k].contact == strokes[0].contact; ++k) {
    title += (k > 0 ? ", " : " ") + strokes[k].name;
  }
  return line_plot_svg(title, "station", at, {normal, tangential, way});
}

}  // namespace

void run_strokes(const StrokesCommand& command, const Globals& globals) {
  pipeline::Pipeline p = pipeline::prepare(command.scene, {command.work, command.response});
  if (!(p.scene.friction > 0)) throw Error(ExitCode::usage, "--strokes: the scene has no friction");
  pipeline::plan_baked(p);
  const ResponseInput input(p.paths.response);
  check_same_plan(p, input.view());
  const ContactCase c = plan_contacts(p, command.scene, command.contacts);
  verify::ContactCheckOptions options;
  options.threads = static_cast<unsigned>(globals.threads);
  options.progress = [&](std::size_t done, std::size_t total) {
    note(globals, "strokes solved: " + std::to_string(done) + " of " + std::to_string(total));
  };
  const std::vector<verify::CheckedStroke> strokes =
      verify::check_strokes(c.scene, c.body, c.tool, c.contacts, options);

  Json json{{"strokes", command.scene},
            {"file", p.paths.response.string()},
            {"machine", machine_name()},
            {"friction", p.scene.friction},
            {"solves", Json::array()}};
  std::string rows, refused;
  std::vector<std::vector<StrokeStation>> stations;
  Errors total;
  std::size_t usable = 0, left_out = 0;
  for (const verify::CheckedStroke& stroke : strokes) {
    stations.push_back(compare(input.view(), c, stroke));
    json["solves"].push_back(to_json(c, stroke, stations.back()));
    Errors errors;
    for (const StrokeStation& s : stations.back()) {
      left_out += !s.compared;
      if (!s.compared) continue;
      errors[s.phase].push_back(s.error);
      total[s.phase].push_back(s.error);
    }
    const std::string name = std::to_string(stroke.contact) + " " + stroke.name;
    rows += row(name, errors);
    usable += stroke.result.usable;
    if (!stroke.result.usable) refused += "ended early: " + name + ": " + stroke.result.cause + "\n";
  }
  for (std::size_t k = 0; k < kPhases; ++k) json["error"][kNames[k]] = figures(total[k]);
  json["left_out"] = left_out;
  const std::string text =
      command.scene +
      fmt::format(": {} strokes, friction {:.3g}; forces: their errors in % (median / 95th / worst)\n\n",
                  strokes.size(), p.scene.friction) +
      "| contact, stroke | sticking | partial slip | sliding |\n|---|---|---|---|\n" + rows + row("all", total) +
      fmt::format("\n{} stations left out: barely touching, or beyond what the scene has sampled\n", left_out) +
      refused;
  if (!command.report.empty()) write_report(command.report, json);
  globals.json ? print_json(json) : print(text);
  if (!command.plot.empty()) write_file(command.plot, drawing(strokes, stations));
  if (usable == 0) {
    throw Error(ExitCode::numerical, "no stroke was solved to its end; the first: " + strokes.front().result.cause);
  }
}

}  // namespace palpate::cli
