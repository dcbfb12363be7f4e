// SPDX-License-Identifier: GPL-3.0-or-later
// Contacts for commands that solve a few of them: of a scene's plan, or on a plain block.
#pragma once

#include "precompute/pipeline/pipeline.hpp"
#include "precompute/verify/solver_bench.hpp"

#include <string>
#include <vector>

namespace palpate::cli {

struct ContactCase {
  std::string name;
  Scene scene;
  Body body;
  tool::Tool tool;  ///< the scene's first; the contacts are of its first vertex
  std::vector<verify::BenchContact> contacts;
};

/// Up to `count` contacts spread evenly over the scene's plan. Throws as the pipeline does, and Error(bad_input) where
/// the plan has none.
ContactCase scene_contacts(const std::string& scene, int count);

/// The same of a pipeline whose surface and haptic mesh are there.
ContactCase plan_contacts(const pipeline::Pipeline& pipeline, const std::string& scene, int count);

/// A sphere of `radius` (m) in the middle of a block of 2 half x 2 half x half (m), pressed to `depth` (m), which is
/// its sampling.depth.
ContactCase block_contact(double half, double radius, double depth, double friction);

/// The same on a slab of 2 half x 2 half x thickness (m) that is held at its four sides, for a pinch. Its
/// sampling.depth is 1.4 depths, for the tool on the other side lifts the surface towards this one. By one tool the
/// other wall moves unevenly within a thickness: the sites lie at most 0.35 of it apart, in the middle of the slab.
ContactCase slab_contact(double half, double thickness, double radius, double depth);

}  // namespace palpate::cli
