// SPDX-License-Identifier: GPL-3.0-or-later
// Elastic energy of a quadratic tetrahedral mesh: ten-node tetrahedra with one mean dilatation each (P2/P0).
#pragma once

#include "precompute/fem/element_batch.hpp"
#include "precompute/fem/materials/material.hpp"
#include "precompute/fem/matrix/block_matrix.hpp"
#include "precompute/mesh/tet_mesh.hpp"

#include <Eigen/Core>
#include <array>
#include <vector>

namespace palpate::fem {

/// Which second derivative: exact, or without the indefinite geometric part of the volume term and with the positive
/// part of the laws' tangents (then it is positive definite whatever the state).
enum class HessianKind { exact, convex };

/// Errors of an energy and its derivative by rounding.
struct Rounding {
  double energy = 0.0;  ///< J
  double force = 0.0;   ///< N, norm of the derivative's error
};

class ElasticEnergy {
public:
  /// `materials[region]`. The mesh's nodes are the stress-free state. Elements that reach from one side of a thin body
  /// to the other have twice the shear modulus on top of their material's `local`, at most its bulk modulus.
  ElasticEnergy(const mesh::TetMesh& mesh, std::vector<Material> materials);
  ElasticEnergy(const ElasticEnergy&) = delete;
  ElasticEnergy& operator=(const ElasticEnergy&) = delete;

  /// Energy (J) at the node positions x (3 N, m).
  [[nodiscard]] double value(const Eigen::VectorXd& x) const;
  /// Energy (J); adds its derivative (N) to `gradient` (3 N).
  double gradient(const Eigen::VectorXd& x, Eigen::VectorXd& gradient) const;
  /// Adds the second derivative (N/m).
  void hessian(const Eigen::VectorXd& x, HessianKind kind, BlockMatrix& matrix) const;
  /// The rounding of value() and gradient() near rest: strains are off by the last bits of positions over the element's
  /// height, and energies with laws are differences of terms of their shear modulus besides.
  [[nodiscard]] const Rounding& rounding() const { return rounding_; }
  /// Smallest det F over all quadrature points.
  [[nodiscard]] double min_jacobian(const Eigen::VectorXd& x) const;

private:
  using Shape = Eigen::Matrix<double, 10, 3>;
  struct Element {
    std::array<std::int32_t, 10> nodes;
    Eigen::Matrix<double, 4, 3> slopes;  // gradients of the barycentric coordinates, 1/m
    double volume = 0.0;                 // m^3
    double local = 0.0;                  // Pa, see Material
    std::int32_t material = 0;
  };
  static void set_lane(const Element& e, const Material& material, int lane, ElementBatch& batch);
  void make_batches();
  [[nodiscard]] static Shape shape_gradients(const Element& e, int point);

  std::vector<Material> materials_;  // of the regions, then of elements whose fibres have a direction of their own
  std::vector<Element> elements_;
  std::vector<ElementBatch> batches_;  // of the same elements
  Rounding rounding_;
};

}  // namespace palpate::fem
