// SPDX-License-Identifier: GPL-3.0-or-later
// Cauchy stress P F^T / J in the middle of every element, its pressure from the element's mean dilatation.
#include "precompute/solve/pair/solved_fields.hpp"

#include "precompute/fem/materials/scene_material.hpp"

#include <Eigen/LU>

namespace palpate::solve {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kEdges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
// Points of the four-point rule of a tetrahedron.
constexpr double kNear = 0.585410196624969, kFar = 0.138196601125011;

using Slopes = Eigen::Matrix<double, 4, 3>;

// Gradients of the barycentric coordinates (1/m) of a straight-sided tetrahedron.
Slopes slopes_of(const mesh::TetMesh& mesh, const std::array<std::int32_t, 10>& tet) {
  Matrix3d edges;
  for (int k = 0; k < 3; ++k) {
    edges.col(k) = mesh.nodes[std::size_t(tet[std::size_t(k) + 1])] - mesh.nodes[std::size_t(tet[0])];
  }
  Slopes slopes;
  slopes.bottomRows<3>() = edges.inverse();
  slopes.row(0) = -slopes.bottomRows<3>().colwise().sum();
  return slopes;
}

Matrix3d gradient_at(const Eigen::VectorXd& x, const std::array<std::int32_t, 10>& tet, const Slopes& slopes,
                     const Eigen::Vector4d& l) {
  Matrix3d f = Matrix3d::Zero();
  for (int n = 0; n < 4; ++n) f += x.segment<3>(3 * tet[std::size_t(n)]) * ((4 * l[n] - 1) * slopes.row(n));
  for (int n = 0; n < 6; ++n) {
    const int i = kEdges[n][0], j = kEdges[n][1];
    f += x.segment<3>(3 * tet[std::size_t(4 + n)]) * (4 * (l[i] * slopes.row(j) + l[j] * slopes.row(i)));
  }
  return f;
}

}  // namespace

VolumeFields solved_fields(const Body& body, const mesh::TetMesh& mesh, const Eigen::VectorXd& x) {
  std::vector<fem::Material> materials{fem::make_material(body.material)};
  std::vector<const geometry::CurveQuery*> fibres{body.fibres.get()};
  for (const Inclusion& i : body.inclusions) {
    materials.push_back(fem::make_material(i.material));
    fibres.push_back(i.fibres.get());
  }
  VolumeFields fields;
  fields.points = mesh.nodes;
  fields.tets = mesh.tets;
  fields.regions = mesh.regions;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    fields.displacement.emplace_back(x.segment<3>(3 * Eigen::Index(n)) - mesh.nodes[n]);
  }
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const auto& tet = mesh.tets[t];
    const Slopes slopes = slopes_of(mesh, tet);
    double mean = 0;
    for (int q = 0; q < 4; ++q) {
      Eigen::Vector4d l = Eigen::Vector4d::Constant(kFar);
      l[q] = kNear;
      mean += gradient_at(x, tet, slopes, l).determinant() / 4;
    }
    const auto region = std::size_t(mesh.regions[t]);
    fem::Material& material = materials[region];
    if (fibres[region] != nullptr) {
      Vector3d middle = Vector3d::Zero();
      for (std::size_t k = 0; k < 4; ++k) middle += mesh.nodes[std::size_t(tet[k])] / 4;
      material.fibre = fibres[region]->tangent(middle);
    }
    const Matrix3d f = gradient_at(x, tet, slopes, Eigen::Vector4d::Constant(0.25));
    Matrix3d first;
    material.stress(f, first);
    const double j = f.determinant();
    Matrix3d cauchy = first * f.transpose() / j + material.volumetric_slope(mean) * Matrix3d::Identity();
    cauchy = (0.5 * (cauchy + cauchy.transpose())).eval();
    fields.stress.push_back(cauchy);
    fields.jacobian.push_back(mean);
  }
  return fields;
}

}  // namespace palpate::solve
