// SPDX-License-Identifier: GPL-3.0-or-later
// The full response of a site that had a normal indentation alone, carried from sites where all was solved.
#pragma once

#include <utility>
#include <vector>

#include "precompute/fit/fill.hpp"
#include "precompute/solve/pair/pair.hpp"

namespace palpate::fit {

/// Force of a normal indentation on a tool over depth, between the solved depths: each component divided by the depth
/// is linear in the root of the depth. Both are nearly so for a contact that grows.
class NormalCurve {
public:
  /// Throws Error(numerical) where fewer than two normal samples have a depth and a force above 0.
  explicit NormalCurve(const std::vector<Sample>& samples);

  /// N, components (x, y, n), at a depth > 0 (m); beyond the deepest sample along the last segment.
  [[nodiscard]] Eigen::Vector3d force(double depth) const;
  [[nodiscard]] double deepest() const { return points_.back().first; }  ///< m

private:
  std::vector<std::pair<double, Eigen::Vector3d>> points_;  // depth (m), force (N), ascending
};

/// A site that was solved in full and, by the same normal indentation as the other.
struct CarrySource {
  const ContactFrame* frame = nullptr;
  const SiteResponse* full = nullptr;
  const NormalCurve* normal = nullptr;
  double weight = 0.0;  ///< relative to the others
};

/// Samples of `path` at a site with its normal indentation. The part that each source's response adds to its normal
/// indentation is stretched from its depth to the site's and multiplied by the ratio of the normal forces of the normal
/// indentations at the same share of the depth; the mean of these is added to the normal indentation of the site.
///
///     F(e, z) = own(z) + sum_i w_i g_i(z) [ F_i(l_i e, l_i z) - F_i(0, l_i z) ],
///     l_i = depth_i / depth,  g_i(z) = own_n(z) / normal_i,n(l_i z)
///
/// The similarity is exact for a power law of the depth. `depth`: m, of the site.
std::vector<Sample> carried_samples(const ContactFrame& frame, double depth, const NormalCurve& own,
                                    const solve::PairPath& path, const std::vector<CarrySource>& sources,
                                    const ResponseScales& scales);

/// The nearest sources by position among those whose normal is within 78 degrees of the site's, at most six, weighted
/// by the inverse square of the distance; the nearest of all where no normal is. `skip`: one to leave out.
std::vector<CarrySource> near_sources(const ContactFrame& frame, const std::vector<CarrySource>& all,
                                      const CarrySource* skip = nullptr);

}  // namespace palpate::fit
