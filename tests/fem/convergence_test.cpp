// SPDX-License-Identifier: GPL-3.0-or-later
// Manufactured solutions at finite strain on three refinements: the observed orders of P2/P0 and of plain P2.
#include "precompute/fem/minimiser.hpp"

#include "tests/support/block_mesh.hpp"
#include "tests/support/finite_difference.hpp"
#include "tests/support/loaded.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <vector>

namespace palpate::fem {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kYoung = 5e3;

// x_i = X_i + A sin(k_i . X + c_i), held at x = 0 and loaded all over: no symmetry; the volume changes by the square of
// the strain, so that nearly incompressible laws allow it.
struct Manufactured {
  Vector3d place{0, 0, 0};
  Matrix3d f = Matrix3d::Identity();
  Matrix3d stress = Matrix3d::Zero();  // Pa, nominal: P
  Vector3d force{0, 0, 0};             // N/m^3, that holds it: - Div P

  Manufactured(const Material& m, double height, const Vector3d& at) {
    static const Matrix3d kWaves{{0, 2.1, -1.7}, {-1.6, 0, 1.8}, {1.2, -2.0, 0}};
    static const Vector3d kPhases(0.4, 1.1, -0.6);
    const Vector3d angle = kWaves * at + kPhases;
    place = at + height * Vector3d(angle.array().sin());
    Matrix3d bend[3];  // second derivatives of the three places
    for (int i = 0; i < 3; ++i) {
      const Vector3d k = kWaves.row(i);
      f.row(i) += height * std::cos(angle[i]) * k;
      bend[i] = -height * std::sin(angle[i]) * k * k.transpose();
    }
    // Cofactors are free of divergence: Div P = mu Laplace(x) + bulk cof F grad J, and grad J = cof F : grad F.
    const double j = f.determinant();
    const Matrix3d cofactor = j * f.inverse().transpose();
    stress = m.mu * f + m.volumetric_slope(j) * cofactor;
    Vector3d slope = Vector3d::Zero();
    for (int i = 0; i < 3; ++i) slope += bend[i] * Vector3d(cofactor.row(i));
    for (int i = 0; i < 3; ++i) force[i] = -m.mu * bend[i].trace();
    force -= m.bulk * cofactor * slope;
  }
};

struct QuadraturePoint {
  Eigen::Matrix<double, 10, 1> shape;
  Eigen::Matrix<double, 10, 4> slope;  // by the barycentric coordinates
  double weight = 0.0;                 // of a volume of 1
};

// Gauss-Legendre with four points in each of the three collapsed coordinates: exact to degree 5.
std::vector<QuadraturePoint> quadrature() {
  constexpr std::array<double, 4> kAt{0.06943184420297371, 0.33000947820757187, 0.66999052179242813,
                                      0.93056815579702629};
  constexpr std::array<double, 4> kWeight{0.17392742256872693, 0.32607257743127307, 0.32607257743127307,
                                          0.17392742256872693};
  constexpr int kEdges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
  std::vector<QuadraturePoint> all;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      for (int k = 0; k < 4; ++k) {
        const double a = kAt[i], b = (1 - a) * kAt[j], c = (1 - a - b) * kAt[k];
        const Eigen::Vector4d l(1 - a - b - c, a, b, c);
        QuadraturePoint q;
        q.weight = 6 * kWeight[i] * kWeight[j] * kWeight[k] * (1 - a) * (1 - a - b);
        q.slope.setZero();
        for (int n = 0; n < 4; ++n) {
          q.shape[n] = l[n] * (2 * l[n] - 1);
          q.slope(n, n) = 4 * l[n] - 1;
        }
        for (int n = 0; n < 6; ++n) {
          const auto [s, t] = kEdges[n];
          q.shape[4 + n] = 4 * l[s] * l[t];
          q.slope(4 + n, s) = 4 * l[t];
          q.slope(4 + n, t) = 4 * l[s];
        }
        all.push_back(q);
      }
    }
  }
  return all;
}

struct Errors {
  double l2 = 0.0, h1 = 0.0;  // of the places, of their gradients
};

class Refinement {
public:
  explicit Refinement(int cells) {
    std::vector<double> lines(cells + 1);
    for (int k = 0; k <= cells; ++k) lines[k] = static_cast<double>(k) / cells;
    mesh_ = test::block_mesh(lines, lines, lines);
  }

  Errors solve(const Material& element, const Material& law, double height) const {
    const ElasticEnergy energy(mesh_, {element});
    VectorXd force = test::face_loads(mesh_, [&](const Vector3d&, const Vector3d& at, const Vector3d& normal) {
      return Vector3d(Manufactured(law, height, at).stress * normal);
    });
    std::vector<char> held(mesh_.nodes.size(), 0);
    VectorXd x(force.size());
    for (std::size_t n = 0; n < mesh_.nodes.size(); ++n) {
      held[n] = mesh_.nodes[n].x() < 1e-9;
      x.segment<3>(3 * static_cast<Eigen::Index>(n)) = Manufactured(law, height, mesh_.nodes[n]).place;
    }
    for_each_point([&](const auto& nodes, const QuadraturePoint& q, const auto&, double weight, const Vector3d& at) {
      const Vector3d body = Manufactured(law, height, at).force;
      for (int n = 0; n < 10; ++n) force.segment<3>(3 * nodes[n]) += weight * q.shape[n] * body;
    });
    MinimiserOptions options;
    options.energy_tolerance = 1e-13 * kYoung;
    options.residual_tolerance = 1e-7;
    Minimiser minimiser(mesh_, held);
    const MinimiserResult r = minimiser.minimise(test::Loaded(energy, force), x, options);
    EXPECT_TRUE(r.converged) << r.cause;

    Errors sum;
    for_each_point(
        [&](const auto& nodes, const QuadraturePoint& q, const auto& slope, double weight, const Vector3d& at) {
          const Manufactured exact(law, height, at);
          Vector3d place = -exact.place;
          Matrix3d f = -exact.f;
          for (int n = 0; n < 10; ++n) {
            const Vector3d node = x.segment<3>(3 * nodes[n]);
            place += q.shape[n] * node;
            f += node * slope.row(n);
          }
          sum.l2 += weight * place.squaredNorm();
          sum.h1 += weight * f.squaredNorm();
        });
    return {std::sqrt(sum.l2), std::sqrt(sum.h1)};
  }

private:
  // visit(nodes, point, gradients of the shape functions, weight in m^3, position)
  template <class Visit>
  void for_each_point(Visit&& visit) const {
    static const std::vector<QuadraturePoint> kPoints = quadrature();
    for (const auto& nodes : mesh_.tets) {
      Matrix3d edges;
      for (int k = 0; k < 3; ++k) edges.col(k) = mesh_.nodes[nodes[k + 1]] - mesh_.nodes[nodes[0]];
      Eigen::Matrix<double, 4, 3> barycentric;
      barycentric.bottomRows<3>() = edges.inverse();
      barycentric.row(0) = -barycentric.bottomRows<3>().colwise().sum();
      for (const QuadraturePoint& q : kPoints) {
        Vector3d at = Vector3d::Zero();
        for (int n = 0; n < 10; ++n) at += q.shape[n] * mesh_.nodes[nodes[n]];
        const Eigen::Matrix<double, 10, 3> slope = q.slope * barycentric;
        visit(nodes, q, slope, q.weight * edges.determinant() / 6, at);
      }
    }
  }

  mesh::TetMesh mesh_;
};

struct Order {
  const char* element;
  bool plain;
  double poisson;
  double height;  // m, of the waves: a nearly incompressible law allows less change of volume
  double h1, l2;
};

// For the test's output; otherwise the bytes of the case are printed.
[[maybe_unused]] void PrintTo(const Order& order, std::ostream* out) { *out << order.element; }

class ObservedOrder : public ::testing::TestWithParam<Order> {};

// The row's orders, with 0.15 allowed, between each refinement and the next.
TEST_P(ObservedOrder, OfAManufacturedSolution) {
  const Order& p = GetParam();
  const Material law = Material::neo_hookean(kYoung, p.poisson), element = p.plain ? law.plain() : law;
  std::vector<Errors> errors;
  for (const int cells : {2, 4, 8}) errors.push_back(Refinement(cells).solve(element, law, p.height));
  for (std::size_t k = 1; k < errors.size(); ++k) {
    const double h1 = std::log2(errors[k - 1].h1 / errors[k].h1), l2 = std::log2(errors[k - 1].l2 / errors[k].l2);
    RecordProperty("order_h1_" + std::to_string(k), std::to_string(h1));
    RecordProperty("order_l2_" + std::to_string(k), std::to_string(l2));
    EXPECT_GE(h1, p.h1 - 0.15) << "refinement " << k << ", error " << errors[k].h1;
    EXPECT_GE(l2, p.l2 - 0.15) << "refinement " << k << ", error " << errors[k].l2;
  }
}

INSTANTIATE_TEST_SUITE_P(Elements, ObservedOrder,
                         ::testing::Values(Order{"P2P0", false, 0.3, 0.08, 1, 2},
                                           Order{"P2P0NearlyIncompressible", false, 0.49, 0.02, 1, 2},
                                           Order{"P2", true, 0.3, 0.08, 2, 3}),
                         [](const auto& order) { return std::string(order.param.element); });

}  // namespace
}  // namespace palpate::fem
