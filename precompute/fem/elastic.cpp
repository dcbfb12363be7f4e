// SPDX-License-Identifier: GPL-3.0-or-later
// Element-local energy, gradient and Hessian of the P2/P0 element.
#include "precompute/fem/elastic.hpp"

#include "formats/error.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace palpate {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

// Edges that carry the nodes 4 to 9.
constexpr int kEdges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};

Matrix3d cofactor(const Matrix3d& f) {
  Matrix3d c;
  c.col(0) = f.col(1).cross(f.col(2));
  c.col(1) = f.col(2).cross(f.col(0));
  c.col(2) = f.col(0).cross(f.col(1));
  return c;
}

Matrix3d skew(const Vector3d& v) {
  Matrix3d m;
  m << 0, v.z(), -v.y(), -v.z(), 0, v.x(), v.y(), -v.x(), 0;
  return m;  // m(i, k) = epsilon_ikm v_m
}

// dP/dF between two shape gradients: entry (i, k) = sum over a, b of left_a T(i a, k b) right_b.
Matrix3d contracted(const Tangent& t, const Eigen::RowVector3d& left, const Eigen::RowVector3d& right) {
  Matrix3d sum = Matrix3d::Zero();
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) sum.noalias() += left[a] * right[b] * t.block<3, 3>(3 * a, 3 * b);
  }
  return sum;
}

}  // namespace

ElasticEnergy::ElasticEnergy(const TetMesh& mesh, std::vector<Material> materials) : materials_(std::move(materials)) {
  // Four-point rule of degree 2: barycentric coordinates (a, b, b, b) and permutations, equal weights.
  const double a = (5 + 3 * std::sqrt(5.0)) / 20, b = (5 - std::sqrt(5.0)) / 20;
  elements_.reserve(mesh.tets.size());
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    Element e;
    e.nodes = mesh.tets[t];
    Matrix3d edges;
    for (int k = 0; k < 3; ++k) edges.col(k) = mesh.nodes[e.nodes[k + 1]] - mesh.nodes[e.nodes[0]];
    const double det = edges.determinant();
    e.volume = det / 6;
    if (!(e.volume > 0)) {
      throw Error(ExitCode::numerical, "element " + std::to_string(t) + " of the volume mesh has volume " +
                                           std::to_string(e.volume) + " m^3; it must be positive");
    }
    const Matrix3d inverse = edges.inverse();
    Eigen::Matrix<double, 4, 3> dl;  // gradients of the barycentric coordinates
    dl.bottomRows<3>() = inverse;
    dl.row(0) = -inverse.colwise().sum();
    for (int q = 0; q < kPoints; ++q) {
      Eigen::Vector4d l = Eigen::Vector4d::Constant(b);
      l[q] = a;
      for (int n = 0; n < 4; ++n) e.gradients[q].row(n) = (4 * l[n] - 1) * dl.row(n);
      for (int n = 0; n < 6; ++n) {
        const auto [i, j] = kEdges[n];
        e.gradients[q].row(4 + n) = 4 * (l[i] * dl.row(j) + l[j] * dl.row(i));
      }
    }
    e.material = mesh.regions.empty() ? 0 : mesh.regions[t];
    materials_.at(static_cast<std::size_t>(e.material));  // throws where the region has none
    elements_.push_back(e);
  }
}

ElasticEnergy::Nodes ElasticEnergy::gather(const Element& e, const VectorXd& x) {
  Nodes p;
  for (int n = 0; n < 10; ++n) p.col(n) = x.segment<3>(3 * e.nodes[n]);
  return p;
}

double ElasticEnergy::value(const VectorXd& x) const {
  double sum = 0;
  for (const Element& e : elements_) {
    const Material& material = materials_[e.material];
    const Nodes p = gather(e, x);
    double energy = 0, dilatation = 0;
    for (const Shape& g : e.gradients) {
      const Matrix3d f = p * g;
      energy += material.deviatoric(f) / kPoints;
      dilatation += f.determinant() / kPoints;
    }
    sum += e.volume * (energy + material.volumetric(dilatation));
  }
  return sum;
}

double ElasticEnergy::gradient(const VectorXd& x, VectorXd& gradient) const {
  double sum = 0;
  for (const Element& e : elements_) {
    const Material& material = materials_[e.material];
    const Nodes p = gather(e, x);
    double energy = 0, dilatation = 0;
    std::array<Matrix3d, kPoints> stress, cofactors;
    for (int q = 0; q < kPoints; ++q) {
      const Matrix3d f = p * e.gradients[q];
      cofactors[q] = cofactor(f);
      energy += material.stress(f, stress[q]) / kPoints;
      dilatation += f.col(0).dot(cofactors[q].col(0)) / kPoints;
    }
    sum += e.volume * (energy + material.volumetric(dilatation));
    const double scale = e.volume / kPoints, slope = material.volumetric_slope(dilatation);
    Nodes force = Nodes::Zero();
    for (int q = 0; q < kPoints; ++q) {
      force.noalias() += (scale * (stress[q] + slope * cofactors[q])) * e.gradients[q].transpose();
    }
    for (int n = 0; n < 10; ++n) gradient.segment<3>(3 * e.nodes[n]) += force.col(n);
  }
  return sum;
}

void ElasticEnergy::hessian(const VectorXd& x, HessianKind kind, BlockMatrix& matrix) const {
  for (const Element& e : elements_) {
    const Material& material = materials_[e.material];
    const Nodes p = gather(e, x);
    std::array<Matrix3d, kPoints> fs;
    std::array<Tangent, kPoints> tangents;
    double dilatation = 0;
    Nodes volume = Nodes::Zero();
    Eigen::Matrix<double, 10, 10> laplace = Eigen::Matrix<double, 10, 10>::Zero();
    for (int q = 0; q < kPoints; ++q) {
      const Shape& g = e.gradients[q];
      fs[q] = p * g;
      const Matrix3d c = cofactor(fs[q]);
      dilatation += fs[q].col(0).dot(c.col(0)) / kPoints;
      volume.noalias() += c * g.transpose() / kPoints;
      laplace.noalias() += g * g.transpose() / kPoints;
      if (material.laws.empty()) continue;
      tangents[q] = material.law_tangent(fs[q]);
      if (kind == HessianKind::convex) tangents[q] = positive_part(tangents[q]);
    }
    const double mu = e.volume * material.mu, bulk = e.volume * material.volumetric_curvature();
    const double slope = e.volume * material.volumetric_slope(dilatation) / kPoints;
    for (int a = 0; a < 10; ++a) {
      for (int b = 0; b <= a; ++b) {
        Matrix3d block = bulk * volume.col(a) * volume.col(b).transpose();
        block.diagonal().array() += mu * laplace(a, b);
        if (kind == HessianKind::exact && a != b) {
          Vector3d v = Vector3d::Zero();
          for (int q = 0; q < kPoints; ++q) {
            const Shape& g = e.gradients[q];
            v.noalias() += fs[q] * g.row(a).transpose().cross(g.row(b).transpose());
          }
          block += slope * skew(v);
        }
        if (!material.laws.empty()) {
          for (int q = 0; q < kPoints; ++q) {
            block += e.volume / kPoints * contracted(tangents[q], e.gradients[q].row(a), e.gradients[q].row(b));
          }
        }
        matrix.add(e.nodes[a], e.nodes[b], block);
      }
    }
  }
}

double ElasticEnergy::min_jacobian(const VectorXd& x) const {
  double smallest = std::numeric_limits<double>::max();
  for (const Element& e : elements_) {
    const Nodes p = gather(e, x);
    for (const Shape& g : e.gradients) smallest = std::min(smallest, Matrix3d(p * g).determinant());
  }
  return smallest;
}

}  // namespace palpate
