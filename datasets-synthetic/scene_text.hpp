// SPDX-License-Identifier: GPL-3.0-or-later
// The scene.toml of a synthetic data set.
#pragma once

#include "datasets-synthetic/dataset.hpp"

#include <Eigen/Core>
#include <utility>
#include <vector>

namespace palpate::synth {

/// A region that the scene describes by its measures. Lengths in m.
struct EllipsoidFacts {
  std::string name;
  Eigen::Vector3d centre{0, 0, 0}, radii{0, 0, 0};
  std::string tissue;  ///< empty: young
  double young = 0.0;  ///< Pa
};

/// The points p with (p - point) . normal <= 0; m.
struct HalfSpace {
  Eigen::Vector3d point{0, 0, 0}, normal{0, 0, 1};
};

/// Properties of a synthetic organ that its scene needs. Lengths in m.
struct SceneFacts {
  std::string organ_file;
  std::string inclusion_file;  ///< empty: none
  std::string tool_file;       ///< empty: an analytic shape
  std::vector<EllipsoidFacts> regions;
  std::string tissue;       ///< of the organ; empty: young
  double young = 5e3;       ///< Pa
  double pressure = 0.0;    ///< Pa, in its cavities
  std::vector<HalfSpace> held;  ///< the surface is held in each
  double spacing = 0.015;
  bool uniform = false;  ///< as coarse at margins as elsewhere
  std::optional<std::pair<Eigen::Vector3d, Eigen::Vector3d>> sampled_box;
};

std::string scene_text(const DatasetOptions& options, const SceneFacts& facts);

}  // namespace palpate::synth
