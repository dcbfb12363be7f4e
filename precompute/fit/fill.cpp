// SPDX-License-Identifier: GPL-3.0-or-later
// Responses are closed under rotation and blending, so that nothing is fitted again.
#include "precompute/fit/fill.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <complex>
#include <set>

#include "formats/io/error.hpp"
#include "precompute/algebra/rotation_between.hpp"

namespace palpate::fit {
namespace {

/// Cosine and sine of the source's x axis in `frame`.
Eigen::Vector2d rotated_axis(const ContactFrame& frame, const FillSource& source) {
  const Eigen::Vector3d x = algebra::rotation_between(source.frame->n, frame.n) * source.frame->x;
  return frame.to_local(x).head<2>().normalized();
}

/// Adds a response to `sum` with a share. `axis`: cosine and sine of its x axis in the frame of the sum. The bias is a
/// first harmonic, and rotates by the angle; tensors have second harmonics, which rotate by twice the angle.
void add_rotated(const Eigen::VectorXd& coefs, const response::Degrees& degrees, double share,
                 const Eigen::Vector2d& axis, Eigen::VectorXd& sum) {
  const response::Offsets o = response::offsets(degrees);
  const std::complex<double> first(axis.x(), axis.y()), second = first * first;
  const auto add_pair = [&](int k, const std::complex<double>& by) {
    const std::complex<double> h = share * by * std::complex<double>(coefs[k], coefs[k + 1]);
    sum[k] += h.real();
    sum[k + 1] += h.imag();
  };
  for (int k = 0; k < o.bias; ++k) sum[k] += share * coefs[k];
  for (int k = o.bias; k < o.stiffness; k += 2) add_pair(k, first);
  for (int k = o.stiffness; k < o.friction; k += 3) {
    sum[k] += share * coefs[k];
    add_pair(k + 1, second);
  }
  for (int k = o.friction; k < o.end; ++k) sum[k] += share * coefs[k];
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

SiteResponse blend_sites(const ContactFrame& frame, double depth, const std::vector<FillSource>& sources,
                         const ResponseScales& scales) {
  double total = 0;
  for (const FillSource& source : sources) total += source.weight;
  SiteResponse result;
  result.response.coefs = Eigen::VectorXd::Zero(response::count(scales.degrees));
  std::vector<GraspShare> grasps;
  std::vector<TurnShare> turns;
  double mean_depth = 0;
  for (const FillSource& source : sources) {
    const double share = source.weight / total;
    const Eigen::Vector2d axis = rotated_axis(frame, source);
    const SiteResponse& site = *source.site;
    mean_depth += share * site.depth;
    add_rotated(site.response.coefs, scales.degrees, share, axis, result.response.coefs);
    result.response.softening += share * site.response.softening;
    if (site.grasp) grasps.push_back({&*site.grasp, share, axis});
    if (site.turn) turns.push_back({&*site.turn, share, axis});
  }
  result.depth = std::min(depth, mean_depth);
  if (!grasps.empty()) result.grasp = blend_grasps(grasps, scales.depth);
  if (!turns.empty()) result.turn = blend_turns(turns, scales.depth);
  return result;
}

void fill_from_neighbours(const SiteGraph& graph, const std::vector<ContactFrame>& frames,
                          const std::vector<double>& depths, const ResponseScales& scales,
                          std::vector<std::optional<SiteResponse>>& sites, const std::string& what) {
  const auto known =
      static_cast<std::size_t>(std::count_if(sites.begin(), sites.end(), [](const auto& s) { return s.has_value(); }));
  if (known == 0) throw Error(ExitCode::numerical, what + ": no site has an accepted pair to fill the others from");

  const auto source = [&](std::uint32_t from, std::uint32_t to) {
    const double length = (frames[from].origin - frames[to].origin).norm();
    return FillSource{&frames[from], &*sites[from], 1.0 / std::max(length, 1e-9)};
  };
  for (;;) {
    // A round reads only sites that earlier rounds filled, so that the order within it does not matter.
    std::vector<std::pair<std::uint32_t, SiteResponse>> filled;
    bool missing = false;
    for (std::uint32_t site = 0; site < sites.size(); ++site) {
      if (sites[site]) continue;
      missing = true;
      std::vector<FillSource> sources;
      for (const std::uint32_t near : graph[site]) {
        if (sites[near]) sources.push_back(source(near, site));
      }
      if (!sources.empty()) filled.emplace_back(site, blend_sites(frames[site], depths[site], sources, scales));
    }
    if (!missing) return;
    if (filled.empty()) {
      // In another component of the surface, the first empty site takes the nearest filled one, then it spreads.
      const auto empty = static_cast<std::uint32_t>(
          std::find_if(sites.begin(), sites.end(), [](const auto& s) { return !s.has_value(); }) - sites.begin());
      std::optional<FillSource> nearest;
      for (std::uint32_t from = 0; from < sites.size(); ++from) {
        if (!sites[from]) continue;
        const FillSource candidate = source(from, empty);
        if (!nearest || candidate.weight > nearest->weight) nearest = candidate;
      }
      filled.emplace_back(empty, blend_sites(frames[empty], depths[empty], {*nearest}, scales));
    }
    for (auto& [site, response] : filled) sites[site] = std::move(response);
  }
}

}  // namespace palpate::fit
