// SPDX-License-Identifier: GPL-3.0-or-later
// A model against paths that go deeper or less deep under side load: the state rule replayed along the samples.
#pragma once

#include <functional>

#include "precompute/fit/laws/pair_samples.hpp"

namespace palpate::fit {

/// Force (x, y, n) at an effective tangential deflection (m) and depth (m).
using ForceAt = std::function<Eigen::Vector3d(const Eigen::Vector2d& tangential, double depth)>;
/// Effective tangential deflection (m) after going deeper from one depth to another without moving tangentially.
using DeepenRule = std::function<Eigen::Vector2d(double from, double to, const Eigen::Vector2d& tangential)>;

/// |force - solved| by `data`'s weight at every path sample, in their order. Between samples the tool goes straight.
std::vector<double> path_errors(const std::vector<Sample>& samples, const PairSamples& data, const ForceAt& force,
                                const DeepenRule& deepen);

}  // namespace palpate::fit
