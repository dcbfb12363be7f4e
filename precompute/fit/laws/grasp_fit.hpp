// SPDX-License-Identifier: GPL-3.0-or-later
// The curves of a grasped contact: force and tangential stiffness over depths of either sign.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "formats/journal/samples.hpp"

namespace palpate::fit {

inline constexpr int kGraspCoefs = 8;

/// Response of a bonded contact; see palpate/response/bonded_law.hpp.
struct GraspCurves {
  Eigen::VectorXd curves;  ///< Fx, Fy, Fn (N), kxx, kxy, kyy (N/m) of kGraspCoefs each, contact frame
  double depth = 0.0;      ///< m, at which the contact was bonded
  double pulled = 0.0;     ///< m, how far out of the body it was solved, >= 0
};

/// Fits the grasped samples whose tool is not turned. Fn does not decrease; the smaller stiffness is at least a
/// thousandth of the larger. Throws Error(numerical) naming `what` where samples are not finite, have no force, or lie
/// at fewer than three depths.
GraspCurves fit_grasp(const std::vector<Sample>& samples, double depth_scale, const std::string& what);

/// A share of another site's grasp.
struct GraspShare {
  const GraspCurves* grasp = nullptr;
  double share = 0.0;                ///< all of them sum to 1
  Eigen::Vector2d turned{1.0, 0.0};  ///< cosine and sine of its x axis here
};
GraspCurves blend_grasps(const std::vector<GraspShare>& shares, double depth_scale);

/// Force (x, y, n) at a deflection (x, y tangential, depth; m).
Eigen::Vector3d evaluate(const GraspCurves& grasp, double depth_scale, const Eigen::Vector3d& deflection);

/// |model - sample| / max(|sample|, 2 % of the largest) of the samples that fit_grasp takes.
std::vector<double> grasp_errors(const GraspCurves& grasp, double depth_scale, const std::vector<Sample>& samples);

}  // namespace palpate::fit
