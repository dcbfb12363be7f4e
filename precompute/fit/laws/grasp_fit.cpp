// SPDX-License-Identifier: GPL-3.0-or-later
// Linear least squares with weak priors: one smooth curve where data are scarce, straight on beyond them.
#include "precompute/fit/laws/grasp_fit.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "formats/io/error.hpp"
#include "palpate/response/bonded_law.hpp"
#include "precompute/algebra/spectrum.hpp"
#include "precompute/fit/least_squares/least_squares.hpp"
#include "precompute/fit/least_squares/spline_rows.hpp"

namespace palpate::fit {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kFloor = 0.02;  // of the peak force, below which errors count absolutely
constexpr double kPrior = 1e-2;  // weight of smoothness against relative errors
constexpr double kAside = 0.01;  // of Z: normal pulls have a smaller tangential deflection
constexpr double kLeast = 1e-3;  // smaller over larger stiffness
constexpr double kLowest = -10;  // peaks: least coefficient of Fn

runtime::BondedLaw make_law(const GraspCurves& grasp, double scale) {
  runtime::BondedLaw law;
  law.clear(kGraspCoefs, scale);
  law.add(grasp.curves.data(), 1);
  return law;
}

std::vector<const Sample*> unturned(const std::vector<Sample>& samples) {
  std::vector<const Sample*> result;
  for (const Sample& s : samples) {
    if (s.kind == SampleKind::grasped && s.rotation.isZero(0)) result.push_back(&s);
  }
  return result;
}

double peak_force(const std::vector<const Sample*>& samples) {
  double peak = 0;
  for (const Sample* s : samples) peak = std::max(peak, s->force.norm());
  return peak;
}

// Fx, Fy, kxx, kxy, kyy together: every sample has two equations, linear in all of them. Stiffnesses are level at
// their ends, so that the law goes on beyond them: their unknowns are two fewer.
void fit_tangential(const std::vector<const Sample*>& samples, double scale, double peak, const std::string& what,
                    VectorXd& curves) {
  const MatrixXd level = level_ends(kGraspCoefs), bends = kPrior * smooth_rows(kGraspCoefs);
  const auto count = static_cast<Eigen::Index>(samples.size());
  MatrixXd all = MatrixXd::Zero(2 * count + 5 * bends.rows(), 5 * kGraspCoefs);
  VectorXd target = VectorXd::Zero(all.rows());
  for (Eigen::Index i = 0; i < count; ++i) {
    const Sample& s = *samples[static_cast<std::size_t>(i)];
    const double weight = peak / std::max(s.force.norm(), kFloor * peak);
    const Eigen::RowVectorXd value = weight * value_row(kGraspCoefs, grasp_abscissa(s.deflection.z(), scale));
    const double x = s.deflection.x() / scale, y = s.deflection.y() / scale;  // stiffnesses in peak / Z
    all.row(2 * i).segment(0, kGraspCoefs) = value;
    all.row(2 * i).segment(2 * kGraspCoefs, kGraspCoefs) = -x * value;
    all.row(2 * i).segment(3 * kGraspCoefs, kGraspCoefs) = -y * value;
    all.row(2 * i + 1).segment(kGraspCoefs, kGraspCoefs) = value;
    all.row(2 * i + 1).segment(3 * kGraspCoefs, kGraspCoefs) = -x * value;
    all.row(2 * i + 1).segment(4 * kGraspCoefs, kGraspCoefs) = -y * value;
    target[2 * i] = weight * s.force.x() / peak;
    target[2 * i + 1] = weight * s.force.y() / peak;
  }
  for (int k = 0; k < 5; ++k)
    all.block(2 * count + k * bends.rows(), k * kGraspCoefs, bends.rows(), kGraspCoefs) = bends;
  MatrixXd rows(all.rows(), 2 * kGraspCoefs + 3 * (kGraspCoefs - 2));
  rows.leftCols(2 * kGraspCoefs) = all.leftCols(2 * kGraspCoefs);
  for (int k = 0; k < 3; ++k)
    rows.middleCols(2 * kGraspCoefs + k * (kGraspCoefs - 2), kGraspCoefs - 2) =
        all.middleCols((2 + k) * kGraspCoefs, kGraspCoefs) * level;
  const VectorXd solved = solve_linear(rows, target, what + ", grasp tangential curves");
  curves.segment(0, 2 * kGraspCoefs) = peak * solved.segment(0, 2 * kGraspCoefs);
  VectorXd stiffness(3 * kGraspCoefs);
  for (int k = 0; k < 3; ++k) {
    stiffness.segment(k * kGraspCoefs, kGraspCoefs) =
        peak / scale * (level * solved.segment(2 * kGraspCoefs + k * (kGraspCoefs - 2), kGraspCoefs - 2));
  }
  for (int i = 0; i < kGraspCoefs; ++i) {
    Eigen::Matrix2d k;
    k << stiffness[i], stiffness[kGraspCoefs + i], stiffness[kGraspCoefs + i], stiffness[2 * kGraspCoefs + i];
    const auto eigen = algebra::spectrum(k);
    const Eigen::Vector2d values = eigen.values.cwiseMax(kLeast * std::max(eigen.values[1], 0.0));
    k = eigen.vectors * values.asDiagonal() * eigen.vectors.transpose();
    curves[3 * kGraspCoefs + i] = k(0, 0);
    curves[4 * kGraspCoefs + i] = k(0, 1);
    curves[5 * kGraspCoefs + i] = k(1, 1);
  }
}

// Fn, from what tangential deflections do not add along the normal. Unknown are how far its first coefficient is above
// kLowest, and the increments to the others.
void fit_normal(const std::vector<const Sample*>& samples, double scale, double peak, const std::string& what,
                GraspCurves& grasp) {
  MatrixXd coefs = MatrixXd::Zero(kGraspCoefs, kGraspCoefs);
  for (int i = 0; i < kGraspCoefs; ++i) coefs.row(i).head(i + 1).setOnes();
  grasp.curves.segment(2 * kGraspCoefs, kGraspCoefs).setZero();
  const runtime::BondedLaw tangential = make_law(grasp, scale);
  const MatrixXd bends = kPrior * smooth_rows(kGraspCoefs);
  const auto count = static_cast<Eigen::Index>(samples.size());
  MatrixXd rows(count + bends.rows(), kGraspCoefs);
  VectorXd target = VectorXd::Zero(rows.rows());
  for (Eigen::Index i = 0; i < count; ++i) {
    const Sample& s = *samples[static_cast<std::size_t>(i)];
    const double weight = peak / std::max(s.force.norm(), kFloor * peak);
    const double coupling = tangential.force({s.deflection.x(), s.deflection.y(), s.deflection.z()}).z;
    rows.row(i) = weight * value_row(kGraspCoefs, grasp_abscissa(s.deflection.z(), scale));
    target[i] = weight * ((s.force.z() - coupling) / peak - kLowest);
  }
  rows.bottomRows(bends.rows()) = bends;
  const VectorXd rise = coefs * solve_nonnegative(rows * coefs, target, what + ", grasp normal curve");
  grasp.curves.segment(2 * kGraspCoefs, kGraspCoefs) = peak * (rise.array() + kLowest).matrix();
}

}  // namespace

GraspCurves fit_grasp(const std::vector<Sample>& samples, double depth_scale, const std::string& what) {
  const std::vector<const Sample*> taken = unturned(samples);
  GraspCurves grasp;
  long normal = 0;
  for (const Sample* s : taken) {
    if (!s->force.allFinite() || !s->deflection.allFinite()) {
      throw Error(ExitCode::numerical, what + ": grasped sample " + std::to_string(s->index) + " is not finite");
    }
    grasp.pulled = std::max(grasp.pulled, -s->deflection.z());
    normal += s->deflection.head<2>().norm() < kAside * depth_scale ? 1 : 0;
  }
  if (normal < 3) {
    throw Error(ExitCode::numerical,
                what + ": a grasp needs normal pulls at three depths; there are " + std::to_string(normal));
  }
  const double peak = peak_force(taken);
  if (!(peak > 0)) throw Error(ExitCode::numerical, what + ": a grasp without any force");
  grasp.depth = taken.front()->deflection.z();
  grasp.pulled = std::min(grasp.pulled, depth_scale);
  grasp.curves = VectorXd::Zero(static_cast<Eigen::Index>(layout::kBondedCurves) * kGraspCoefs);
  fit_tangential(taken, depth_scale, peak, what, grasp.curves);
  fit_normal(taken, depth_scale, peak, what, grasp);
  return grasp;
}

GraspCurves blend_grasps(const std::vector<GraspShare>& shares, double depth_scale) {
  GraspCurves blend;
  runtime::BondedLaw law;
  law.clear(kGraspCoefs, depth_scale);
  for (const GraspShare& s : shares) {
    blend.depth += s.share * s.grasp->depth;
    blend.pulled += s.share * s.grasp->pulled;
    law.add(s.grasp->curves.data(), s.share, {s.turned.x(), s.turned.y()});
  }
  blend.curves = Eigen::Map<const VectorXd>(law.coefs(), static_cast<Eigen::Index>(layout::kBondedCurves) * kGraspCoefs);
  return blend;
}

Eigen::Vector3d evaluate(const GraspCurves& grasp, double depth_scale, const Eigen::Vector3d& deflection) {
  const runtime::Vec3 f = make_law(grasp, depth_scale).force({deflection.x(), deflection.y(), deflection.z()});
  return {f.x, f.y, f.z};
}

std::vector<double> grasp_errors(const GraspCurves& grasp, double depth_scale, const std::vector<Sample>& samples) {
  const std::vector<const Sample*> taken = unturned(samples);
  const double peak = peak_force(taken);
  std::vector<double> errors;
  for (const Sample* s : taken) {
    errors.push_back((evaluate(grasp, depth_scale, s->deflection) - s->force).norm() /
                     std::max(s->force.norm(), kFloor * peak));
  }
  return errors;
}

}  // namespace palpate::fit
