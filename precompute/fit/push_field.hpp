// SPDX-License-Identifier: GPL-3.0-or-later
// The normal indentations of one tool vertex over the sites, and predictions at sites without one.
#pragma once

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "precompute/bake/plan.hpp"
#include "precompute/fit/carry.hpp"
#include "precompute/fit/fill.hpp"

namespace palpate::fit {

/// Sites beside solved ones get a push by extrapolation: next to a support the force grows fast, and no tool can be
/// solved there. Sites farther away are blends of their neighbours, as in fill_from_neighbours.
class PushField {
public:
  /// `curves` by site. `sites` and `graph` must outlive the field.
  PushField(const std::vector<bake::PlanSite>& sites, const SiteGraph& graph,
            const std::map<std::uint32_t, NormalCurve>& curves);

  [[nodiscard]] bool solved(std::uint32_t site) const { return solved_[site]; }
  /// False where no edges lead to a site with a push.
  [[nodiscard]] bool known(std::uint32_t site) const { return !blends_[site].empty(); }
  /// N at a known site and a depth (m), components (x, y, n) in `frame`: tangential forces are turned with the normal.
  [[nodiscard]] Eigen::Vector3d force(std::uint32_t site, double depth, const ContactFrame& frame) const;
  /// Gradient (1/m) over the surface of the logarithm of the force at a depth (m), at a solved site: by least squares
  /// over its edges to solved sites.
  [[nodiscard]] Eigen::Vector3d slope(std::uint32_t site, double depth) const;
  /// The extrapolated pushes, by site.
  [[nodiscard]] const std::map<std::uint32_t, NormalCurve>& extrapolated() const { return extrapolated_; }

private:
  [[nodiscard]] NormalCurve extrapolate(std::uint32_t site) const;
  void blend_others();

  const std::vector<bake::PlanSite>& sites_;
  const SiteGraph& graph_;
  std::vector<std::optional<NormalCurve>> curves_;
  std::vector<char> solved_;
  std::map<std::uint32_t, NormalCurve> extrapolated_;
  std::vector<std::vector<std::pair<std::uint32_t, double>>> blends_;  // sites with a push, and their weights
};

}  // namespace palpate::fit
