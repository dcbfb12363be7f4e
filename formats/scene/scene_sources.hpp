// SPDX-License-Identifier: MIT
// Responses that are not solved: recorded with a real tool, or by a closed form of contact mechanics.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

/// [[measured]]: recordings of a real tool on the real body, see formats/recording/recording-file.md. They answer at
/// the sites nearest to them, before any law and any solve.
struct MeasuredScene {
  std::filesystem::path file;  ///< CSV, absolute, or relative to the working directory after reading
  std::string tool;            ///< of rows that name none; empty: the scene's only one
  double reach = 0.0;  ///< m, farthest that a recorded contact may lie from the surface; 0: sampling.spacing / 4
};

/// [[analytic]]: a closed form in place of solves, for a body that is flat beside the contact. It holds wherever all of
/// within_box, mesh and sites that are given do; the first one that holds at a site answers there.
struct AnalyticScene {
  enum class Law { hertz, punch, cone, layer, winkler, spring };
  Law law = Law::hertz;
  std::string tool;                 ///< empty: every tool
  std::optional<double> young;      ///< Pa, > 0; hertz, punch, cone, layer; none: the body's
  std::optional<double> poisson;    ///< hertz, punch, cone, [0, 0.5]; none: the body's
  double thickness = 0.0;           ///< m; layer; 0: of the wall at the site
  double stiffness = 0.0;           ///< > 0; winkler: N/m^3, spring: N/m
  double tangential_stiffness = 0.0;  ///< the same units, tangential; 0: as stiffness. Used only with friction
  std::optional<std::pair<Eigen::Vector3d, Eigen::Vector3d>> within_box;  ///< m; the sites in it
  std::string mesh;        ///< the sites on the part of the surface that came from this mesh
  std::vector<int> sites;  ///< these numbers of the haptic mesh, ascending
  int sites_line = 0;      ///< of the scene file
};

/// Sources of a scene's responses. Apart from Scene, because no mesh and no solve depends on it.
struct SceneSources {
  enum class Rest { solved, filled };
  Rest rest = Rest::solved;  ///< source of sites without recording and law: a solve, or the neighbours
  std::vector<MeasuredScene> measured;
  std::vector<AnalyticScene> analytic;
};

/// Reads [sources], [[measured]] and [[analytic]] of a scene file. Throws as read_scene.
SceneSources read_sources(const std::filesystem::path& scene_file);

/// Canonical text of all of them that changes a result, as that of a scene; empty where everything is solved. The
/// contents of recordings are to be hashed beside it.
std::string canonical_text(const SceneSources& sources);

}  // namespace palpate
