// SPDX-License-Identifier: MIT
// Records of the bake: planned pairs, solved samples, outcomes. Stored by the journal (journal.hpp).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// Local frame of a contact: origin on the undeformed body, n outward unit normal, x and y unit tangents,
/// right-handed (x cross y = n).
struct ContactFrame {
  Eigen::Vector3d origin{0, 0, 0};
  Eigen::Vector3d x{1, 0, 0}, y{0, 1, 0}, n{0, 0, 1};

  /// Components (x, y, n) of a world vector.
  [[nodiscard]] Eigen::Vector3d to_local(const Eigen::Vector3d& v) const { return {x.dot(v), y.dot(v), n.dot(v)}; }
  [[nodiscard]] Eigen::Vector3d to_world(const Eigen::Vector3d& v) const { return v.x() * x + v.y() * y + v.z() * n; }
};

/// The solves of a pair. full: all paths of the scene. normal: a normal indentation at few depths, by which full
/// responses are carried to a site. hidden: a normal indentation between sites that no response is made of; it tests
/// what the responses around it predict.
enum class PairRole : std::uint8_t { full, normal, hidden };

/// One pair (body vertex c, tool vertex p) to be solved.
struct PairPlan {
  std::uint32_t site = 0;         ///< vertex of the haptic mesh; hidden: the number of the place
  std::uint32_t tool = 0;         ///< index of the tool in the scene
  std::uint32_t tool_vertex = 0;  ///< vertex of that tool's patches
  ContactFrame frame;             ///< at c; the tool's normal at p is -n, its tangent at p lies along x
  double depth = 0.0;             ///< m; deepest push at this site
  PairRole role = PairRole::full;
};

/// normal: normal indentation; tangential: tangential push of a contact that sticks; slipping: of one that slips where
/// Coulomb's law lets it; path: a contact that sticks goes deeper or less deep while held at a tangential deflection (a
/// test, no fit reads it); grasped: any move of a contact that was bonded.
enum class SampleKind : std::uint8_t { normal = 0, tangential = 1, slipping = 2, path = 3, grasped = 4 };

/// One equilibrium that passed its gates.
struct Sample {
  SampleKind kind = SampleKind::normal;
  std::uint16_t index = 0;  ///< position in the pair's deflection path
  /// p - c in the contact frame: (x, y) tangential (m) and, third, the depth along the INWARD normal (m; grasped: of
  /// either sign, else >= 0).
  Eigen::Vector3d deflection{0, 0, 0};
  Eigen::Vector3d force{0, 0, 0};    ///< N on the tool, components (x, y, n); a push answers with n > 0
  double friction_limit = 0.0;       ///< mu(depth): gross-slip tangential force over force.z; of normal samples
                                     ///< predicted, of slipping ones solved (0 while a part still sticks)
  double contact_area = 0.0;         ///< m^2, undeformed area of the surface in contact
  double penetration = 0.0;          ///< m, largest overlap of tool and tissue that the penalty left
  double min_jacobian = 1.0;         ///< smallest det F over the quadrature points
  double error_estimate = 0.0;       ///< relative, of the force: iterate, penalty and mesh together
  std::uint32_t contact_points = 0;  ///< integration points in contact
  std::uint32_t iterations = 0;      ///< minimiser iterations
  double weight = 1.0;               ///< >= 0, beside other samples of its pair; only recorded ones have another, and
                                     ///< journals do not keep it
  // Only grasped samples keep these:
  Eigen::Vector3d rotation{0, 0, 0};  ///< rad, of the tool about p since the bond, axis times angle in (x, y, n)
  Eigen::Vector3d torque{0, 0, 0};    ///< N m on the tool about p, components (x, y, n)
};

/// How a pair ended.
struct PairOutcome {
  bool accepted = false;
  std::string cause;         ///< one line naming the gate and its figure: of a refusal, or of a tangential push that
                             ///< stopped short in an accepted pair
  double first_touch = 0.0;  ///< m; shift along -n at which the tool first touches the body's surface
  std::uint32_t nodes = 0;   ///< of the solved mesh
  std::uint32_t normal_solves = 0, tangential_solves = 0;
  std::uint32_t factorisations = 0;
};

/// A pair's normal indentation beside that on a finer mesh.
struct PairCheck {
  std::uint32_t nodes = 0;     ///< of the finer mesh
  std::uint32_t compared = 0;  ///< samples; 0: none could be
  std::uint32_t within_estimate = 0;  ///< of these: differ by no more than the error estimates of both
  double difference = 0.0;     ///< largest |F - F'| / |F'| over the deeper half
  std::string cause;           ///< one line: why nothing was compared
};

/// Everything a pair produced.
struct PairResult {
  PairOutcome outcome;
  std::vector<Sample> samples;
  std::optional<PairCheck> check;  ///< of pairs that were drawn for it
};

}  // namespace palpate
