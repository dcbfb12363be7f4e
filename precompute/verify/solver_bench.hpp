// SPDX-License-Identifier: GPL-3.0-or-later
// Cost and error of a curve set, over the mesh sizes that a scene allows.
#pragma once

#include "precompute/solve/pair/pair.hpp"
#include "precompute/solve/pair/sample_difference.hpp"

#include <string>
#include <vector>

namespace palpate::verify {

/// One contact to be solved at every mesh size.
struct BenchContact {
  ContactFrame frame;
  double depth = 0.0;  ///< m
};

struct MeshSetting {
  double mesh_size = 0.35, growth = 0.65;  ///< see SolverScene
  double max_size = 0.0;                   ///< longest edge over the body's diagonal; 0: as the scene says
};

struct SolverBenchRow {
  MeshSetting setting;
  std::size_t solved = 0, refused = 0;  ///< contacts
  double nodes = 0.0;                   ///< mean
  double seconds = 0.0;                 ///< mean of a solved contact, meshing included, on the calling thread
  double megabytes = 0.0;               ///< peak of the whole process up to here, program and libraries included
  solve::SampleDifference difference;   ///< to the reference: median over the contacts, member by member
};

struct SolverBenchOptions {
  std::vector<MeshSetting> settings{{0.45, 0.9, 0.4},  {0.3, 0.85, 0.4},   {0.35, 0.7, 0.25}, {0.25, 0.7, 0.25},
                                    {0.35, 0.65, 0.0}, {0.25, 0.5, 0.125}, {0.18, 0.4, 0.125}};
  int repeats = 3;  ///< of each contact; the time is their median
  MeshSetting reference{0.12, 0.3, 0.125};
};

/// Solves every contact by the bake's own entry point and path, on one thread; the reference last, so that the peaks of
/// memory before it are those of the settings, which ascend.
std::vector<SolverBenchRow> bench_solver(const Scene& scene, const Body& body, const tool::Tool& tool,
                                         const std::vector<BenchContact>& contacts, const SolverBenchOptions& options);

}  // namespace palpate::verify
