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

const JournalPair* accepted(const JournalContent& journal, std::uint32_t pair) {
  const auto at = journal.pairs.find(pair);
  if (at == journal.pairs.end() || !at->second.outcome || !at->second.outcome->accepted) return nullptr;
  return &at->second;
}

std::map<std::uint32_t, fit::NormalCurve> curves_of(const bake::Plan& plan, const JournalContent& journal,
                                                    const Row& row) {
  std::map<std::uint32_t, fit::NormalCurve> curves;
  for (std::uint32_t pair = 0; pair < plan.pairs.size(); ++pair) {
    const PairPlan& p = plan.pairs[pair];
    if (p.role != PairRole::normal || Row(p.tool, p.tool_vertex) != row) continue;
    if (const JournalPair* solved = accepted(journal, pair)) curves.emplace(p.site, solved->samples);
  }
  return curves;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// A hidden push: its place in the mesh, and how far off the prediction was at each depth.
struct HiddenError {
  std::int32_t patch = 0;
  Vector3d at{0, 0, 0}, weights{0, 0, 0};
  std::vector<double> errors;
  [[nodiscard]] double mean() const {
    return std::accumulate(errors.begin(), errors.end(), 0.0) / static_cast<double>(errors.size());
  }
  [[nodiscard]] double worst() const { return *std::max_element(errors.begin(), errors.end()); }
};

/// A plan with its outcomes, as the next round is made from it.
class SolvedRound {
public:
  SolvedRound(const Sampled& sampled, const sites::HapticMesh& mesh, const bake::Plan& plan,
              const JournalContent& journal)
      : sampled_(sampled), mesh_(mesh), plan_(plan), graph_(fit::site_graph(plan.sites.size(), mesh.triangles)) {
    for (std::uint32_t tool = 0; tool < sampled.tools.size(); ++tool) {
      for (std::uint32_t vertex = 0; vertex < sampled.tools[tool].vertices.size(); ++vertex) {
        const Row row(tool, vertex);
        fields_.emplace(row, fit::PushField(plan.sites, graph_, curves_of(plan, journal, row)));
      }
    }
    compare(journal);
  }

  [[nodiscard]] bake::SamplingEstimate estimate() const {
    bake::SamplingEstimate result;
    std::vector<double> errors;
    for (const HiddenError& h : hidden_) {
      errors.insert(errors.end(), h.errors.begin(), h.errors.end());
      if (h.worst() < result.worst) continue;
      result.worst = h.worst();
      result.worst_at = h.at;
    }
    result.places = hidden_.size();
    if (errors.empty()) return result;
    std::sort(errors.begin(), errors.end());
    result.median = errors[(errors.size() - 1) / 2];
    result.p95 = errors[(95 * errors.size() + 99) / 100 - 1];
    result.met = result.p95 <= kLimits.aim * sampled_.scene.response.tolerance;
    return result;
  }

  /// Relative errors in the middle of edges predicted by their sites, and of patches that missed a hidden push.
  [[nodiscard]] std::map<sites::SiteEdge, double> edge_errors() const {
    std::map<sites::SiteEdge, double> errors;
    for (const auto& [row, field] : fields_) add_edges(field, errors);
    // The predicted ones are differences of differences: hidden pushes say how large they are. Medians are not moved by
    // a fold, which is wrong by far more in a few patches alone.
    std::vector<double> estimated, measured;
    for (const HiddenError& h : hidden_) {
      estimated.push_back(in_patch(errors, h));
      measured.push_back(h.mean());
    }
    const double predicted = median(std::move(estimated));
    const double scale = predicted > 0 ? std::clamp(median(std::move(measured)) / predicted, 0.5, 4.0) : 1.0;
    for (auto& [edge, error] : errors) error *= scale;
    for (const HiddenError& h : hidden_) {
      if (h.worst() < sampled_.scene.response.tolerance) continue;
      for (int k = 0; k < 3; ++k) {
        double& error = errors[edge(h.patch, k)];
        error = std::max(error, h.worst());
      }
    }
    return errors;
  }

private:
  [[nodiscard]] sites::SiteEdge edge(std::int32_t patch, int k) const {
    const auto& t = mesh_.triangles[patch];
    return {std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])};
  }

  /// Error of linear interpolation in a patch, from those in the middle of its edges: sum of 4 w_a w_b e_ab.
  [[nodiscard]] double in_patch(const std::map<sites::SiteEdge, double>& errors, const HiddenError& h) const {
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
      const auto at = errors.find(edge(h.patch, k));
      if (at != errors.end()) sum += 4 * h.weights[k] * h.weights[(k + 1) % 3] * at->second;
    }
    return sum;
  }

  void compare(const JournalContent& journal) {
    Surface coarse;
    coarse.vertices = mesh_.points;
    coarse.triangles = mesh_.triangles;
    coarse.parts.assign(coarse.triangles.size(), 0);
    coarse.part_names = {"patches"};
    const geometry::SurfaceQuery query(coarse);
    for (std::uint32_t pair = 0; pair < plan_.pairs.size(); ++pair) {
      const PairPlan& p = plan_.pairs[pair];
      const JournalPair* solved = p.role == PairRole::hidden ? accepted(journal, pair) : nullptr;
      if (solved == nullptr) continue;
      HiddenError h;
      h.at = p.frame.origin;
      h.patch = query.closest(h.at).triangle;
      const auto& t = mesh_.triangles[h.patch];
      h.weights =
          geometry::closest_on_triangle(h.at, mesh_.points[t[0]], mesh_.points[t[1]], mesh_.points[t[2]]).weights;
      const fit::PushField& field = fields_.at({p.tool, p.tool_vertex});
      if (!(field.known(t[0]) && field.known(t[1]) && field.known(t[2]))) continue;
      double peak = 0;
      for (const Sample& s : solved->samples) peak = std::max(peak, s.force.norm());
      const double least = std::max(0.02 * peak, sampled_.scene.response.floor);
      for (const Sample& s : solved->samples) {
        Vector3d predicted = Vector3d::Zero();
        for (int c = 0; c < 3; ++c) predicted += h.weights[c] * field.force(t[c], s.deflection.z(), p.frame);
        h.errors.push_back((predicted - s.force).norm() / std::max(s.force.norm(), least));
      }
      hidden_.push_back(std::move(h));
    }
  }

  /// At the least depth of the sites round it.
  [[nodiscard]] Vector3d slope(const fit::PushField& field, std::uint32_t site) const {
    double depth = plan_.sites[site].depth;
    for (const std::uint32_t near : graph_[site]) depth = std::min(depth, plan_.sites[near].depth);
    return field.slope(site, depth);
  }

  void add_edges(const fit::PushField& field, std::map<sites::SiteEdge, double>& errors) const {
    std::vector<Vector3d> slopes(plan_.sites.size(), Vector3d::Zero());
    for (std::uint32_t site = 0; site < slopes.size(); ++site) {
      if (field.solved(site)) slopes[site] = slope(field, site);
    }
    for (std::uint32_t a = 0; a < graph_.size(); ++a) {
      for (const std::uint32_t b : graph_[a]) {
        if (b < a || (!field.solved(a) && !field.solved(b)) || !plan_.sites[a].selected || !plan_.sites[b].selected) {
          continue;
        }
        const Vector3d d = plan_.sites[b].frame.origin - plan_.sites[a].frame.origin;
        const double first = slopes[a].dot(d), last = slopes[b].dot(d);
        // A cubic with these slopes is as far from the line between its ends. The slope of an end that was extrapolated
        // is not known: that of the other may change by a quarter.
        const double error = std::abs(field.solved(a) && field.solved(b) ? last - first : (first + last) / 4) / 8;
        double& known = errors[{static_cast<std::int32_t>(a), static_cast<std::int32_t>(b)}];
        known = std::max(known, error);
      }
    }
  }

  const Sampled& sampled_;
  const sites::HapticMesh& mesh_;
  const bake::Plan& plan_;
  fit::SiteGraph graph_;
  std::map<Row, fit::PushField> fields_;
  std::vector<HiddenError> hidden_;
};

/// Edges to split at most, over the number of sites. The error of linear interpolation goes as one over that number, and
/// twice the missing sites are added, because not every one falls where it is needed.
double growth(const bake::SamplingEstimate& estimate, double aim) {
  if (estimate.places == 0) return kLimits.growth;
  return std::clamp(2 * (estimate.p95 / aim - 1), kLimits.least_growth, kLimits.growth);
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

bake::SamplingEstimate judge(const Sampled& sampled, const sites::HapticMesh& mesh, const bake::Plan& plan,
                             const JournalContent& journal) {
  return SolvedRound(sampled, mesh, plan, journal).estimate();
}

bool add_round(const Sampled& sampled, const JournalContent& journal, sites::HapticMesh& mesh, bake::Plan& plan) {
  const auto most = static_cast<std::size_t>(sampled.scene.sampling.most_sites);
  if (mesh.points.size() >= most) return false;
  const double least = kLimits.least_edge * smallest_radius(sampled.scene);
  const SolvedRound round(sampled, mesh, plan, journal);
  std::vector<std::pair<double, sites::SiteEdge>> worst;
  for (const auto& [edge, error] : round.edge_errors()) {
    if ((mesh.points[edge[0]] - mesh.points[edge[1]]).norm() > 2 * least) worst.emplace_back(error, edge);
  }
  std::sort(worst.begin(), worst.end(), std::greater<>());
  const double tolerance = kLimits.aim * sampled.scene.response.tolerance;
  const auto above = static_cast<std::size_t>(
      std::find_if(worst.begin(), worst.end(), [&](const auto& w) { return w.first < tolerance; }) - worst.begin());
  // A round that found its percentile missed and no edge to blame splits the worst tenth.
  std::size_t count = std::max(above, worst.size() / 10);
  const double share = growth(round.estimate(), tolerance);
  count = std::min({count, static_cast<std::size_t>(share * static_cast<double>(mesh.points.size())),
                    most - mesh.points.size(), worst.size()});
  if (count == 0) return false;
  std::vector<sites::SiteEdge> edges;
  for (std::size_t k = 0; k < count; ++k) edges.push_back(worst[k].second);
  sites::split_edges(sampled.scene, sampled.body, edges, mesh);
  std::set<std::uint32_t> pushed;
  for (std::uint32_t pair = 0; pair < plan.pairs.size(); ++pair) {
    if (plan.pairs[pair].role == PairRole::normal && accepted(journal, pair)) pushed.insert(plan.pairs[pair].site);
  }
  bake::add_sites(plan, sampled.body, mesh, sampled.tools, PairRole::normal);
  add_full(sampled, pushed, plan);
  add_hidden(sampled, kLimits.more, plan);
  return true;
}

}  // namespace palpate::pipeline
