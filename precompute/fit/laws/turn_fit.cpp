// SPDX-License-Identifier: GPL-3.0-or-later
// One linear least-squares problem of torques and of what a turn adds to the force, then what keeps the energy bounded.
#include "precompute/fit/laws/turn_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "formats/io/error.hpp"
#include "palpate/response/bonded_law.hpp"
#include "precompute/algebra/spectrum.hpp"
#include "precompute/fit/least_squares/least_squares.hpp"
#include "precompute/fit/least_squares/spline_rows.hpp"

namespace palpate::fit {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Coupling = Eigen::Matrix<double, 2, 3>;

constexpr int kCurves = static_cast<int>(layout::kTorqueCurves);
constexpr int kFree = 3;             // curves of T, which bend freely; the others are level at their ends
constexpr double kTurnFloor = 0.02;  // of the peak torque or force, below which errors count absolutely
constexpr double kTurnPrior = 1e-2;  // weight of smoothness against relative errors
constexpr double kLeastTurn = 1e-3;  // smallest over largest stiffness of turns
constexpr double kMostCoupling =
    0.98;  // of the coupling at which the stiffness of moves and turns is no longer positive
/// Curve of K's entries.
constexpr std::array<std::array<int, 3>, 3> kStiffness{{{3, 4, 6}, {4, 5, 7}, {6, 7, 8}}};

runtime::Vec3 triple(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

std::vector<const Sample*> grasped(const std::vector<Sample>& samples) {
  std::vector<const Sample*> result;
  for (const Sample& s : samples) {
    if (s.kind == SampleKind::grasped) result.push_back(&s);
  }
  return result;
}

struct Peaks {
  double torque = 0.0, force = 0.0, angle = 0.0;
};

Peaks peaks(const std::vector<const Sample*>& samples) {
  Peaks p;
  for (const Sample* s : samples) {
    p.torque = std::max(p.torque, s->torque.norm());
    p.force = std::max(p.force, s->force.norm());
    p.angle = std::max(p.angle, s->rotation.norm());
  }
  return p;
}

// J^T torque, J the left Jacobian of SO(3): minus the derivative of the energy by the rotation vector.
Vector3d by_rotation(const Sample& s) {
  const double a = s.rotation.norm();
  if (!(a > 0)) return s.torque;
  const Vector3d axis = s.rotation / a, once = axis.cross(s.torque);
  return s.torque - (1 - std::cos(a)) / a * once + (a - std::sin(a)) / a * axis.cross(once);
}

/// TurnRows of the problem: unknown are the curves' coefficients, those of T in torques, of K in torques a largest
/// angle, of C in torques a depth scale, all of the peak torque.
class TurnRows {
public:
  TurnRows(Eigen::Index most, double depth_scale, double angle)
      : matrix_(MatrixXd::Zero(most, kCurves * kGraspCoefs)),
        target_(VectorXd::Zero(most)),
        scale_(depth_scale),
        angle_(angle) {}

  /// Torque: T - C^T e - K theta.
  void torque(const Sample& s, double weight, const Vector3d& value) {
    const RowVectorXd at = weight * value_row(kGraspCoefs, grasp_abscissa(s.deflection.z(), scale_));
    for (int i = 0; i < 3; ++i) {
      put(i, at);
      for (int j = 0; j < 3; ++j) put(kStiffness[i][j], -s.rotation[j] / angle_ * at);
      for (int j = 0; j < 2; ++j) put(9 + 3 * j + i, -s.deflection[j] / scale_ * at);
      end(weight * value[i]);
    }
  }

  /// Rows of the force that the rotation adds, in peak torques over the depth scale: -C theta, and along the normal the
  /// derivative by the depth of -T theta + e C theta + theta K theta / 2.
  void force(const Sample& s, double weight, const Vector3d& value) {
    const double u = grasp_abscissa(s.deflection.z(), scale_);
    const RowVectorXd at = weight * value_row(kGraspCoefs, u);
    const RowVectorXd slope = weight * 0.5 / layout::kBondedRange * slope_row(kGraspCoefs, u);
    const Vector3d turn = s.rotation / angle_;
    for (int j = 0; j < 2; ++j) {
      for (int i = 0; i < 3; ++i) put(9 + 3 * j + i, -s.rotation[i] * at);
      end(weight * value[j]);
    }
    for (int i = 0; i < 3; ++i) {
      put(i, -s.rotation[i] * slope);
      for (int j = 0; j < 3; ++j) put(kStiffness[i][j], 0.5 * angle_ * turn[i] * turn[j] * slope);
      for (int j = 0; j < 2; ++j) put(9 + 3 * j + i, s.deflection[j] / scale_ * s.rotation[i] * slope);
    }
    end(weight * value.z());
  }

  /// One smooth curve where data are scarce.
  void priors() {
    const MatrixXd smooth = kTurnPrior * smooth_rows(kGraspCoefs);
    for (int curve = 0; curve < kCurves; ++curve) {
      for (Eigen::Index i = 0; i < smooth.rows(); ++i) {
        put(curve, smooth.row(i));
        end(0);
      }
    }
  }

  [[nodiscard]] VectorXd solve(const std::string& what) const {
    const MatrixXd level = level_ends(kGraspCoefs);
    const auto place = [](int curve) { return kFree * kGraspCoefs + (curve - kFree) * (kGraspCoefs - 2); };
    MatrixXd reduced(used_, place(kCurves));
    reduced.leftCols(kFree * kGraspCoefs) = matrix_.topRows(used_).leftCols(kFree * kGraspCoefs);
    for (int k = kFree; k < kCurves; ++k) {
      reduced.middleCols(place(k), kGraspCoefs - 2) =
          matrix_.topRows(used_).middleCols(k * kGraspCoefs, kGraspCoefs) * level;
    }
    const VectorXd solved = solve_linear(reduced, target_.head(used_), what);
    VectorXd curves(kCurves * kGraspCoefs);
    curves.head(kFree * kGraspCoefs) = solved.head(kFree * kGraspCoefs);
    for (int k = kFree; k < kCurves; ++k)
      curves.segment(k * kGraspCoefs, kGraspCoefs) = level * solved.segment(place(k), kGraspCoefs - 2);
    return curves;
  }

private:
  void put(int curve, const RowVectorXd& row) { matrix_.row(used_).segment(curve * kGraspCoefs, kGraspCoefs) += row; }
  void end(double target) { target_[used_++] = target; }

  MatrixXd matrix_;
  VectorXd target_;
  double scale_, angle_;
  Eigen::Index used_ = 0;
};

/// The turns have to span three axes: the torque about one that no turn has been about is not known.
bool about_three_axes(const std::vector<const Sample*>& samples, double angle) {
  Matrix3d sum = Matrix3d::Zero();
  for (const Sample* s : samples) sum += s->rotation * s->rotation.transpose();
  return algebra::spectrum(sum).values[0] > 0.01 * angle * angle;
}

Matrix2d inverse_root(const Matrix2d& k) {
  const auto eigen = algebra::spectrum(k);
  return eigen.vectors * eigen.values.cwiseSqrt().cwiseInverse().asDiagonal() * eigen.vectors.transpose();
}

/// Coefficient by coefficient: K's smallest over its largest eigenvalue at least kLeastTurn, and as much less of C as
/// makes the stiffness of moves and turns together positive definite.
void bound_energy(const GraspCurves& grasp, VectorXd& curves, const std::string& what) {
  for (int i = 0; i < kGraspCoefs; ++i) {
    const auto of = [&](int curve) -> double& { return curves[curve * kGraspCoefs + i]; };
    Matrix3d k;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) k(r, c) = of(kStiffness[r][c]);
    }
    const auto eigen = algebra::spectrum(k);
    const Vector3d values = eigen.values.cwiseMax(kLeastTurn * eigen.values[2]);
    Matrix2d move;
    move << grasp.curves[3 * kGraspCoefs + i], grasp.curves[4 * kGraspCoefs + i], grasp.curves[4 * kGraspCoefs + i],
        grasp.curves[5 * kGraspCoefs + i];
    if (!(values[0] > 0) || !(algebra::spectrum(move).values[0] > 0)) {
      throw Error(ExitCode::numerical, what + ": a grasp that does not resist moves or turns");
    }
    k = eigen.vectors * values.asDiagonal() * eigen.vectors.transpose();
    Coupling across;
    for (int j = 0; j < 6; ++j) across(j / 3, j % 3) = of(9 + j);
    const Matrix3d root = eigen.vectors * values.cwiseSqrt().cwiseInverse().asDiagonal() * eigen.vectors.transpose();
    const Coupling scaled = inverse_root(move) * across * root;
    const Matrix2d square = scaled * scaled.transpose();
    const double share = std::sqrt(algebra::spectrum(square).values[1]);
    across *= std::min(1.0, kMostCoupling / std::max(share, kMostCoupling));
    for (int r = 0; r < 3; ++r) {
      for (int c = r; c < 3; ++c) of(kStiffness[r][c]) = k(r, c);
    }
    for (int j = 0; j < 6; ++j) of(9 + j) = across(j / 3, j % 3);
  }
}

}  // namespace

TurnCurves fit_turns(const std::vector<Sample>& samples, const GraspCurves& grasp, double depth_scale,
                     const std::string& what) {
  const std::vector<const Sample*> taken = grasped(samples);
  for (const Sample* s : taken) {
    if (!s->force.allFinite() || !s->deflection.allFinite() || !s->torque.allFinite() || !s->rotation.allFinite()) {
      throw Error(ExitCode::numerical, what + ": grasped sample " + std::to_string(s->index) + " is not finite");
    }
  }
  const Peaks peak = peaks(taken);
  if (!(peak.torque > 0)) throw Error(ExitCode::numerical, what + ": turns without any torque");
  if (!about_three_axes(taken, peak.angle)) {
    throw Error(ExitCode::numerical, what + ": a grasp that is not turned about three axes has no torque to fit");
  }
  if (peak.angle > layout::kMaxRotation) {
    throw Error(ExitCode::numerical, what + ": turned by " + std::to_string(peak.angle) + " rad; at most 1 is stored");
  }
  const auto most = static_cast<Eigen::Index>(6 * taken.size()) + 2 * kCurves * kGraspCoefs;
  TurnRows rows(most, depth_scale, peak.angle);
  for (const Sample* s : taken) {
    rows.torque(*s, peak.torque / std::max(s->torque.norm(), kTurnFloor * peak.torque), by_rotation(*s) / peak.torque);
    if (s->rotation.isZero(0)) continue;
    const Vector3d added = s->force - evaluate(grasp, depth_scale, s->deflection);
    const double unit = peak.torque / depth_scale;
    rows.force(*s, unit / std::max(s->force.norm(), kTurnFloor * peak.force), added / unit);
  }
  rows.priors();
  TurnCurves turn;
  turn.curves = peak.torque * rows.solve(what + ", grasp turns");
  turn.curves.segment(3 * kGraspCoefs, 6 * kGraspCoefs) /= peak.angle;
  turn.curves.segment(9 * kGraspCoefs, 6 * kGraspCoefs) /= depth_scale;
  turn.turned = peak.angle;
  bound_energy(grasp, turn.curves, what);
  return turn;
}

TurnCurves blend_turns(const std::vector<TurnShare>& shares, double depth_scale) {
  TurnCurves blend;
  runtime::BondedTorqueLaw law;
  law.clear(kGraspCoefs, depth_scale);
  for (const TurnShare& s : shares) {
    blend.turned += s.share * s.turn->turned;
    law.add(s.turn->curves.data(), s.share, {s.turned.x(), s.turned.y()});
  }
  blend.curves = Eigen::Map<const VectorXd>(law.coefs(), kCurves * kGraspCoefs);
  return blend;
}

Vector3d evaluate_torque(const GraspCurves& grasp, const TurnCurves& turn, double depth_scale,
                         const Vector3d& deflection, const Vector3d& rotation) {
  runtime::BondedLaw moved;
  runtime::BondedTorqueLaw turned;
  moved.clear(kGraspCoefs, depth_scale);
  turned.clear(kGraspCoefs, depth_scale);
  moved.add(grasp.curves.data(), 1);
  turned.add(turn.curves.data(), 1);
  const runtime::Vec3 t = turned.wrench(moved, triple(deflection), triple(rotation)).torque;
  return {t.x, t.y, t.z};
}

std::vector<double> turn_errors(const GraspCurves& grasp, const TurnCurves& turn, double depth_scale,
                                const std::vector<Sample>& samples) {
  const std::vector<const Sample*> taken = grasped(samples);
  const double peak = peaks(taken).torque;
  std::vector<double> errors;
  for (const Sample* s : taken) {
    if (s->rotation.isZero(0)) continue;
    const Vector3d model = evaluate_torque(grasp, turn, depth_scale, s->deflection, s->rotation);
    errors.push_back((model - s->torque).norm() / std::max(s->torque.norm(), kTurnFloor * peak));
  }
  return errors;
}

}  // namespace palpate::fit
