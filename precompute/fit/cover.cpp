// SPDX-License-Identifier: GPL-3.0-or-later
// Covering by blending: neighbours' fields are sampled in the site's frame and fitted there.
#include "precompute/fit/cover.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <set>

#include "formats/error.hpp"
#include "precompute/algebra/rotation_between.hpp"

namespace palpate::fit {
namespace {

using Eigen::Vector3d;

constexpr int normal_points = 12;
constexpr int levels = 3;  // depths of the sideways samples
constexpr int steps = 3;   // sideways samples a direction

/// A neighbour's field as the target frame sees it.
class CarriedField {
public:
  CarriedField(const ContactFrame& target, const CoverSource& source, const ModelScales& scales)
      : source_(source), scales_(scales) {
    const auto rotation = rotation_between(source.frame->n, target.n).toRotationMatrix();
    const Vector3d x = target.to_local(rotation * source.frame->x), y = target.to_local(rotation * source.frame->y);
    to_target_ << x.x(), y.x(), x.y(), y.y();
  }

  [[nodiscard]] Vector3d force(const Vector3d& deflection) const {
    const Eigen::Vector2d sideways = to_target_.transpose() * deflection.head<2>();
    const Vector3d own = evaluate(source_.site->curves, scales_, {sideways.x(), sideways.y(), deflection.z()});
    const Eigen::Vector2d tangential = to_target_ * own.head<2>();
    return {tangential.x(), tangential.y(), own.z()};
  }

private:
  const CoverSource& source_;
  const ModelScales& scales_;
  Eigen::Matrix2d to_target_;
};

/// Cosine and sine of the source's x axis in `frame`.
Eigen::Vector2d turned(const ContactFrame& frame, const CoverSource& source) {
  const Vector3d x = rotation_between(source.frame->n, frame.n) * source.frame->x;
  return frame.to_local(x).head<2>().normalized();
}

/// Coupled responses are closed under turning and blending: nothing is fitted again.
SiteCurves blend_coupled(const ContactFrame& frame, double depth, const std::vector<CoverSource>& sources,
                         const ModelScales& scales) {
  double total = 0, mean_depth = 0;
  for (const CoverSource& source : sources) {
    total += source.weight;
    mean_depth += source.weight * source.site->depth;
  }
  coupled::Blend blend;
  blend.clear(*scales.coupled);
  for (const CoverSource& source : sources) {
    const Eigen::Vector2d turn = turned(frame, source);
    blend.add(source.site->curves.coupled.data(), 1, 1, source.weight / total, {turn.x(), turn.y()});
  }
  SiteCurves result;
  result.depth = std::min(depth, mean_depth / total);
  result.curves.coupled = Eigen::Map<const Eigen::VectorXd>(blend.coefs(), coupled::count(*scales.coupled));
  return result;
}

/// The field is sampled and fitted again: curves are not closed under turning.
SiteCurves blend_separable(const ContactFrame& frame, double depth, const std::vector<CoverSource>& sources,
                           const ModelScales& scales, const std::string& what) {
  double total = 0, mean_depth = 0;
  std::vector<CarriedField> fields;
  fields.reserve(sources.size());
  for (const CoverSource& source : sources) {
    total += source.weight;
    mean_depth += source.weight * source.site->depth;
    fields.emplace_back(frame, source, scales);
  }
  SiteCurves result;
  result.depth = std::min(depth, mean_depth / total);

  const auto add = [&](std::vector<Sample>& samples, SampleKind kind, const Vector3d& deflection) {
    Sample sample;
    sample.kind = kind;
    sample.index = static_cast<std::uint16_t>(samples.size());
    sample.deflection = deflection;
    for (std::size_t k = 0; k < sources.size(); ++k) {
      const double share = sources[k].weight / total;
      sample.force += share * fields[k].force(deflection);
      sample.friction_limit += share * evaluate_friction(sources[k].site->curves, scales, deflection.z());
    }
    samples.push_back(sample);
  };
  std::vector<Sample> samples;
  for (int k = 1; k <= normal_points; ++k) {
    add(samples, SampleKind::normal, {0, 0, result.depth * k * k / (normal_points * normal_points)});
  }
  for (int level = 1; level <= levels && scales.friction(); ++level) {
    const double z = samples[static_cast<std::size_t>(normal_points * level / levels - 1)].deflection.z();
    for (const Vector3d& direction : {Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(-1, 0, 0), Vector3d(0, -1, 0)}) {
      for (int k = 1; k <= steps; ++k) {
        add(samples, SampleKind::tangential,
            scales.sideways * (z / scales.depth) * k / steps * direction + Vector3d(0, 0, z));
      }
    }
  }
  result.curves = fit_pair(samples, scales, what);
  return result;
}

}  // namespace

SiteGraph site_graph(std::size_t sites, const std::vector<std::array<std::int32_t, 3>>& triangles) {
  std::vector<std::set<std::uint32_t>> near(sites);
  for (const auto& t : triangles) {
    for (int k = 0; k < 3; ++k) {
      const auto a = static_cast<std::uint32_t>(t[k]), b = static_cast<std::uint32_t>(t[(k + 1) % 3]);
      near[a].insert(b);
      near[b].insert(a);
    }
  }
  SiteGraph graph;
  graph.reserve(sites);
  for (const auto& set : near) graph.emplace_back(set.begin(), set.end());
  return graph;
}

SiteCurves blend_site(const ContactFrame& frame, double depth, const std::vector<CoverSource>& sources,
                      const ModelScales& scales, const std::string& what) {
  SiteCurves result = scales.coupled ? blend_coupled(frame, depth, sources, scales)
                                     : blend_separable(frame, depth, sources, scales, what);
  double total = 0, relief = 0;
  for (const CoverSource& source : sources) {
    total += source.weight;
    relief += source.weight * source.site->curves.relief;
  }
  result.curves.relief = relief / total;
  std::vector<GraspShare> grasps;
  std::vector<TurnShare> turns;
  for (const CoverSource& source : sources) {
    if (source.site->grasp) grasps.push_back({&*source.site->grasp, source.weight / total, turned(frame, source)});
    if (source.site->turn) turns.push_back({&*source.site->turn, source.weight / total, turned(frame, source)});
  }
  if (!grasps.empty()) result.grasp = blend_grasps(grasps, scales.depth);
  if (!turns.empty()) result.turn = blend_turns(turns, scales.depth);
  return result;
}

void cover_sites(const SiteGraph& graph, const std::vector<ContactFrame>& frames, const std::vector<double>& depths,
                 const ModelScales& scales, std::vector<std::optional<SiteCurves>>& sites, const std::string& what) {
  const auto known =
      static_cast<std::size_t>(std::count_if(sites.begin(), sites.end(), [](const auto& s) { return s.has_value(); }));
  if (known == 0)
    throw Error(ExitCode::numerical, what + ": not one site has an accepted pair to cover the others from");

  const auto source = [&](std::uint32_t from, std::uint32_t to) {
    const double length = (frames[from].origin - frames[to].origin).norm();
    return CoverSource{&frames[from], &*sites[from], 1.0 / std::max(length, 1e-9)};
  };
  const auto name = [&](std::uint32_t site) { return "covering site " + std::to_string(site) + ", " + what; };
  for (;;) {
    // A round reads only what earlier rounds filled: the order within it does not matter.
    std::vector<std::pair<std::uint32_t, SiteCurves>> filled;
    bool missing = false;
    for (std::uint32_t site = 0; site < sites.size(); ++site) {
      if (sites[site]) continue;
      missing = true;
      std::vector<CoverSource> sources;
      for (const std::uint32_t near : graph[site]) {
        if (sites[near]) sources.push_back(source(near, site));
      }
      if (!sources.empty())
        filled.emplace_back(site, blend_site(frames[site], depths[site], sources, scales, name(site)));
    }
    if (!missing) return;
    if (filled.empty()) {
      // Another component of the surface: its first empty site takes the nearest site there is, then it spreads.
      const auto empty = static_cast<std::uint32_t>(
          std::find_if(sites.begin(), sites.end(), [](const auto& s) { return !s.has_value(); }) - sites.begin());
      std::optional<CoverSource> nearest;
      for (std::uint32_t from = 0; from < sites.size(); ++from) {
        if (!sites[from]) continue;
        const CoverSource candidate = source(from, empty);
        if (!nearest || candidate.weight > nearest->weight) nearest = candidate;
      }
      filled.emplace_back(empty, blend_site(frames[empty], depths[empty], {*nearest}, scales, name(empty)));
    }
    for (auto& [site, curves] : filled) sites[site] = std::move(curves);
  }
}

}  // namespace palpate::fit
