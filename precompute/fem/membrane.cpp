// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/fem/membrane.hpp"

#include "precompute/algebra/spectrum.hpp"
#include "precompute/fem/face_shape.hpp"
#include "precompute/fem/pressure.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace palpate::fem {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Deformation = Eigen::Matrix<double, 3, 2>;

// The state at one point, over mu: C^-1, 1 / det C and the second Piola-Kirchhoff stress.
struct Strain {
  Deformation f;
  Matrix2d inverse;
  double per_det = 0.0, density = 0.0;
  Matrix2d stress;

  explicit Strain(const Deformation& deformation) : f(deformation) {
    const Matrix2d c = f.transpose() * f;
    const double det = c.determinant();
    if (!(det > 1e-12)) {
      density = std::numeric_limits<double>::infinity();
      return;
    }
    per_det = 1 / det;
    inverse = c.inverse();
    density = 0.5 * (c.trace() + per_det - 3);
    stress = Matrix2d::Identity() - per_det * inverse;
  }
};

Matrix2d positive_part(const Matrix2d& m) {
  const auto eigen = algebra::spectrum(m);
  return eigen.vectors * eigen.values.cwiseMax(0).asDiagonal() * eigen.vectors.transpose();
}

template <class Face>
Eigen::Matrix<double, 3, 6> gather(const Face& face, const VectorXd& x) {
  Eigen::Matrix<double, 3, 6> nodes;
  for (int n = 0; n < 6; ++n) nodes.col(n) = x.segment<3>(3 * face.nodes[n]);
  return nodes;
}

}  // namespace

MembraneEnergy::MembraneEnergy(const mesh::TetMesh& mesh, const std::vector<char>& fixed,
                               const MembraneOptions& options) {
  if (!(options.thickness > 0)) return;
  std::set<std::array<std::int32_t, 6>> hollow;
  for (const MeshFaces& wall : cavity_walls(mesh)) hollow.insert(wall.begin(), wall.end());
  for (const auto& nodes : mesh.faces) {
    if (hollow.count(nodes) > 0) continue;
    if (std::all_of(nodes.begin(), nodes.end(), [&](std::int32_t n) { return fixed[n] != 0; })) continue;
    const Vector3d &a = mesh.nodes[nodes[0]], &b = mesh.nodes[nodes[1]], &c = mesh.nodes[nodes[2]];
    const Vector3d u = (a - c).normalized(), v = (a - c).cross(b - c).cross(a - c).normalized();
    Matrix2d jacobian;  // of the place in the plane by the barycentric coordinates a and b
    jacobian << u.dot(a - c), u.dot(b - c), v.dot(a - c), v.dot(b - c);
    Face face{nodes, {}, options.young / 3 * options.thickness * jacobian.determinant() / 2 / kPoints};
    int q = 0;
    for (const auto& [at_a, at_b] : {std::pair{0.5, 0.5}, {0.5, 0.0}, {0.0, 0.5}}) {
      face.gradients[q++] = face_gradients(at_a, at_b) * jacobian.inverse();
    }
    faces_.push_back(face);
  }
}

double MembraneEnergy::value(const VectorXd& x) const {
  double sum = 0;
  for (const Face& face : faces_) {
    const auto nodes = gather(face, x);
    for (const Shape& g : face.gradients) sum += face.weight * Strain(nodes * g).density;
  }
  return sum;
}

double MembraneEnergy::gradient(const VectorXd& x, VectorXd& gradient) const {
  double sum = 0;
  for (const Face& face : faces_) {
    const auto nodes = gather(face, x);
    Eigen::Matrix<double, 3, 6> force = Eigen::Matrix<double, 3, 6>::Zero();
    for (const Shape& g : face.gradients) {
      const Strain s(nodes * g);
      if (!std::isfinite(s.density)) return s.density;
      sum += face.weight * s.density;
      force += face.weight * s.f * s.stress * g.transpose();
    }
    for (int n = 0; n < 6; ++n) gradient.segment<3>(3 * face.nodes[n]) += force.col(n);
  }
  return sum;
}

void MembraneEnergy::hessian(const VectorXd& x, HessianKind kind, BlockMatrix& matrix) const {
  for (const Face& face : faces_) {
    const auto nodes = gather(face, x);
    Matrix3d blocks[6][6];
    for (auto& row : blocks) std::fill(std::begin(row), std::end(row), Matrix3d::Zero());
    for (const Shape& g : face.gradients) {
      const Strain s(nodes * g);
      if (!std::isfinite(s.density)) return;
      const Matrix2d stress = kind == HessianKind::convex ? positive_part(s.stress) : s.stress;
      const Eigen::Matrix<double, 3, 6> along = s.f * s.inverse * g.transpose();
      const Matrix3d surface = s.f * s.inverse * s.f.transpose();
      for (int a = 0; a < 6; ++a) {
        for (int b = 0; b <= a; ++b) {
          const Vector2d ga = g.row(a), gb = g.row(b);
          blocks[a][b] +=
              face.weight * (gb.dot(stress * ga) * Matrix3d::Identity() +
                             s.per_det * (2 * along.col(a) * along.col(b).transpose() +
                                          along.col(b) * along.col(a).transpose() + gb.dot(s.inverse * ga) * surface));
        }
      }
    }
    for (int a = 0; a < 6; ++a) {
      for (int b = 0; b <= a; ++b) matrix.add(face.nodes[a], face.nodes[b], blocks[a][b]);
    }
  }
}

}  // namespace palpate::fem
