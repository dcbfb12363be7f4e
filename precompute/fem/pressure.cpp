// SPDX-License-Identifier: GPL-3.0-or-later
// The volume as a surface integral, V = 1/3 of the integral of x . (x_a x x_b) over the faces (divergence theorem).
#include "precompute/fem/pressure.hpp"

#include "precompute/fem/face_shape.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <numeric>

namespace palpate::fem {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Nodes = Eigen::Matrix<double, 3, 6>;

// Degree 4 (Dunavant 1985): exact for products of x and its two tangents. Weights sum to the half of the unit triangle.
struct Point {
  std::array<double, 6> shape;
  Eigen::Matrix<double, 6, 2> gradients;
  double weight;
};

std::array<Point, 6> make_points() {
  std::array<Point, 6> points;
  std::size_t q = 0;
  for (const auto& [at, weight] :
       {std::pair{0.445948490915964886, 0.111690794839005733}, std::pair{0.091576213509770743, 0.054975871827660933}}) {
    for (const auto& [a, b] : {std::pair{at, at}, std::pair{at, 1 - 2 * at}, std::pair{1 - 2 * at, at}}) {
      points[q++] = {face_values(a, b), face_gradients(a, b), weight};
    }
  }
  return points;
}

const std::array<Point, 6> kPoints = make_points();

// Position and tangents of a face at a point.
struct Place {
  Vector3d x = Vector3d::Zero(), a = Vector3d::Zero(), b = Vector3d::Zero();
  Place(const Nodes& nodes, const Point& q) {
    for (int n = 0; n < 6; ++n) x += q.shape[std::size_t(n)] * nodes.col(n);
    a = nodes * q.gradients.col(0);
    b = nodes * q.gradients.col(1);
  }
};

Nodes gather(const std::array<std::int32_t, 6>& face, const VectorXd& x, const Vector3d& centre) {
  Nodes nodes;
  for (int n = 0; n < 6; ++n) nodes.col(n) = x.segment<3>(3 * face[std::size_t(n)]) - centre;
  return nodes;
}

// On the side that the faces face away from.
double volume_behind(const MeshFaces& faces, const VectorXd& x, const Vector3d& centre) {
  double sum = 0;
  for (const auto& face : faces) {
    const Nodes nodes = gather(face, x, centre);
    for (const Point& q : kPoints) {
      const Place p(nodes, q);
      sum += q.weight / 3 * p.x.dot(p.a.cross(p.b));
    }
  }
  return sum;
}

Matrix3d cross_matrix(const Vector3d& v) {
  Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

VectorXd positions(const mesh::TetMesh& mesh) {
  VectorXd x(3 * static_cast<Eigen::Index>(mesh.nodes.size()));
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) x.segment<3>(3 * static_cast<Eigen::Index>(n)) = mesh.nodes[n];
  return x;
}

}  // namespace

std::vector<MeshFaces> cavity_walls(const mesh::TetMesh& mesh) {
  // Faces that share a node belong together; a set of nodes is known by its smallest.
  std::vector<std::int32_t> root(mesh.nodes.size());
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](std::int32_t n) {
    while (root[n] != n) n = root[n] = root[root[n]];
    return n;
  };
  for (const auto& face : mesh.faces) {
    for (const std::int32_t n : face) {
      const std::int32_t a = find(face[0]), b = find(n);
      root[std::max(a, b)] = std::min(a, b);
    }
  }
  std::vector<MeshFaces> parts;
  std::map<std::int32_t, std::size_t> number;
  for (const auto& face : mesh.faces) {
    const auto [at, fresh] = number.try_emplace(find(face[0]), parts.size());
    if (fresh) parts.emplace_back();
    parts[at->second].push_back(face);
  }
  const VectorXd x = positions(mesh);
  std::vector<MeshFaces> walls;
  for (MeshFaces& part : parts) {
    if (volume_behind(part, x, mesh.nodes[part[0][0]]) < 0) walls.push_back(std::move(part));
  }
  return walls;
}

PressureEnergy::PressureEnergy(const mesh::TetMesh& mesh, MeshFaces walls, double pressure)
    : walls_(std::move(walls)), pressure_(pressure) {
  if (empty()) return;
  centre_ = mesh.nodes[walls_[0][0]];
  rest_volume_ = volume(positions(mesh));
}

double PressureEnergy::volume(const VectorXd& x) const { return -volume_behind(walls_, x, centre_); }

double PressureEnergy::gradient(const VectorXd& x, double factor, VectorXd& gradient) const {
  double sum = 0;
  for (const auto& face : walls_) {
    const Nodes nodes = gather(face, x, centre_);
    Nodes pull = Nodes::Zero();
    for (const Point& q : kPoints) {
      const Place p(nodes, q);
      const Vector3d across = p.a.cross(p.b), b_x = p.b.cross(p.x), x_a = p.x.cross(p.a);
      sum += q.weight / 3 * p.x.dot(across);
      for (int n = 0; n < 6; ++n) {
        pull.col(n) +=
            q.weight / 3 * (q.shape[std::size_t(n)] * across + q.gradients(n, 0) * b_x + q.gradients(n, 1) * x_a);
      }
    }
    for (int n = 0; n < 6; ++n) gradient.segment<3>(3 * face[std::size_t(n)]) += factor * pressure_ * pull.col(n);
  }
  return empty() ? 0.0 : pressure_ * (sum + rest_volume_);
}

void PressureEnergy::hessian(const VectorXd& x, HessianKind kind, double factor, BlockMatrix& matrix) const {
  if (kind == HessianKind::convex) return;
  for (const auto& face : walls_) {
    const Nodes nodes = gather(face, x, centre_);
    Nodes along[6];
    for (Nodes& row : along) row.setZero();
    for (const Point& q : kPoints) {
      const Place p(nodes, q);
      const double weight = factor * pressure_ * q.weight / 3;
      for (int i = 0; i < 6; ++i) {
        for (int j = 0; j < i; ++j) {
          const double ni = q.shape[std::size_t(i)], nj = q.shape[std::size_t(j)];
          const auto gi = q.gradients.row(i), gj = q.gradients.row(j);
          along[i].col(j) += weight * ((nj * gi[0] - ni * gj[0]) * p.b + (ni * gj[1] - nj * gi[1]) * p.a +
                                       (gj[0] * gi[1] - gi[0] * gj[1]) * p.x);
        }
      }
    }
    for (int i = 0; i < 6; ++i) {
      for (int j = 0; j < i; ++j) {
        matrix.add(face[std::size_t(i)], face[std::size_t(j)], cross_matrix(along[i].col(j)));
      }
    }
  }
}

}  // namespace palpate::fem
