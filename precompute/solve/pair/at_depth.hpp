// SPDX-License-Identifier: GPL-3.0-or-later
// The pose of a tool at a given depth in an undeformed body.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

namespace palpate::solve {

/// `translation` shifted along the unit `normal` to where the tool just touches, the smallest signed distance of tool
/// and surface, which `gap` gives (m), being 0 to `resolution` (m), and from there by `depth` (m) inwards. Nothing
/// where that takes a shift beyond `reach` (m): no surface is there.
std::optional<Eigen::Vector3d> at_depth(const std::function<double(const Eigen::Vector3d&)>& gap,
                                        Eigen::Vector3d translation, const Eigen::Vector3d& normal, double depth,
                                        double resolution, double reach);

}  // namespace palpate::solve
