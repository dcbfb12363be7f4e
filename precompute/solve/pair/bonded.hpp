// SPDX-License-Identifier: GPL-3.0-or-later
// A bonded contact and its moves, each accepted only when it passes the gates.
#pragma once

#include "precompute/solve/pair/pair_run.hpp"

#include <optional>
#include <string>

namespace palpate::solve {

class Bonded {
public:
  /// The bonded tool at rest.
  struct Stand {
    PushState state;
    Sample sample;                    ///< of kind grasped
    Eigen::Vector3d force{0, 0, 0};   ///< N, body frame
    Eigen::Vector3d turned{0, 0, 0};  ///< rad since the bond, axis times angle, contact frame
    double work = 0.0, effort = 0.0;  ///< J since the bond: by the tool, and of all its moves without their signs
    double contact_energy = 0.0;      ///< J
  };

  /// Bonds the contact of a point of the normal indentation, where the push then stands. `furthest` (m): size of the
  /// moves.
  Bonded(PairRun& run, const CurvePoint& at, double furthest);

  [[nodiscard]] const Stand& start() const { return start_; }
  void restore(const Stand& stand);
  /// Moves the tool's translation (m, body frame) from where the push stands, which is `now`, and sets that. The cause
  /// where there is no believable equilibrium: then `now` is as before.
  std::optional<std::string> move(Stand& now, const Eigen::Vector3d& target);
  /// The same for a turn to `target` (rad since the bond, axis times angle, contact frame) about the point by which the
  /// tool touched, which rests. The sample's rotation is less what the bond itself gives since `from`, which is not
  /// turned.
  std::optional<std::string> turn(Stand& now, const Stand& from, const Eigen::Vector3d& target);

private:
  [[nodiscard]] double contact_energy() const;
  [[nodiscard]] double stored() const { return run_.push.elastic_energy() + contact_energy(); }
  [[nodiscard]] Stand stand(const StepResult& step) const;
  [[nodiscard]] Eigen::Matrix3d rotation(const Eigen::Vector3d& turned) const;
  std::optional<std::string> take(Stand& now, Stand&& next, double work, double answer) const;
  void add_error(Stand& s, double way, double give, const StepResult& step) const;

  PairRun& run_;
  const CurvePoint& at_;
  const double radius_;   // m
  const double scale_;    // J
  Eigen::Matrix3d rest_;  // the tool's rotation as it was bonded
  double stored_ = 0.0;   // J, in body and contact, as it was bonded
  Stand start_;
};

}  // namespace palpate::solve
