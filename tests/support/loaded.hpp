// SPDX-License-Identifier: GPL-3.0-or-later
// A body under dead forces, for the minimiser that the bake uses.
#pragma once

#include "precompute/fem/minimiser.hpp"
#include "precompute/solve/contact/bed.hpp"

#include <Eigen/Geometry>
#include <utility>

namespace palpate::test {

/// Elastic energy, that of elastic supports where there are any, less the work of a dead force on each node (3 N, N).
/// Keeps references to the energies.
class Loaded final : public fem::EnergyProblem {
public:
  Loaded(const fem::ElasticEnergy& elastic, Eigen::VectorXd force, const solve::BedEnergy* bed = nullptr)
      : elastic_(elastic), bed_(bed), force_(std::move(force)) {}
  double value(const Eigen::VectorXd& x) const override {
    return elastic_.value(x) + (bed_ ? bed_->value(x) : 0) - force_.dot(x);
  }
  double gradient(const Eigen::VectorXd& x, Eigen::VectorXd& g) const override {
    g = -force_;
    const double elastic = elastic_.gradient(x, g);
    return elastic + (bed_ ? bed_->gradient(x, g) : 0) - force_.dot(x);
  }
  void hessian(const Eigen::VectorXd& x, fem::HessianKind kind, fem::BlockMatrix& m) const override {
    elastic_.hessian(x, kind, m);
    if (bed_) bed_->hessian(m);
  }
  double load(const Eigen::VectorXd&) const override { return force_.norm(); }

private:
  const fem::ElasticEnergy& elastic_;
  const solve::BedEnergy* bed_;
  Eigen::VectorXd force_;
};

/// Forces on the nodes (3 N, N) of traction(face's centroid, place, outward unit normal) (Pa) over the undeformed
/// faces: Dunavant's six points, exact where the traction is of degree 2.
template <class Traction>
Eigen::VectorXd face_loads(const mesh::TetMesh& mesh, Traction&& traction) {
  constexpr double kNear[2] = {0.445948490915965, 0.091576213509771},
                   kWeight[2] = {0.223381589678011, 0.109951743655322};
  Eigen::VectorXd force = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(mesh.nodes.size()));
  for (const auto& face : mesh.faces) {
    const Eigen::Vector3d &a = mesh.nodes[face[0]], &b = mesh.nodes[face[1]], &c = mesh.nodes[face[2]];
    const Eigen::Vector3d area = (b - a).cross(c - a) / 2;
    for (int q = 0; q < 6; ++q) {
      double l[3] = {kNear[q / 3], kNear[q / 3], kNear[q / 3]};
      l[q % 3] = 1 - 2 * kNear[q / 3];
      const double shape[6] = {l[0] * (2 * l[0] - 1), l[1] * (2 * l[1] - 1), l[2] * (2 * l[2] - 1),
                               4 * l[0] * l[1],       4 * l[1] * l[2],       4 * l[2] * l[0]};
      const Eigen::Vector3d on =
          traction(Eigen::Vector3d((a + b + c) / 3), Eigen::Vector3d(l[0] * a + l[1] * b + l[2] * c),
                   Eigen::Vector3d(area.normalized()));
      for (int n = 0; n < 6; ++n) {
        force.segment<3>(3 * static_cast<Eigen::Index>(face[n])) += kWeight[q / 3] * area.norm() * shape[n] * on;
      }
    }
  }
  return force;
}

}  // namespace palpate::test
