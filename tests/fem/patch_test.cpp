// SPDX-License-Identifier: GPL-3.0-or-later
// The patch test, solved: nodes of the boundary held where a constant F has them, the others left to find their places.
#include "precompute/fem/materials/scene_material.hpp"
#include "precompute/fem/minimiser.hpp"

#include "tests/fem/deformed_block.hpp"
#include "tests/support/laws.hpp"
#include "tests/support/loaded.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <tuple>
#include <vector>

namespace palpate::fem {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using test::LawChoice;

enum class Element { usual, plain };

class SolvedPatch : public ::testing::TestWithParam<std::tuple<LawChoice, Element>> {
protected:
  SolvedPatch() {
    f << 1.3, 0.2, -0.1, 0.05, 0.8, 0.1, 0.2, -0.15, 0.95;
    const auto [law, element] = GetParam();
    material = make_material(test::law_scene(law, test::usual_poisson(law)));
    if (element == Element::plain) material = material.plain();
    material.stress(f, stress);
    stress += material.volumetric_slope(f.determinant()) * f.determinant() * f.inverse().transpose();
  }

  // Inner nodes start up to 30 mm of the block's metre from where they belong.
  VectorXd start(const mesh::TetMesh& mesh, const std::vector<char>& held) const {
    const VectorXd wanted = test::mapped(mesh, f);
    std::mt19937 engine(8);
    VectorXd x = test::shaken(wanted, 0.03, engine);
    for (std::size_t n = 0; n < held.size(); ++n) {
      const auto k = 3 * static_cast<Eigen::Index>(n);
      if (held[n]) x.segment<3>(k) = wanted.segment<3>(k);
    }
    return x;
  }

  void solve(const mesh::TetMesh& mesh) const {
    std::vector<char> held(mesh.nodes.size(), 0);
    for (const auto& face : mesh.faces) {
      for (const std::int32_t n : face) held[n] = 1;
    }
    const VectorXd wanted = test::mapped(mesh, f);
    const VectorXd reactions = test::face_loads(
        mesh, [&](const Vector3d&, const Vector3d&, const Vector3d& normal) { return Vector3d(stress * normal); });
    const ElasticEnergy energy(mesh, {material});
    VectorXd x = start(mesh, held);
    ASSERT_GT((x - wanted).cwiseAbs().maxCoeff(), 0.029);
    MinimiserOptions options;
    options.energy_tolerance = 1e-20;
    options.max_iterations = 200;
    options.residual_tolerance = 1e-12 * reactions.norm();
    const MinimiserResult r = Minimiser(mesh, held).minimise(test::Alone(energy), x, options);
    ASSERT_TRUE(r.converged) << r.cause;
    EXPECT_LT((x - wanted).cwiseAbs().maxCoeff(), 1e-12);

    // Forces of every node: those of the constant stress on the boundary, none inside.
    VectorXd forces = VectorXd::Zero(x.size());
    energy.gradient(x, forces);
    EXPECT_LT((forces - reactions).cwiseAbs().maxCoeff(), 1e-10 * reactions.cwiseAbs().maxCoeff());
    double worst = 0;
    for (const auto& tet : mesh.tets) worst = std::max(worst, (mean_stress(mesh, tet, x) - stress).norm());
    EXPECT_LT(worst, 1e-10 * stress.norm());
  }

  // Mean stress of one element (Pa): the moment of its nodal forces about the origin over its volume.
  Matrix3d mean_stress(const mesh::TetMesh& mesh, const std::array<std::int32_t, 10>& tet, const VectorXd& x) const {
    mesh::TetMesh one;
    one.nodes = mesh.nodes;
    one.tets = {tet};
    VectorXd forces = VectorXd::Zero(x.size());
    ElasticEnergy(one, {material}).gradient(x, forces);
    Matrix3d moment = Matrix3d::Zero();
    for (const std::int32_t n : tet) moment += forces.segment<3>(3 * n) * mesh.nodes[n].transpose();
    const Vector3d &a = mesh.nodes[tet[0]], &b = mesh.nodes[tet[1]], &c = mesh.nodes[tet[2]], &d = mesh.nodes[tet[3]];
    return moment / ((b - a).cross(c - a).dot(d - a) / 6);
  }

  Matrix3d f, stress;
  Material material;
};

TEST_P(SolvedPatch, InnerNodesOfADistortedBlockFindTheirPlaces) {
  const std::vector<double> lines{0, 0.2, 0.5, 0.75, 1};
  solve(test::distorted_block(lines, lines, lines, 0.05));
}

// Every element of a layer reaches from side to side: with the stiffness that this adds, a constant stress stays one.
TEST_P(SolvedPatch, NodesInsideALayerFindTheirPlaces) {
  const std::vector<double> lines{0, 0.2, 0.5, 0.75, 1};
  const mesh::TetMesh layer = test::distorted_block(lines, lines, {0, 0.3}, 0.05);
  solve(layer);
  mesh::TetMesh sideless = layer;
  sideless.faces.clear();
  std::mt19937 engine(8);
  const VectorXd x = test::shaken(test::mapped(layer, f), 0.03, engine);
  const double spanning = ElasticEnergy(layer, {material}).value(x) - ElasticEnergy(sideless, {material}).value(x);
  if (material.bulk > 0) {
    EXPECT_GT(spanning, 1.0);
  } else {
    EXPECT_EQ(spanning, 0.0);
  }
}

INSTANTIATE_TEST_SUITE_P(Each, SolvedPatch,
                         ::testing::Combine(::testing::ValuesIn(test::kEveryLaw),
                                            ::testing::Values(Element::usual, Element::plain)));

}  // namespace
}  // namespace palpate::fem
