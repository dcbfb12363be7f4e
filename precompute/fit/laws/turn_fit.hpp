// SPDX-License-Identifier: GPL-3.0-or-later
// The curves of a grasped contact that is turned: torque, its stiffness, and how turns and moves act on each other.
#pragma once

#include "precompute/fit/laws/grasp_fit.hpp"

namespace palpate::fit {

/// Curves that turns of a bonded contact add to its GraspCurves; see palpate/response/bonded_law.hpp.
struct TurnCurves {
  Eigen::VectorXd curves;  ///< T, K (N m), C (N): layout::kTorqueCurves of kGraspCoefs each, contact frame
  double turned = 0.0;     ///< rad, largest angle of the samples
};

/// Fits the grasped samples, torques of moved tools and forces of turned ones together, around what fit_grasp found in
/// them. With the stiffness of moves the curves meet bonded::broken_torque. Throws Error(numerical) naming `what` where
/// samples are not finite, have no torque, or have no turns about three axes.
TurnCurves fit_turns(const std::vector<Sample>& samples, const GraspCurves& grasp, double depth_scale,
                     const std::string& what);

/// A share of another site's turns.
struct TurnShare {
  const TurnCurves* turn = nullptr;
  double share = 0.0;                ///< all of them sum to 1
  Eigen::Vector2d turned{1.0, 0.0};  ///< cosine and sine of its x axis here
};
TurnCurves blend_turns(const std::vector<TurnShare>& shares, double depth_scale);

/// Torque (x, y, n; N m) at a deflection (x, y, depth; m) and a rotation vector (x, y, n; rad).
Eigen::Vector3d evaluate_torque(const GraspCurves& grasp, const TurnCurves& turn, double depth_scale,
                                const Eigen::Vector3d& deflection, const Eigen::Vector3d& rotation);

/// |model - sample| / max(|sample|, 2 % of the largest) of the torques of turned samples.
std::vector<double> turn_errors(const GraspCurves& grasp, const TurnCurves& turn, double depth_scale,
                                const std::vector<Sample>& samples);

}  // namespace palpate::fit
