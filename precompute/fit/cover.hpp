// SPDX-License-Identifier: GPL-3.0-or-later
// Fills sites that have no curves of their own (refused, on a support, outside the region) from their neighbours.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "precompute/fit/grasp_fit.hpp"
#include "precompute/fit/pair_fit.hpp"
#include "precompute/fit/turn_fit.hpp"

namespace palpate::fit {

/// The curves of a site for one tool vertex.
struct SiteCurves {
  PairCurves curves;
  double depth = 0.0;                ///< m, how deep they were sampled
  std::optional<GraspCurves> grasp;  ///< of a tool that holds on
  std::optional<TurnCurves> turn;    ///< and that is turned
};

/// Per site the sites it shares an edge with, ascending.
using SiteGraph = std::vector<std::vector<std::uint32_t>>;

SiteGraph site_graph(std::size_t sites, const std::vector<std::array<std::int32_t, 3>>& triangles);

/// Curves at `frame` from those of others, weighted (weights need not sum to 1). A neighbour's frame is carried to
/// `frame` by the smallest rotation of its normal; the blended field is sampled on the bake's path down to the
/// smaller of `depth` and the neighbours' mean, and fitted as a pair of its own. Grasps and turns are blended. Throws
/// as fit_pair.
struct CoverSource {
  const ContactFrame* frame = nullptr;
  const SiteCurves* site = nullptr;
  double weight = 0.0;
};
SiteCurves blend_site(const ContactFrame& frame, double depth, const std::vector<CoverSource>& sources,
                      const ModelScales& scales, const std::string& what);

/// Fills every empty entry of `sites` (one a site, all of the same tool vertex), round by round outwards from the
/// sites that have curves, weights inverse to the edge length; a site that no edge connects to any of them takes
/// the nearest. `frames` and `depths` (m) are those of the sites. Throws Error(numerical) when no site has curves.
void cover_sites(const SiteGraph& graph, const std::vector<ContactFrame>& frames, const std::vector<double>& depths,
                 const ModelScales& scales, std::vector<std::optional<SiteCurves>>& sites, const std::string& what);

}  // namespace palpate::fit
