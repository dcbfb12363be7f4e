// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/pipeline/rounds.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <tuple>

#include "precompute/bake/reach.hpp"
#include "precompute/fit/push_field.hpp"
#include "precompute/geometry/feature_normals.hpp"
#include "precompute/solve/pair/pair.hpp"

namespace palpate::pipeline {
namespace {

using Eigen::Vector3d;
using Row = std::pair<std::uint32_t, std::uint32_t>;  // tool, tool vertex

constexpr RoundLimits kLimits;
constexpr std::uint64_t kSeed = 0x5EED;

double smallest_radius(const Scene& scene) {
  double radius = HUGE_VAL;
  for (const ToolScene& tool : scene.tools) radius = std::min(radius, tool.radius);
  return radius;
}

/// Edges to split at most, over the number of sites. The error of linear interpolation goes as one over that number,
/// and twice the missing sites are added, because not every one falls where it is needed.
double growth(const bake::SamplingEstimate& estimate, double aim) {
  if (estimate.places == 0) return kLimits.growth;
  return std::clamp(2 * (estimate.p95() / aim - 1), kLimits.least_growth, kLimits.growth);
}

/// Pairs in full at sites as far from one another as can be, until their share is reached. `pushed` sites may be taken.
void add_full(const Sampled& sampled, const std::set<std::uint32_t>& pushed, bake::Plan& plan) {
  std::set<std::uint32_t> full;
  for (const PairPlan& p : plan.pairs) {
    if (p.role == PairRole::full) full.insert(p.site);
  }
  const auto wanted =
      std::max(kLimits.least_full,
               static_cast<std::size_t>(std::ceil(kLimits.full_share * static_cast<double>(plan.sites.size()))));
  std::vector<double> far(plan.sites.size(), HUGE_VAL);
  const auto approach = [&](std::uint32_t site) {
    for (const std::uint32_t other : pushed) {
      far[other] = std::min(far[other], (plan.sites[other].frame.origin - plan.sites[site].frame.origin).squaredNorm());
    }
  };
  for (const std::uint32_t site : full) approach(site);
  std::set<std::uint32_t> chosen;
  while (full.size() + chosen.size() < wanted && !pushed.empty()) {
    const std::uint32_t next =
        *std::max_element(pushed.begin(), pushed.end(), [&](auto a, auto b) { return far[a] < far[b]; });
    if (!(far[next] > 0)) break;
    chosen.insert(next);
    approach(next);
  }
  std::vector<PairPlan> added;
  for (const PairPlan& p : plan.pairs) {
    // How a bonded tool is pulled is not carried.
    const bool bonds = sampled.tools[p.tool].scene.grasp_depth > 0 && full.count(p.site) == 0;
    if (p.role != PairRole::normal || !(bonds || chosen.count(p.site) > 0)) continue;
    added.push_back(p);
    added.back().role = PairRole::full;
  }
  plan.pairs.insert(plan.pairs.end(), added.begin(), added.end());
}

/// Places drawn evenly over the body's surface, where a tool vertex (each in turn) can touch.
void add_hidden(const Sampled& sampled, std::size_t count, bake::Plan& plan) {
  std::vector<Row> rows;
  for (std::uint32_t tool = 0; tool < sampled.tools.size(); ++tool) {
    for (std::uint32_t v = 0; v < sampled.tools[tool].vertices.size(); ++v) rows.emplace_back(tool, v);
  }
  const auto number = static_cast<std::uint32_t>(
      std::count_if(plan.pairs.begin(), plan.pairs.end(), [](const auto& p) { return p.role == PairRole::hidden; }));
  std::mt19937_64 engine(kSeed + number);
  const auto uniform = [&] { return static_cast<double>(engine() >> 11U) * 0x1.0p-53; };
  const Surface& surface = sampled.body.query->surface();
  std::vector<double> areas;
  double sum = 0;
  for (const auto& t : surface.triangles) {
    const Vector3d &a = surface.vertices[t[0]], &b = surface.vertices[t[1]], &c = surface.vertices[t[2]];
    areas.push_back(sum += (b - a).cross(c - a).norm());
  }
  const SamplingScene& sampling = sampled.scene.sampling;
  std::uint32_t placed = 0;
  for (std::size_t drawn = 0; placed < count && drawn < 100 * count; ++drawn) {
    const double u = uniform() * sum, r = std::sqrt(uniform()), s = uniform();
    const auto at = std::min<std::size_t>(
        static_cast<std::size_t>(std::upper_bound(areas.begin(), areas.end(), u) - areas.begin()), areas.size() - 1);
    const auto& t = surface.triangles[at];
    PairPlan pair;
    pair.site = number + placed;
    pair.role = PairRole::hidden;
    std::tie(pair.tool, pair.tool_vertex) = rows[(number + placed) % rows.size()];
    pair.frame.origin =
        (1 - r) * surface.vertices[t[0]] + r * (1 - s) * surface.vertices[t[1]] + r * s * surface.vertices[t[2]];
    const Vector3d& o = pair.frame.origin;
    if (sampled.body.in_cavity(o) ||
        (sampling.within_box && !((o.array() >= sampling.within_box->first.array()).all() &&
                                  (o.array() <= sampling.within_box->second.array()).all()))) {
      continue;
    }
    pair.frame.n = sampled.body.query->normal(o, sites::normal_radius(sampled.scene));
    pair.frame.x = pair.frame.n.unitOrthogonal();
    pair.frame.y = pair.frame.n.cross(pair.frame.x);
    pair.depth = std::min(sampling.depth, sampling.depth_fraction * sampled.body.query->thickness(o, pair.frame.n));
    const tool::Tool& tool = sampled.tools[pair.tool];
    const tool::ToolVertex& vertex = tool.vertices[pair.tool_vertex];
    if (bake::reaches_support({sampled.body, tool, vertex, pair.frame}, pair.depth) ||
        !bake::can_touch_first({sampled.body, tool, vertex, pair.frame})) {
      continue;
    }
    plan.pairs.push_back(pair);
    ++placed;
  }
}

}  // namespace

double first_spacing(const Scene& scene, const Body& body) {
  // Sites of an even triangulation are an edge squared times sqrt(3) / 2 apart.
  return std::max(std::sqrt(2 / std::sqrt(3.0) * body.report.area / kLimits.first_sites), smallest_radius(scene) / 2);
}

bake::Plan first_round(const Sampled& sampled, const sites::HapticMesh& mesh) {
  bake::Plan plan = bake::make_plan(sampled.scene, sampled.body, mesh, sampled.tools, PairRole::normal);
  plan.inputs.scene = Hasher()
                          .text(canonical_text(sampled.scene, CanonicalScope::solves))
                          .number(std::int64_t{kRoundsRevision})
                          .number(sampled.scene.response.tolerance)
                          .number(sampled.scene.response.floor)
                          .number(std::int64_t{sampled.scene.sampling.most_sites})
                          .digest();
  std::set<std::uint32_t> pushed;
  for (const PairPlan& p : plan.pairs) pushed.insert(p.site);
  add_full(sampled, pushed, plan);
  add_hidden(sampled, kLimits.hidden, plan);
  return plan;
}

bool add_round(const Sampled& sampled, const JournalContent& journal, const RoundErrors& errors,
               sites::HapticMesh& mesh, bake::Plan& plan) {
  const auto most = static_cast<std::size_t>(sampled.scene.sampling.most_sites);
  if (mesh.points.size() >= most) return false;
  const double least = kLimits.least_edge * smallest_radius(sampled.scene);
  std::vector<std::pair<double, sites::SiteEdge>> worst;
  for (const auto& [edge, error] : errors.edges) {
    if ((mesh.points[edge[0]] - mesh.points[edge[1]]).norm() > 2 * least) worst.emplace_back(error, edge);
  }
  std::sort(worst.begin(), worst.end(), std::greater<>());
  const double tolerance = kLimits.aim * sampled.scene.response.tolerance;
  const auto above = static_cast<std::size_t>(
      std::find_if(worst.begin(), worst.end(), [&](const auto& w) { return w.first < tolerance; }) - worst.begin());
  // A round that found its percentile missed and no edge to blame splits the worst tenth.
  std::size_t count = std::max(above, (worst.size() + 9) / 10);
  const double share = growth(errors.estimate, tolerance);
  count = std::min({count, static_cast<std::size_t>(share * static_cast<double>(mesh.points.size())),
                    most - mesh.points.size(), worst.size()});
  if (count == 0) return false;
  std::vector<sites::SiteEdge> edges;
  for (std::size_t k = 0; k < count; ++k) edges.push_back(worst[k].second);
  sites::split_edges(sampled.scene, sampled.body, edges, mesh);
  std::set<std::uint32_t> pushed;
  for (std::uint32_t pair = 0; pair < plan.pairs.size(); ++pair) {
    if (plan.pairs[pair].role == PairRole::normal && journal.accepted(pair)) pushed.insert(plan.pairs[pair].site);
  }
  bake::add_sites(plan, sampled.body, mesh, sampled.tools, PairRole::normal);
  add_full(sampled, pushed, plan);
  add_hidden(sampled, kLimits.more, plan);
  return true;
}

}  // namespace palpate::pipeline
