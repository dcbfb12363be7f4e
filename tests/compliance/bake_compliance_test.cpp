// SPDX-License-Identifier: GPL-3.0-or-later
// The compliance between sites of a block, against direct linear solves and the half-space.
#include "precompute/compliance/bake_compliance.hpp"

#include "formats/io/error.hpp"
#include "palpate/format/half_space.hpp"
#include "precompute/compliance/rest_modes.hpp"
#include "tests/support/bodies.hpp"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <cmath>

namespace palpate::compliance {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

constexpr double kBlock = 0.03, kSpacing = 0.006;
constexpr int kSide = 5;

// side x side sites on a grid in the middle of the block's top face.
ComplianceSites grid(int side = kSide, double spacing = kSpacing) {
  ComplianceSites sites;
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      sites.places.push_back({{spacing * (i - side / 2), spacing * (j - side / 2), 0}, {0, 0, 1}});
      sites.touchable.push_back(1);
      if (i == 0 || j == 0) continue;
      const int at = side * i + j;
      sites.triangles.push_back({at - side - 1, at - 1, at});
      sites.triangles.push_back({at - side - 1, at, at - side});
    }
  }
  return sites;
}

Matrix3d evaluate(const ResponseCompliance& c, const ComplianceSites& sites, std::size_t to, std::size_t from) {
  const auto point = [&](std::size_t s) {
    const LoadSite& site = sites.places[s];
    return half_space::Point{{site.point.x(), site.point.y(), site.point.z()},
                             {site.normal.x(), site.normal.y(), site.normal.z()},
                             c.shear[s]};
  };
  double closed[9];
  half_space::compliance(point(from), point(to), c.poisson, c.rounding, closed);
  Matrix3d sum = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(closed);
  for (std::uint32_t m = 0; m < c.modes; ++m) {
    const Eigen::Map<const Vector3d> u(c.values.data() + 3 * (c.modes * to + m)),
        v(c.values.data() + 3 * (c.modes * from + m));
    sum += (m < c.modes - c.negative ? 1 : -1) * u * v.transpose();
  }
  return sum;
}

double norm_of(const Matrix3d& m) { return m.jacobiSvd().singularValues()[0]; }

TEST(LinearBody, ComplianceIsSymmetricAndThatOfAHalfSpaceNearby) {
  const double nu = 0.3, young = 5e3;
  const Body body = test::block_body(kBlock, young, nu);
  const ComplianceSites sites = grid();
  const LinearBody linear(body, sites.places, {0.5 * kSpacing, 0.002, {}});
  const std::size_t a = kSide * (kSide / 2) + kSide / 2, b = a + kSide, c = a + 2 * kSide;
  const MatrixXd at_a = linear.columns({a}), at_b = linear.columns({b});
  const Matrix3d ba = at_a.block<3, 3>(3 * Eigen::Index(b), 0), ab = at_b.block<3, 3>(3 * Eigen::Index(a), 0);
  EXPECT_LT((ba - ab.transpose()).norm(), 1e-9 * ba.norm());

  // The block's bottom and sides add what is smooth. The terms between the normal and the way across it change sign
  // with the direction of the force, as in a half-space.
  const auto half = [&](std::size_t to) {
    double closed[9];
    const auto point = [&](std::size_t s) {
      const Vector3d& p = sites.places[s].point;
      return half_space::Point{{p.x(), p.y(), 0}, {0, 0, 1}, young / (2 * (1 + nu))};
    };
    half_space::compliance(point(a), point(to), nu, 1e-9, closed);
    return Matrix3d(Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(closed));
  };
  const Matrix3d near = half(b) - half(c), solved = ba - at_a.block<3, 3>(3 * Eigen::Index(c), 0);
  EXPECT_NEAR((solved(0, 2) - solved(2, 0)) / (near(0, 2) - near(2, 0)), 1, 0.15);
  // Discs of 4.5 mm that are 6 mm apart: 0.2 (4.5 / 6)^2 = 11 % more than between two points; the rest is the block's.
  EXPECT_NEAR(solved(2, 2) / near(2, 2), 1.25, 0.2);
}

TEST(BakeCompliance, CarriesTheColumnsOfTheBlockWithinItsTolerance) {
  const Body body = test::block_body(kBlock, 5e3, 0.49);
  const ComplianceSites sites = grid();
  ComplianceOptions options;
  options.contact_radius = 0.002;
  const BakedCompliance baked = bake_compliance(body, sites, options);
  EXPECT_TRUE(baked.report.reached);
  EXPECT_LE(baked.report.chosen.p95, options.tolerance);
  const LinearBody linear(body, sites.places, {0.5 * kSpacing, options.contact_radius, {}});
  for (const std::size_t site : {std::size_t{0}, std::size_t{12}, std::size_t{22}}) {
    const MatrixXd column = linear.columns({site});
    for (std::size_t s = 0; s < sites.places.size(); ++s) {
      const double apart = (sites.places[s].point - sites.places[site].point).norm();
      if (apart < 2 * linear.load_radius()) continue;  // nearer, the discs of load and reading matter
      const Matrix3d solved = column.block<3, 3>(3 * Eigen::Index(s), 0);
      EXPECT_LT(norm_of(solved - evaluate(baked.file, sites, s, site)), 2 * options.tolerance * baked.report.self);
    }
  }
}

// A tolerance that 128 modes cannot meet does not solve every site.
TEST(BakeCompliance, EndsWhereMoreColumnsDoNotHelp) {
  ComplianceOptions options;
  options.contact_radius = 0.009;
  options.tolerance = 1e-9;
  const ComplianceSites sites = grid(16, 0.003);
  const BakedCompliance baked = bake_compliance(test::block_body(kBlock, 5e3, 0.49), sites, options);
  EXPECT_FALSE(baked.report.reached);
  EXPECT_EQ(baked.report.chosen.modes, 128);
  EXPECT_LT(baked.report.columns, sites.places.size());
}

TEST(BakeCompliance, OptionsOutOfRangeAreRefusedByName) {
  const Body body = test::block_body(kBlock, 5e3, 0.49);
  ComplianceOptions options;
  EXPECT_THROW(bake_compliance(body, grid(), options), Error);
  options.contact_radius = 0.002;
  options.modes = 12;
  EXPECT_THROW(bake_compliance(body, grid(), options), Error);
}

TEST(RestModes, RecoverAMatrixOfLowRankWithBothSigns) {
  constexpr Eigen::Index kSize = 60, kRank = 8, kKnown = 18;
  MatrixXd u(kSize, kRank);
  for (Eigen::Index i = 0; i < kSize; ++i) {
    for (Eigen::Index k = 0; k < kRank; ++k) u(i, k) = std::cos(0.1 * double(i * (k + 1)) + double(k));
  }
  Eigen::VectorXd signs = Eigen::VectorXd::Ones(kRank);
  signs.tail(3).setConstant(-1);
  const MatrixXd r = u * signs.asDiagonal() * u.transpose();
  std::vector<Eigen::Index> known, all;
  for (Eigen::Index k = 0; k < kKnown; ++k) known.push_back(3 * k);
  for (Eigen::Index k = 0; k < kSize; ++k) all.push_back(k);
  MatrixXd values(kSize, kKnown);
  for (Eigen::Index k = 0; k < kKnown; ++k) values.col(k) = r.col(known[std::size_t(k)]);
  const SignedModes modes = rest_modes(values, known, kRank);
  EXPECT_EQ(modes.negative, 3);
  EXPECT_LT((modes.columns(all) - r).norm(), 1e-9 * r.norm());
}

}  // namespace
}  // namespace palpate::compliance
