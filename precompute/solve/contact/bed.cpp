// SPDX-License-Identifier: GPL-3.0-or-later
// Integrals of products of the six shape functions of a face.
#include "precompute/solve/contact/bed.hpp"

#include <Eigen/Geometry>
#include <algorithm>

namespace palpate::solve {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

// A slider's stiffness over that of the body across its length: its give is a ten-thousandth of the body's.
constexpr double kSlider = 1e4;

// Integral of the product of shape functions a and b over a face of area 1.
double mass(int a, int b) {
  constexpr int kTable[6][6] = {{6, -1, -1, 0, -4, 0},  {-1, 6, -1, 0, 0, -4},  {-1, -1, 6, -4, 0, 0},
                                {0, 0, -4, 32, 16, 16}, {-4, 0, 0, 16, 32, 16}, {0, -4, 0, 16, 16, 32}};
  return kTable[a][b] / 180.0;
}

}  // namespace

BedEnergy::BedEnergy(const Body& body, const mesh::TetMesh& mesh) {
  const bool any = std::any_of(body.supports.begin(), body.supports.end(),
                               [](const SupportScene& s) { return s.type != SupportScene::Type::fixed; });
  if (!any) return;
  rest_.resize(3 * static_cast<Eigen::Index>(mesh.nodes.size()));
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    rest_.segment<3>(3 * static_cast<Eigen::Index>(n)) = mesh.nodes[n];
  for (const auto& nodes : mesh.faces) {
    const Vector3d &a = mesh.nodes[nodes[0]], &b = mesh.nodes[nodes[1]], &c = mesh.nodes[nodes[2]];
    const SupportScene* support = body.support_at((a + b + c) / 3);
    if (support == nullptr || support->type == SupportScene::Type::fixed) continue;
    const Vector3d normal = (b - a).cross(c - a);
    const double area = 0.5 * normal.norm();
    const Matrix3d stiffness = support->type == SupportScene::Type::spring
                                   ? Matrix3d(support->stiffness * Matrix3d::Identity())
                                   : Matrix3d(kSlider * body.material.young / body.diagonal * normal.normalized() *
                                              normal.normalized().transpose());
    faces_.push_back({nodes, area * stiffness});
  }
}

double BedEnergy::value(const VectorXd& x) const {
  VectorXd unused = VectorXd::Zero(x.size());
  return gradient(x, unused);
}

double BedEnergy::gradient(const VectorXd& x, VectorXd& gradient) const {
  double sum = 0;
  for (const Face& face : faces_) {
    Eigen::Matrix<double, 3, 6> u, pull = Eigen::Matrix<double, 3, 6>::Zero();
    for (int n = 0; n < 6; ++n) u.col(n) = x.segment<3>(3 * face.nodes[n]) - rest_.segment<3>(3 * face.nodes[n]);
    for (int a = 0; a < 6; ++a) {
      for (int b = 0; b < 6; ++b) pull.col(a) += mass(a, b) * face.stiffness * u.col(b);
      sum += 0.5 * pull.col(a).dot(u.col(a));
    }
    for (int n = 0; n < 6; ++n) gradient.segment<3>(3 * face.nodes[n]) += pull.col(n);
  }
  return sum;
}

void BedEnergy::hessian(fem::BlockMatrix& matrix) const {
  for (const Face& face : faces_) {
    for (int a = 0; a < 6; ++a) {
      for (int b = 0; b <= a; ++b) matrix.add(face.nodes[a], face.nodes[b], mass(a, b) * face.stiffness);
    }
  }
}

}  // namespace palpate::solve
