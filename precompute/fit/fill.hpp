// SPDX-License-Identifier: GPL-3.0-or-later
// Fills sites without a response of their own (refused, on a support, outside the region) from their neighbours.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "precompute/fit/laws/grasp_fit.hpp"
#include "precompute/fit/laws/pair_fit.hpp"
#include "precompute/fit/laws/turn_fit.hpp"

namespace palpate::fit {

/// The response of a site for one tool vertex.
struct SiteResponse {
  PairResponse response;
  double depth = 0.0;                ///< m, how deep it was sampled
  std::optional<GraspCurves> grasp;  ///< of a tool that bonds
  std::optional<TurnCurves> turn;    ///< of a bonded tool that was rotated
};

/// Per site the sites it shares an edge with, ascending.
using SiteGraph = std::vector<std::vector<std::uint32_t>>;

SiteGraph site_graph(std::size_t sites, const std::vector<std::array<std::int32_t, 3>>& triangles);

struct FillSource {
  const ContactFrame* frame = nullptr;
  const SiteResponse* site = nullptr;
  double weight = 0.0;
};
/// The weighted mean of responses in `frame` (weights need not sum to 1). A neighbour's frame is carried to `frame` by
/// the smallest rotation of its normal. The depth is the smaller of `depth` (m) and the neighbours' mean.
SiteResponse blend_sites(const ContactFrame& frame, double depth, const std::vector<FillSource>& sources,
                         const ResponseScales& scales);

/// Fills every empty entry of `sites` (one a site, all of the same tool vertex), round by round outwards from the sites
/// that have a response, with weights inverse to the edge length. A site that no edge connects to any of them takes the
/// nearest. `frames` and `depths` (m) are those of the sites. Throws Error(numerical) naming `what` when no site has a
/// response.
void fill_from_neighbours(const SiteGraph& graph, const std::vector<ContactFrame>& frames,
                          const std::vector<double>& depths, const ResponseScales& scales,
                          std::vector<std::optional<SiteResponse>>& sites, const std::string& what);

}  // namespace palpate::fit
