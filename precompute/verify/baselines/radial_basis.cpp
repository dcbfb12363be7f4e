// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/verify/baselines/radial_basis.hpp"

#include <algorithm>
#include <cmath>

#include "precompute/fit/laws/pair_samples.hpp"
#include "precompute/fit/least_squares/least_squares.hpp"

namespace palpate::verify {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kBasisRidge =
    1e-6;  // of the weights over the peak: keeps close centres from playing against each other

Vector3d place(const Vector3d& deflection, const RadialBasis& network) {
  const double z = std::sqrt(std::clamp(deflection.z() / network.depth, 0.0, 1.0));
  if (!(network.tangential > 0)) return {0, 0, z};
  return {deflection.x() / network.tangential, deflection.y() / network.tangential, z};
}

}  // namespace

Vector3d RadialBasis::force(const Vector3d& deflection) const {
  if (!(deflection.z() > 0)) return Vector3d::Zero();
  const Eigen::RowVector3d q = place(deflection, *this).transpose();
  Vector3d sum = Vector3d::Zero();
  for (Eigen::Index k = 0; k < centres.rows(); ++k) {
    sum += std::sqrt((centres.row(k) - q).squaredNorm() + breadth * breadth) * weights.row(k).transpose();
  }
  return sum;
}

RadialBasis fit_radial_basis(const std::vector<Sample>& samples, double depth, double tangential, int centres,
                             const std::string& what) {
  const fit::PairSamples data = fit::sort_samples(samples, what);
  RadialBasis network;
  network.depth = depth;
  network.tangential = tangential;
  std::vector<const Sample*> all = data.normal;
  all.insert(all.end(), data.tangential.begin(), data.tangential.end());
  const auto count = static_cast<Eigen::Index>(all.size());
  Eigen::MatrixX3d at(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) at.row(i) = place(all[static_cast<std::size_t>(i)]->deflection, network);

  const Eigen::Index taken = std::min<Eigen::Index>(centres, count);
  network.centres.resize(taken, 3);
  VectorXd away = VectorXd::Constant(count, HUGE_VAL);
  Eigen::Index next = 0;
  for (Eigen::Index k = 0; k < taken; ++k) {
    network.centres.row(k) = at.row(next);
    away = away.cwiseMin((at.rowwise() - at.row(next)).rowwise().norm());
    network.breadth = away.maxCoeff(&next);  // in the end how far a sample may be from its centre
  }
  network.breadth = std::max(network.breadth, 0.1);

  MatrixXd rows = MatrixXd::Zero(count + taken, taken);
  MatrixXd target = MatrixXd::Zero(count + taken, 3);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Sample& s = *all[static_cast<std::size_t>(i)];
    const double weight = data.weight(s);
    for (Eigen::Index k = 0; k < taken; ++k) {
      const double r2 = (network.centres.row(k) - at.row(i)).squaredNorm();
      rows(i, k) = weight * data.peak * std::sqrt(r2 + network.breadth * network.breadth);
    }
    target.row(i) = weight * s.force.transpose();
  }
  rows.bottomRows(taken) = kBasisRidge * MatrixXd::Identity(taken, taken);
  network.weights.resize(taken, 3);
  for (int axis = 0; axis < 3; ++axis) {
    network.weights.col(axis) = data.peak * fit::solve_linear(rows, target.col(axis), what + ", radial basis");
  }
  return network;
}

}  // namespace palpate::verify
