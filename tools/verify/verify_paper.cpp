// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/verify/verify_paper.hpp"

#include "datasets-synthetic/paper.hpp"
#include "formats/io/error.hpp"
#include "formats/io/file.hpp"
#include "precompute/verify/paper.hpp"
#include "tools/cli/output.hpp"
#include "tools/cli/verify_checks.hpp"
#include "tools/play/plot.hpp"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace palpate::cli {
namespace {

using Json = nlohmann::ordered_json;

// One abscissa for all: every place that any curve has; a curve is left out beyond its own.
std::string plot(const verify::PaperFigure& figure) {
  std::vector<double> x;
  for (const verify::PaperPanel& panel : figure.panels) {
    for (const verify::PaperCurve& curve : panel.curves) x.insert(x.end(), curve.at.begin(), curve.at.end());
  }
  std::sort(x.begin(), x.end());
  x.erase(std::unique(x.begin(), x.end()), x.end());
  std::vector<PlotPanel> panels;
  for (const verify::PaperPanel& panel : figure.panels) {
    PlotPanel& drawn = panels.emplace_back(PlotPanel{panel.title + ": force (N)", {}});
    for (const verify::PaperCurve& curve : panel.curves) {
      PlotSeries& line = drawn.series.emplace_back(PlotSeries{curve.name, {}});
      for (const double at : x) line.values.push_back(verify::force_at(curve, at));
    }
  }
  for (double& at : x) at *= 1e3;
  return line_plot_svg(figure.title, figure.abscissa + " (mm)", x, panels);
}

Json to_json(const verify::PaperFigure& figure) {
  Json json{{"title", figure.title}, {"panels", Json::array()}, {"statements", Json::array()}};
  for (const verify::PaperPanel& panel : figure.panels) {
    Json& drawn = json["panels"].emplace_back(Json{{"title", panel.title}, {"curves", Json::array()}});
    for (const verify::PaperCurve& c : panel.curves) {
      drawn["curves"].push_back({{"name", c.name}, {"at_m", c.at}, {"force_N", c.force}});
    }
  }
  for (const verify::PaperStatement& s : figure.statements) {
    json["statements"].push_back(
        {{"text", s.text}, {"figure", s.figure}, {s.at_most ? "at_most" : "at_least", s.limit}, {"holds", s.holds()}});
  }
  return json;
}

std::string to_text(const verify::PaperFigure& figure) {
  std::string text = figure.title + "\n";
  for (const verify::PaperStatement& s : figure.statements) {
    char figures[80];
    std::snprintf(figures, sizeof figures, ": %.1f %%, at %s %.0f %%", 100 * s.figure, s.at_most ? "most" : "least",
                  100 * s.limit);
    text += std::string(s.holds() ? "  holds  " : "  FAILS  ") + s.text + figures + "\n";
  }
  return text;
}

}  // namespace

void run_paper_command(const PaperCommand& command, const Globals& globals) {
  const std::filesystem::path folder = command.folder;
  const synth::PaperScenes scenes = synth::write_paper_scenes(folder);
  note(globals, "solving figures 2 and 4");
  const auto threads = static_cast<unsigned>(globals.threads);
  const verify::PaperFigure two = verify::solve_figure_2(read_scene(scenes.loose), read_scene(scenes.firm), threads);
  const verify::PaperFigure four =
      verify::solve_figure_4(read_scene(scenes.homogeneous), read_scene(scenes.inclusion), threads);
  write_file(folder / "paper-figure-2.svg", plot(two));
  write_file(folder / "paper-figure-4.svg", plot(four));
  const Json json{{"figure_2", to_json(two)}, {"figure_4", to_json(four)}};
  if (!command.report.empty()) write_report(command.report, json);
  if (globals.json) {
    print_json(json);
  } else {
    print(to_text(two) + to_text(four));
  }
  for (const verify::PaperFigure* figure : {&two, &four}) {
    for (const verify::PaperStatement& s : figure->statements) {
      if (!s.holds()) throw Error(ExitCode::tolerance, figure->title + ": it does not hold that " + s.text);
    }
  }
}

}  // namespace palpate::cli
