// SPDX-License-Identifier: GPL-3.0-or-later
// Element-local energy, gradient and Hessian of the P2/P0 element.
#include "precompute/fem/elastic.hpp"

#include "formats/io/error.hpp"
#include "precompute/fem/materials/determinant.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace palpate::fem {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Nodes = Eigen::Matrix<double, 3, 10>;

constexpr int kPoints = kElementPoints;

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

// Factor of the shear modulus. One element between two free faces bends by opposite changes of volume on its two sides,
// which cancel in its mean: sheets would be a quarter too soft. With 2, sheets of 2 and 4 mm are within 2 % of refined
// ones, and a block does not change. The error at the edge of a wedge is smaller, the blunter the wedge.
constexpr double kSpanning = 2.0;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
// Errors of positions, in kEpsilon times their size: forces of bodies 1e4 times as thick as the contact is wide do not
// come nearer to balance than 0.9 to 1.3 of the estimate with 1.
constexpr double kLastBits = 2.0;

// Unit, of the outer faces at every corner; none inside.
std::vector<std::vector<Vector3d>> outer_normals(const mesh::TetMesh& mesh) {
  std::vector<std::vector<Vector3d>> normals(mesh.nodes.size());
  for (const auto& f : mesh.faces) {
    const Vector3d &a = mesh.nodes[f[0]], &b = mesh.nodes[f[1]], &c = mesh.nodes[f[2]];
    const Vector3d normal = (b - a).cross(c - a).normalized();
    for (int k = 0; k < 3; ++k) normals[f[k]].push_back(normal);
  }
  return normals;
}

// How much an element goes from one side of the body to the other: 1 where faces at two corners look in opposite
// directions, 0 where none do, and in between a power that suits wedges: of 30 degrees, half a tip's radius from the
// edge, within 1 % of refined ones.
double spans(const std::vector<std::vector<Vector3d>>& normals, const std::array<std::int32_t, 10>& nodes) {
  double least = 0.0;  // cosine
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < i; ++j) {
      for (const Vector3d& a : normals[nodes[i]]) {
        for (const Vector3d& b : normals[nodes[j]]) least = std::min(least, a.dot(b));
      }
    }
  }
  return std::pow(least, 12);
}

}  // namespace

ElasticEnergy::ElasticEnergy(const mesh::TetMesh& mesh, std::vector<Material> materials)
    : materials_(std::move(materials)) {
  elements_.reserve(mesh.tets.size());
  const std::vector<std::vector<Vector3d>> normals = outer_normals(mesh);
  std::vector<double> shear, moduli;  // Pa; of both kinds together
  for (const Material& m : materials_) {
    shear.push_back(m.shear_modulus());
    moduli.push_back(shear.back() + m.bulk_modulus());
  }
  double square_force = 0;  // N^2, of rounding
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
    e.slopes.bottomRows<3>() = inverse;
    e.slopes.row(0) = -inverse.colwise().sum();
    e.material = mesh.regions.empty() ? 0 : mesh.regions[t];
    const auto region = static_cast<std::size_t>(e.material);
    if (region >= shear.size()) throw std::out_of_range("region " + std::to_string(region) + " has no material");
    const Material& material = materials_[region];
    e.local = std::min(material.local + spans(normals, e.nodes) * kSpanning * shear[region],
                       std::max(material.local, material.bulk));
    // A strain's; energies of laws are differences of invariants and their values at rest besides.
    const double rounding = kLastBits * kEpsilon * mesh.nodes[e.nodes[0]].norm() * e.slopes.norm();
    rounding_.energy +=
        (moduli[region] * rounding * rounding + (material.laws.empty() ? 0.0 : kEpsilon * shear[region])) * e.volume;
    square_force += std::pow(moduli[region] * rounding * e.volume * e.slopes.norm(), 2);
    if (material.fibre_at) {
      Material own = material;
      own.fibre = own.fibre_at(mesh.nodes[e.nodes[0]] + edges.rowwise().sum() / 4);
      own.fibre_at = nullptr;
      e.material = static_cast<std::int32_t>(materials_.size());
      materials_.push_back(std::move(own));
    }
    elements_.push_back(e);
  }
  rounding_.force = std::sqrt(square_force);
  make_batches();
}

void ElasticEnergy::set_lane(const Element& e, const Material& material, int lane, ElementBatch& batch) {
  for (int n = 0; n < 10; ++n) batch.nodes[n][lane] = e.nodes[n];
  for (int k = 0; k < 4; ++k) {
    for (int i = 0; i < 3; ++i) batch.slopes[k][i][lane] = e.slopes(k, i);
  }
  const bool laws = !material.laws.empty();
  batch.volume[lane] = e.volume;
  batch.mu[lane] = material.mu;
  batch.slope[lane] = material.slope + (laws ? 0.0 : material.mu);
  batch.bulk[lane] = material.bulk;
  batch.local[lane] = e.local;
  if (laws) batch.laws[lane] = &material;
}

// Elements without laws first: a batch has either none or all of its lanes with laws.
void ElasticEnergy::make_batches() {
  for (const bool laws : {false, true}) {
    std::vector<const Element*> chosen;
    for (const Element& e : elements_) {
      if (materials_[e.material].laws.empty() != laws) chosen.push_back(&e);
    }
    for (std::size_t first = 0; first < chosen.size(); first += ElementBatch::kLanes) {
      ElementBatch batch;
      batch.count = static_cast<int>(std::min<std::size_t>(ElementBatch::kLanes, chosen.size() - first));
      for (int lane = 0; lane < ElementBatch::kLanes; ++lane) {
        const Element& e = *chosen[first + std::size_t(std::min(lane, batch.count - 1))];
        set_lane(e, materials_[e.material], lane, batch);
      }
      batches_.push_back(batch);
    }
  }
}

ElasticEnergy::Shape ElasticEnergy::shape_gradients(const Element& e, int point) {
  Eigen::Vector4d l = Eigen::Vector4d::Constant(kFarCorner);
  l[point] = kNearCorner;
  Shape g;
  for (int n = 0; n < 4; ++n) g.row(n) = (4 * l[n] - 1) * e.slopes.row(n);
  for (int n = 0; n < 6; ++n) {
    const auto [i, j] = kElementEdges[n];
    g.row(4 + n) = 4 * (l[i] * e.slopes.row(j) + l[j] * e.slopes.row(i));
  }
  return g;
}

double ElasticEnergy::value(const VectorXd& x) const { return batch_energy(batches_, x); }

double ElasticEnergy::gradient(const VectorXd& x, VectorXd& gradient) const {
  return batch_gradient(batches_, x, gradient);
}

double ElasticEnergy::min_jacobian(const VectorXd& x) const { return batch_min_jacobian(batches_, x); }

void ElasticEnergy::hessian(const VectorXd& x, HessianKind kind, BlockMatrix& matrix) const {
  for (const Element& e : elements_) {
    const Material& material = materials_[e.material];
    Nodes p;
    for (int n = 0; n < 10; ++n) p.col(n) = x.segment<3>(3 * e.nodes[n]);
    std::array<Shape, kPoints> gradients;
    std::array<Matrix3d, kPoints> fs;
    std::array<Tangent, kPoints> tangents;
    double dilatation = 0;
    std::array<double, kPoints> j;
    std::array<Nodes, kPoints> volumes;  // derivatives of j
    Nodes volume = Nodes::Zero();
    Eigen::Matrix<double, 10, 10> laplace = Eigen::Matrix<double, 10, 10>::Zero();
    for (int q = 0; q < kPoints; ++q) {
      const Shape& g = gradients[q] = shape_gradients(e, q);
      fs[q] = p * g;
      const Matrix3d c = cofactor(fs[q]);
      j[q] = fs[q].col(0).dot(c.col(0));
      dilatation += j[q] / kPoints;
      volumes[q].noalias() = c * g.transpose();
      volume += volumes[q] / kPoints;
      laplace.noalias() += g * g.transpose() / kPoints;
      if (material.laws.empty()) continue;
      tangents[q] = material.law_tangent(fs[q]);
      if (kind == HessianKind::convex) tangents[q] = positive_part(tangents[q]);
    }
    const double mu = e.volume * material.mu, bulk = e.volume * (material.volumetric_curvature() - e.local);
    const double local = e.volume * e.local / kPoints;
    const double slope = e.volume * material.volumetric_slope(dilatation) / kPoints;
    for (int a = 0; a < 10; ++a) {
      for (int b = 0; b <= a; ++b) {
        Matrix3d block = bulk * volume.col(a) * volume.col(b).transpose();
        for (const Nodes& v : volumes) block.noalias() += local * v.col(a) * v.col(b).transpose();
        block.diagonal().array() += mu * laplace(a, b);
        if (kind == HessianKind::exact && a != b) {
          Vector3d v = Vector3d::Zero();
          for (int q = 0; q < kPoints; ++q) {
            const Shape& g = gradients[q];
            const double pressure = slope + local * (j[q] - dilatation);
            v.noalias() += pressure * (fs[q] * g.row(a).transpose().cross(g.row(b).transpose()));
          }
          block += skew(v);
        }
        if (!material.laws.empty()) {
          for (int q = 0; q < kPoints; ++q) {
            block += e.volume / kPoints * contracted(tangents[q], gradients[q].row(a), gradients[q].row(b));
          }
        }
        matrix.add(e.nodes[a], e.nodes[b], block);
      }
    }
  }
}

}  // namespace palpate::fem
