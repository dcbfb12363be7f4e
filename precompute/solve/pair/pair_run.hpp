// SPDX-License-Identifier: GPL-3.0-or-later
// One pair on one mesh: what its pushes share, and the pushes in their order.
#pragma once

#include "precompute/solve/contact/gates.hpp"
#include "precompute/solve/pair/pair.hpp"
#include "precompute/solve/push/push.hpp"

#include <string>
#include <vector>

namespace palpate::solve {

/// An accepted point of the normal indentation.
struct CurvePoint {
  double depth = 0.0;  ///< m moved by the tool
  ContactReport contact;
  double force = 0.0;  ///< N along n
  PushState state;
  double energy_error = 0.0;  ///< J, see StepResult
};

/// Work of a tool on its way from the current state of a push (trapezium rule over its moves), and the energy stored
/// since.
class WayEnergy {
public:
  explicit WayEnergy(const Push& push);
  /// After a move of the push.
  void moved();
  [[nodiscard]] double work() const { return work_; }                ///< J
  [[nodiscard]] double stored() const { return energy() - start_; }  ///< J

private:
  [[nodiscard]] double energy() const;

  const Push& push_;
  double start_, work_ = 0.0;
  Eigen::Vector3d at_, force_;
};

struct PairRun : ContactCase {
  const PairPath& path;
  const PairOptions& options;
  const mesh::TetMesh& mesh;
  Push& push;
  PairResult& result;
  Eigen::Vector3d start{0, 0, 0};   ///< m, the tool's translation at first touch
  std::vector<CurvePoint> curve{};  ///< of the normal indentation; its samples are the first of the result

  bool contact_failed = false;  ///< refused for what another contact method may mend

  /// Ends the pair with a cause and without samples; false, for the caller to return.
  bool refuse(const std::string& cause);
  /// The same for what another contact method may mend.
  bool refuse_contact(const std::string& cause) { return contact_failed = true, refuse(cause); }
  /// The end of a tangential push at less than its reach; the samples before it are kept. A push with `nothing_yet` is
  /// refused as by refuse_contact(), unless the contact `peels`, which no finer mesh mends.
  bool stop_short(const std::string& cause, bool nothing_yet, bool peels);
  [[nodiscard]] double radius(double depth) const { return tool::contact_radius(vertex, depth); }  ///< m
  [[nodiscard]] double work_scale(double depth) const;                                       ///< J
  /// Push::move_to as the options' contact method does it, of a push to `depth` (m).
  StepResult move_to(const Eigen::Vector3d& target, double depth, bool sticking,
                     const std::vector<Eigen::VectorXd>& starts = {}) const;
  /// The sample of the push's current state, without the friction of separate terms and without an error estimate.
  [[nodiscard]] Sample sample(std::uint32_t iterations) const;
  /// The state for the gates of a contact that stuck while it moved tangentially at that depth (m), by `way` from the
  /// normal indentation.
  [[nodiscard]] GateState tangential_gate(double depth, const Sample& sample, const WayEnergy& way) const;
  /// The first accepted point from `depth` on: the contact of a shallower one may have been too small to resolve.
  [[nodiscard]] const CurvePoint& point_from(double depth) const;
  [[nodiscard]] const Sample& sample_of(const CurvePoint& point) const {
    return result.samples[std::size_t(&point - curve.data())];
  }
  /// Unit, in the contact's frame: tangential direction `k` of `count` evenly spaced ones.
  [[nodiscard]] Eigen::Vector3d direction(int k, int count) const;
};

// Each false where it refused the pair.

/// Prestress, then the tool comes to where it first touches.
bool approach(PairRun& run);
/// The curve of the normal indentation. False: its samples end at the last depth that passed, or are none where these
/// are fewer than GateLimits::curve_points.
bool normal_indentation(PairRun& run);
/// Tangential pushes of a contact that sticks.
bool sticking_pushes(PairRun& run);
/// Pulls, pushes and turns of a contact that is bonded.
bool grasped_pulls(PairRun& run);
/// Tangential pushes of a contact that slips by Coulomb's law. They refuse nothing: on failure the limits are
/// predicted.
void slipping_pushes(PairRun& run);
/// Ways deeper and less deep under side load; they refuse nothing either.
void side_paths(PairRun& run);

}  // namespace palpate::solve
