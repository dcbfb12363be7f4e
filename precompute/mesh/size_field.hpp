// SPDX-License-Identifier: GPL-3.0-or-later
// Target edge length in space: fine where a tool touches, growing with the distance from there.
#pragma once

#include <Eigen/Core>
#include <functional>

namespace palpate::mesh {

/// Target edge length (m, > 0) at a point. Must be safe to call from several threads.
using SizeField = std::function<double(const Eigen::Vector3d&)>;

}  // namespace palpate::mesh
