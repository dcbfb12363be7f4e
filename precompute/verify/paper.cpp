// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/verify/paper.hpp"

#include "formats/io/error.hpp"
#include "precompute/bake/parallel.hpp"
#include "precompute/solve/pair/pair.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::verify {
namespace {

using Eigen::Vector3d;

// One contact, solved as a bake would: at a place of the sample's top, down and then perhaps along the surface.
struct PaperPush {
  const Scene* scene = nullptr;
  const Body* body = nullptr;
  std::size_t tool = 0;
  Vector3d site{0, 0, 0};
  int directions = 0;  // tangential, from +x on
};

std::vector<std::vector<Sample>> solve(const std::vector<PaperPush>& pushes, unsigned threads) {
  std::vector<std::vector<Sample>> all(pushes.size());
  bake::parallel_for(pushes.size(), threads, {}, [&](std::size_t k) {
    const PaperPush& push = pushes[k];
    const Scene& scene = *push.scene;
    const tool::Tool tool = tool::make_tool(scene.tools.at(push.tool));
    ContactFrame frame;
    frame.origin = push.site;
    solve::PairPath path = solve::bake_path(scene, scene.sampling.depth);
    path.tangential_directions = push.directions;
    path.tangential_depths = {path.normal_depths.back()};
    const PairResult r =
        solve::solve_pair({*push.body, tool, tool.vertices.at(0), frame}, path, solve::pair_options(scene));
    if (!r.outcome.accepted || !r.outcome.cause.empty()) {
      throw Error(ExitCode::numerical, scene.name + ", " + tool.name + ": " + r.outcome.cause);
    }
    all[k] = r.samples;
  });
  return all;
}

PaperCurve normal_curve(const std::string& name, const std::vector<Sample>& samples) {
  PaperCurve curve{name, {0}, {0}};
  for (const Sample& s : samples) {
    if (s.kind != SampleKind::normal) continue;
    curve.at.push_back(s.deflection.z());
    curve.force.push_back(s.force.z());
  }
  return curve;
}

const Sample& deepest(const std::vector<Sample>& samples) {
  const auto after =
      std::find_if(samples.begin(), samples.end(), [](const Sample& s) { return s.kind != SampleKind::normal; });
  return *std::prev(after);
}

// The force along `component` of the push towards the side of x that `side` has, over the deflection; times `sign`.
PaperCurve tangential_curve(const std::string& name, const std::vector<Sample>& samples, double side, int component,
                            double sign) {
  PaperCurve curve{name, {0}, {sign * deepest(samples).force[component]}};
  for (const Sample& s : samples) {
    if (s.kind != SampleKind::tangential || s.deflection.x() * side <= 0) continue;
    curve.at.push_back(std::abs(s.deflection.x()));
    curve.force.push_back(sign * s.force[component]);
  }
  return curve;
}

// Force that a tangential push adds against itself. It excludes the tangential force of the normal indentation beside a
// lump.
PaperCurve answer(const std::string& name, const std::vector<Sample>& samples, double side) {
  PaperCurve curve = tangential_curve(name, samples, side, 0, -side);
  const double before = curve.force[0];
  for (double& f : curve.force) f -= before;
  return curve;
}

// Largest difference up to a place, over the second curve's force at the end of the plot: what an eye sees.
double difference(const PaperCurve& a, const PaperCurve& b, double upto, double end) {
  double worst = 0;
  for (int k = 1; k <= 100; ++k) {
    const double d = std::abs(force_at(a, upto * k / 100) - force_at(b, upto * k / 100));
    if (!(d <= worst) && !std::isnan(worst)) worst = d;  // not a number stays
  }
  return worst / std::abs(force_at(b, end));
}

// Least difference up to a place, each over the second curve's force where it is: how far apart they are from the
// first.
double least_difference(const PaperCurve& a, const PaperCurve& b, double upto) {
  double least = std::numeric_limits<double>::max();
  for (int k = 1; k <= 100; ++k) {
    const double d = std::abs(force_at(a, upto * k / 100) / force_at(b, upto * k / 100) - 1);
    if (!(d >= least) && !std::isnan(least)) least = d;
  }
  return least;
}

double reach(const PaperPanel& panel) {
  double least = std::numeric_limits<double>::max();
  for (const PaperCurve& c : panel.curves) least = std::min(least, c.at.back());
  return least;
}

}  // namespace

double force_at(const PaperCurve& curve, double at) {
  const auto above = std::lower_bound(curve.at.begin(), curve.at.end(), at * (1 - 1e-12));
  if (above == curve.at.end() || at < curve.at.front()) return std::numeric_limits<double>::quiet_NaN();
  const auto k = static_cast<std::size_t>(above - curve.at.begin());
  if (k == 0) return curve.force[0];
  const double share = (at - curve.at[k - 1]) / (curve.at[k] - curve.at[k - 1]);
  return curve.force[k - 1] + share * (curve.force[k] - curve.force[k - 1]);
}

std::vector<PaperStatement> figure_2_statements(const std::vector<PaperPanel>& panels) {
  const auto &loose = panels.at(0).curves, &firm = panels.at(1).curves;
  const double bent = reach(panels[0]), pressed = reach(panels[1]);
  // "At first" is the first half of the depth, on the scale of the plot: a flat face starts linearly, a sphere with a
  // higher power, so near zero their ratio is without bound in any elastic body.
  return {{"loosely supported, the three responses differ only by small details",
           std::max(difference(loose.at(1), loose.at(0), bent, bent), difference(loose.at(2), loose.at(0), bent, bent)),
           0.1, true},
          {"well supported, the flat punch and the large sphere answer alike at first",
           difference(firm.at(2), firm.at(0), pressed / 2, pressed), 0.1, true},
          {"well supported, the small sphere answers completely differently, from the first",
           least_difference(firm.at(1), firm.at(0), pressed), 0.5, false}};
}

std::vector<PaperStatement> figure_4_statements(const std::vector<PaperPanel>& panels) {
  const auto &alike = panels.at(0).curves, &skewed = panels.at(1).curves;
  const double far = reach(panels.at(2));
  const auto force = [&](double at) {
    return Eigen::Vector2d(force_at(panels[2].curves.at(0), at), force_at(panels[2].curves.at(1), at));
  };
  return {{"a homogeneous sample answers a tangential deflection symmetrically",
           difference(alike.at(0), alike.at(1), reach(panels[0]), reach(panels[0])), 0.03, true},
          {"a sample with a hard inclusion on one side answers skewed, more stiffly towards it",
           force_at(skewed.at(0), reach(panels[1])) / force_at(skewed.at(1), reach(panels[1])) - 1, 0.08, false},
          {"the same tool at the same end point, but from another first contact point, meets another force",
           (force(far) - force(0)).norm() / force(0).norm(), 0.1, false}};
}

PaperFigure solve_figure_2(const Scene& loose, const Scene& firm, unsigned threads) {
  const Body bodies[2] = {prepare_body(loose), prepare_body(firm)};
  const Scene* scenes[2] = {&loose, &firm};
  std::vector<PaperPush> pushes;
  for (int k = 0; k < 2; ++k) {
    if (scenes[k]->tools.size() != 3) throw Error(ExitCode::bad_input, scenes[k]->name + ": figure 2 has three tools");
    for (std::size_t tool = 0; tool < 3; ++tool) pushes.push_back({scenes[k], &bodies[k], tool, {0, 0, 0}, 0});
  }
  const auto samples = solve(pushes, threads);
  PaperFigure figure{
      "Figure 2: three tools on one strip", "depth", {{"loosely supported", {}}, {"well supported", {}}}, {}};
  for (std::size_t k = 0; k < pushes.size(); ++k) {
    figure.panels[k / 3].curves.push_back(normal_curve(pushes[k].scene->tools[pushes[k].tool].name, samples[k]));
  }
  figure.statements = figure_2_statements(figure.panels);
  return figure;
}

PaperFigure solve_figure_4(const Scene& homogeneous, const Scene& inclusion, unsigned threads) {
  const Body plain = prepare_body(homogeneous), lumpy = prepare_body(inclusion);
  const double depth = homogeneous.sampling.depth;
  std::vector<PaperPush> pushes{{&homogeneous, &plain, 0, {0, 0, 0}, 2}, {&inclusion, &lumpy, 0, {0, 0, 0}, 2}};
  // First contact points beside the end point, which lies below the origin.
  std::vector<double> beside;
  for (const double share : {0.4, 0.8}) {
    beside.push_back(share * depth);
    pushes.push_back({&homogeneous, &plain, 0, {-beside.back(), 0, 0}, 1});
  }
  const auto samples = solve(pushes, threads);
  PaperPanel end{
      "same end point",
      {{"normal", {0}, {deepest(samples[0]).force.z()}}, {"tangential", {0}, {-deepest(samples[0]).force.x()}}}};
  for (std::size_t k = 0; k < beside.size(); ++k) {
    const auto& dragged = samples[2 + k];
    end.curves[0].at.push_back(beside[k]);
    end.curves[1].at.push_back(beside[k]);
    end.curves[0].force.push_back(force_at(tangential_curve("", dragged, 1, 2, 1), beside[k]));
    end.curves[1].force.push_back(force_at(tangential_curve("", dragged, 1, 0, -1), beside[k]));
  }
  PaperFigure figure{
      "Figure 4: tangential responses and the first contact point",
      "tangential distance from the first contact point to the tool's end point",
      {{"homogeneous", {answer("to the right", samples[0], 1), answer("to the left", samples[0], -1)}},
       {"inclusion right", {answer("to the right", samples[1], 1), answer("to the left", samples[1], -1)}},
       end},
      {}};
  figure.statements = figure_4_statements(figure.panels);
  return figure;
}

}  // namespace palpate::verify
