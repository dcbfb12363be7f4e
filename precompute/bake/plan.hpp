// SPDX-License-Identifier: GPL-3.0-or-later
// Which pairs are solved: every site that a tool can touch without its footprint reaching a support.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "formats/io/hash.hpp"
#include "formats/journal/samples.hpp"

namespace palpate {
struct Body;
struct Scene;
}  // namespace palpate

namespace palpate::sites {
struct HapticMesh;
}  // namespace palpate::sites

namespace palpate::tool {
struct Tool;
}  // namespace palpate::tool

namespace palpate::bake {

/// A vertex of the haptic mesh as the plan sees it.
struct PlanSite {
  ContactFrame frame;
  double depth = 0.0;    ///< m, deepest push here
  double area = 0.0;     ///< m^2, a third of the patches round it
  bool held = false;     ///< lies on a support
  bool selected = true;  ///< inside the region that is sampled
};

enum class SkipReason {
  support,      ///< the site is held, or the contact would reach what is held
  outside,      ///< not in the region that is sampled
  unreachable,  ///< in a fold narrower than the tool, which would meet its walls first
};

/// A pair that is not solved and is filled from neighbouring sites.
struct SkippedPair {
  std::uint32_t site = 0, tool = 0, tool_vertex = 0;
  SkipReason reason = SkipReason::support;
  friend bool operator==(const SkippedPair&, const SkippedPair&) = default;
};

/// Everything that a sample depends on.
struct PlanInputs {
  int solver = 0;  ///< kSolverRevision of the program
  Hash128 scene;   ///< canonical text of what solves depend on: a new fit needs no new solves
  Hash128 body;    ///< clean surfaces of body and inclusions
  Hash128 haptic_mesh;
  std::vector<Hash128> tools;  ///< shape and contact vertices
  friend bool operator==(const PlanInputs&, const PlanInputs&) = default;
};

struct Plan {
  std::vector<PlanSite> sites;
  std::vector<PairPlan> pairs;       ///< by site, then tool, then tool vertex; those of a round after those before it
  std::vector<SkippedPair> skipped;  ///< in the same order
  double unreachable_share = 0.0;    ///< of the area (mean over tool vertices) in folds narrower than the tool
  double support_share = 0.0;        ///< of the area (mean over tool vertices) that a support makes untouchable
  PlanInputs inputs;
};

/// Appends the pairs of the mesh's sites that the plan does not have yet, in one role, and what of them is skipped.
void add_sites(Plan& plan, const Body& body, const sites::HapticMesh& mesh, const std::vector<tool::Tool>& tools,
               PairRole role);

/// Plans every pair of the scene in one role. Throws Error(bad_input) when nothing is left to touch.
Plan make_plan(const Scene& scene, const Body& body, const sites::HapticMesh& mesh,
               const std::vector<tool::Tool>& tools, PairRole role = PairRole::full);

/// The part of a plan that the manifest stores.
struct Manifest {
  PlanInputs inputs;
  std::vector<PairPlan> pairs;
  std::vector<SkippedPair> skipped;
};

/// The manifest of a plan as JSON text; doubles are written so that they read back to the same bits.
std::string manifest_text(const Plan& plan);

/// Reads what manifest_text gave. Throws Error(bad_input) naming `source` and what is wrong.
Manifest parse_manifest(const std::string& text, const std::string& source);

/// Identity of a manifest, stored in journals.
Hash128 manifest_hash(const std::string& text);

}  // namespace palpate::bake
