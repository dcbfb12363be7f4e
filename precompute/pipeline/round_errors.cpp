// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/pipeline/round_errors.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "precompute/fit/push_field.hpp"
#include "precompute/geometry/feature_normals.hpp"
#include "precompute/pipeline/round_limits.hpp"

namespace palpate::pipeline {
namespace {

using Eigen::Vector3d;
using Row = std::pair<std::uint32_t, std::uint32_t>;  // tool, tool vertex

constexpr int kDepths = 6;  // at which errors of edges are predicted

std::map<std::uint32_t, fit::NormalCurve> curves_of(const bake::Plan& plan, const JournalContent& journal,
                                                    const Row& row) {
  std::map<std::uint32_t, fit::NormalCurve> curves;
  for (std::uint32_t pair = 0; pair < plan.pairs.size(); ++pair) {
    const PairPlan& p = plan.pairs[pair];
    if (p.role != PairRole::normal || Row(p.tool, p.tool_vertex) != row) continue;
    if (const JournalPair* solved = journal.accepted(pair)) curves.emplace(p.site, solved->samples);
  }
  return curves;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double mean(const std::vector<double>& values) {
  return values.empty() ? 0.0 : std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// A hidden push: its place in the mesh, and how far off the prediction was at each depth.
struct HiddenError {
  std::int32_t patch = 0;
  Vector3d at{0, 0, 0}, weights{0, 0, 0};
  std::vector<double> errors;
  [[nodiscard]] double worst() const { return *std::max_element(errors.begin(), errors.end()); }
};

/// A plan whose pairs all have an outcome.
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
    measure_split_edges(journal);
  }

  [[nodiscard]] RoundErrors errors() const {
    RoundErrors result;
    result.edges = edge_errors();
    result.estimate = estimate(result.edges);
    return result;
  }

private:
  [[nodiscard]] bake::SamplingEstimate estimate(const std::map<sites::SiteEdge, double>& edges) const {
    bake::SamplingEstimate result;
    result.edges_p95 = edges_p95(edges);
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
    result.hidden_p95 = errors[(95 * errors.size() + 99) / 100 - 1];
    result.met = result.p95() <= RoundLimits{}.aim * sampled_.scene.response.tolerance;
    return result;
  }

  [[nodiscard]] std::map<sites::SiteEdge, double> edge_errors() const {
    std::map<sites::SiteEdge, double> errors;
    for (const auto& [row, field] : fields_) {
      for (const auto& [edge, error] : edges_of(field)) errors[edge] = std::max(errors[edge], error);
    }
    // These are differences of differences: hidden pushes say how large they are. Medians are not moved by a fold,
    // which is wrong by far more in a few patches alone.
    std::vector<double> estimated, measured;
    for (const HiddenError& h : hidden_) {
      estimated.push_back(in_patch(errors, h.patch, h.weights));
      measured.push_back(mean(h.errors));
    }
    const double predicted = median(std::move(estimated));
    const double scale = predicted > 0 ? std::clamp(median(std::move(measured)) / predicted, 0.5, 4.0) : 1.0;
    for (auto& [edge, error] : errors) {
      error *= scale;
      // Slopes at the ends do not show a kink between them, whose error goes with the length.
      for (const std::int32_t site : edge) error = std::max(error, split_errors_[site] * length(edge));
    }
    return errors;
  }

  [[nodiscard]] sites::SiteEdge edge(std::int32_t patch, int k) const {
    const auto& t = mesh_.triangles[patch];
    return {std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])};
  }

  /// Error of linear interpolation in a patch, from those in the middle of its edges: sum of 4 w_a w_b e_ab.
  [[nodiscard]] double in_patch(const std::map<sites::SiteEdge, double>& errors, std::int32_t patch,
                                const Vector3d& weights) const {
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
      const auto at = errors.find(edge(patch, k));
      if (at != errors.end()) sum += 4 * weights[k] * weights[(k + 1) % 3] * at->second;
    }
    return sum;
  }

  /// 95th percentile, over the area of the patches with a solved site, of what their edges predict.
  [[nodiscard]] double edges_p95(const std::map<sites::SiteEdge, double>& errors) const {
    std::vector<std::pair<double, double>> parts;  // error, area
    double sum = 0;
    for (std::int32_t patch = 0; patch < static_cast<std::int32_t>(mesh_.triangles.size()); ++patch) {
      if (errors.count(edge(patch, 0)) + errors.count(edge(patch, 1)) + errors.count(edge(patch, 2)) == 0) continue;
      const auto& t = mesh_.triangles[patch];
      const Vector3d &a = mesh_.points[t[0]], &b = mesh_.points[t[1]], &c = mesh_.points[t[2]];
      const double area = (b - a).cross(c - a).norm();
      // The centroids of the four triangles between the corners and the middles of the edges.
      for (const Vector3d& w : {Vector3d(4, 1, 1), Vector3d(1, 4, 1), Vector3d(1, 1, 4), Vector3d(2, 2, 2)}) {
        parts.emplace_back(in_patch(errors, patch, w / 6), area);
        sum += area;
      }
    }
    std::sort(parts.begin(), parts.end());
    double below = 0;
    for (const auto& [error, area] : parts) {
      below += area;
      if (below >= 0.95 * sum) return error;
    }
    return 0;
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
      const JournalPair* solved = p.role == PairRole::hidden ? journal.accepted(pair) : nullptr;
      if (solved == nullptr) continue;
      HiddenError h;
      h.at = p.frame.origin;
      h.patch = query.closest(h.at).triangle;
      const auto& t = mesh_.triangles[h.patch];
      h.weights =
          geometry::closest_on_triangle(h.at, mesh_.points[t[0]], mesh_.points[t[1]], mesh_.points[t[2]]).weights;
      const fit::PushField& field = fields_.at({p.tool, p.tool_vertex});
      if (!(field.known(t[0]) && field.known(t[1]) && field.known(t[2]))) continue;
      h.errors = interpolation_errors(field, p.frame, {t[0], t[1], t[2]}, h.weights, solved->samples);
      hidden_.push_back(std::move(h));
    }
  }

  /// Force (N) that relative errors of smaller forces are relative to.
  [[nodiscard]] double least(double peak) const { return std::max(0.02 * peak, sampled_.scene.response.floor); }

  /// Relative errors, by depth, of a push that is interpolated between sites.
  [[nodiscard]] std::vector<double> interpolation_errors(const fit::PushField& field, const ContactFrame& frame,
                                                         const std::vector<std::int32_t>& sites,
                                                         const Vector3d& weights,
                                                         const std::vector<Sample>& push) const {
    double peak = 0;
    for (const Sample& s : push) peak = std::max(peak, s.force.norm());
    std::vector<double> errors;
    for (const Sample& s : push) {
      Vector3d predicted = Vector3d::Zero();
      for (std::size_t c = 0; c < sites.size(); ++c) {
        predicted += weights[static_cast<Eigen::Index>(c)] * field.force(sites[c], s.deflection.z(), frame);
      }
      errors.push_back((predicted - s.force).norm() / std::max(s.force.norm(), least(peak)));
    }
    return errors;
  }

  /// Measures the error of edges that were split, at the site in their middle, over the length of the edge.
  void measure_split_edges(const JournalContent& journal) {
    split_errors_.assign(mesh_.points.size(), 0.0);
    for (std::uint32_t pair = 0; pair < plan_.pairs.size(); ++pair) {
      const PairPlan& p = plan_.pairs[pair];
      const auto at = mesh_.split.find(static_cast<std::int32_t>(p.site));
      if (p.role != PairRole::normal || at == mesh_.split.end()) continue;
      const sites::SiteEdge& edge = at->second;
      const fit::PushField& field = fields_.at({p.tool, p.tool_vertex});
      const JournalPair* solved = journal.accepted(pair);
      if (solved == nullptr || !field.known(edge[0]) || !field.known(edge[1])) continue;
      const double error =
          mean(interpolation_errors(field, p.frame, {edge[0], edge[1]}, {0.5, 0.5, 0}, solved->samples));
      split_errors_[p.site] = std::max(split_errors_[p.site], error / length(edge));
    }
  }

  [[nodiscard]] double length(const sites::SiteEdge& edge) const {
    return (mesh_.points[edge[0]] - mesh_.points[edge[1]]).norm();
  }

  /// Predicted relative errors in the middle of edges, means over the depths.
  [[nodiscard]] std::map<sites::SiteEdge, double> edges_of(const fit::PushField& field) const {
    std::map<sites::SiteEdge, double> errors;
    for (int k = 1; k <= kDepths; ++k) add_edges(field, k * k / static_cast<double>(kDepths * kDepths), errors);
    return errors;
  }

  /// Their parts at a share of the depth.
  void add_edges(const fit::PushField& field, double share, std::map<sites::SiteEdge, double>& errors) const {
    std::vector<Vector3d> slopes(plan_.sites.size(), Vector3d::Zero());
    std::vector<double> counts(plan_.sites.size(), 0.0);  // of the relative error
    for (std::uint32_t site = 0; site < slopes.size(); ++site) {
      if (!field.solved(site)) continue;
      double depth = plan_.sites[site].depth;
      for (const std::uint32_t near : graph_[site]) depth = std::min(depth, plan_.sites[near].depth);
      slopes[site] = field.slope(site, share * depth);
      const ContactFrame& frame = plan_.sites[site].frame;
      const double here = field.force(site, share * depth, frame).norm();
      counts[site] = here / std::max(here, least(field.force(site, depth, frame).norm()));
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
        errors[{static_cast<std::int32_t>(a), static_cast<std::int32_t>(b)}] +=
            std::max(counts[a], counts[b]) * error / kDepths;
      }
    }
  }

  const Sampled& sampled_;
  const sites::HapticMesh& mesh_;
  const bake::Plan& plan_;
  fit::SiteGraph graph_;
  std::map<Row, fit::PushField> fields_;
  std::vector<HiddenError> hidden_;
  std::vector<double> split_errors_;  // 1/m, by site
};

}  // namespace

RoundErrors round_errors(const Sampled& sampled, const sites::HapticMesh& mesh, const bake::Plan& plan,
                         const JournalContent& journal) {
  return SolvedRound(sampled, mesh, plan, journal).errors();
}

}  // namespace palpate::pipeline
