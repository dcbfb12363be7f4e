// SPDX-License-Identifier: GPL-3.0-or-later
// The quadratic response law against the specification's formulas and finite differences of its energy.
#include "palpate/response/response_law.hpp"

#include <algorithm>
#include <cmath>

#include "tests/runtime/response/plain_response.hpp"

namespace palpate::response_law_test {
namespace {

using namespace test;
using response::Degrees;
using runtime::ResponseAtDepth;
using runtime::ResponseLaw;
using runtime::Vec2;

const Degrees kKinds[] = {{5, 4, 3, 2, true}, {5, 0, 3, 2, true}, {6, 6, 6, 6, true}, {2, 2, 2, 0, true},
                          response::kSpring,  {5, 0, 0, 0, false}, {4, 3, 0, 0, false}};

/// One response of random coefficients that meet the file's rules, and its law.
struct Sample {
  Sample(const Degrees& d, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> draw(0, 1);
    content.degrees = d;
    content.depth_scale = kDepthScale;
    content.tangential_scale = d.friction_families ? kTangentialScale : 0;
    response.unit = 1e-4f;
    const response::Offsets o = response::offsets(d);
    std::vector<double> c(static_cast<std::size_t>(o.end));
    double force = 0;
    for (int k = 0; k < o.bias; ++k) c[static_cast<std::size_t>(k)] = force += 5000 * draw(random);
    for (int k = o.bias; k < o.stiffness; ++k) c[static_cast<std::size_t>(k)] = 1000 * (draw(random) - 0.5);
    for (int k = o.stiffness; k < o.coupling; k += 3) {
      c[static_cast<std::size_t>(k)] = 4000 * (1 + draw(random));
      c[static_cast<std::size_t>(k) + 1] = 1000 * (draw(random) - 0.5);
      c[static_cast<std::size_t>(k) + 2] = 1000 * (draw(random) - 0.5);
    }
    for (int k = o.coupling; k < o.friction; ++k) c[static_cast<std::size_t>(k)] = 2000 * (draw(random) - 0.5);
    for (int k = o.friction; k < o.end; ++k) c[static_cast<std::size_t>(k)] = 0.5 * draw(random) / layout::kFrictionUnit;
    std::vector<double> newtons;
    for (int k = 0; k < o.end; ++k) {
      const double whole = std::round(c[static_cast<std::size_t>(k)]);
      response.coefficients.push_back(static_cast<std::int16_t>(whole));
      newtons.push_back((k < o.friction ? double{response.unit} : layout::kFrictionUnit) * whole);
    }
    law.set(d, newtons.data(), content.depth_scale, content.tangential_scale);
  }
  ResponseFileContent content;
  Response response;
  ResponseLaw law;
};

constexpr double kDepths[] = {1e-7, 3e-5, 4e-4, 0.0021, 0.00499, 0.00501, 0.0083};  // m

TEST(ResponseLaw, TermsAreThoseOfTheSpecification) {
  for (const Degrees& d : kKinds) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
      const Sample sample(d, seed);
      const PlainResponse plain(sample.content, sample.response);
      for (const double z : kDepths) {
        const ResponseAtDepth r = sample.law.at(z);
        const PlainResponse::At p = plain.at(z);
        EXPECT_NEAR(r.normal_force, p.force, 1e-12 * (1 + p.force)) << z;
        EXPECT_NEAR(r.bias.x, p.bias[0], 1e-12);
        EXPECT_NEAR(r.bias.y, p.bias[1], 1e-12);
        EXPECT_NEAR(r.friction_coefficient, p.friction, 1e-12);
        for (const Vec2& e : {Vec2{3e-4, -1e-4}, Vec2{-0.001, 0.002}}) {
          const Vec3 f = plain.force(z, e.x, e.y);
          const Vec2 push = r.bias + r.stiffness * e;
          const double normal = r.normal_force + dot(r.bias_slope, e) + 0.5 * quadratic(r.normal_coupling, e);
          EXPECT_NEAR(-push.x, f.x, 1e-11) << z;
          EXPECT_NEAR(-push.y, f.y, 1e-11) << z;
          EXPECT_NEAR(normal, f.z, 1e-9) << z;
        }
      }
    }
  }
}

// Except for the coupling A, which the file has for itself, the law is the gradient of its energy.
TEST(ResponseLaw, SlopesAndWorkAreThoseOfFiniteDifferences) {
  for (const Degrees& d : kKinds) {
    const Sample sample(d, 11);
    for (const double z : kDepths) {
      const double h = 1e-5 * z;
      const ResponseAtDepth low = sample.law.at(z - h), high = sample.law.at(z + h), r = sample.law.at(z);
      EXPECT_NEAR(r.normal_slope, (high.normal_force - low.normal_force) / (2 * h), 1e-5 * (1 + r.normal_slope)) << z;
      EXPECT_NEAR(r.normal_force, (high.work - low.work) / (2 * h), 1e-5 * (1e-6 + r.normal_force)) << z;
      EXPECT_NEAR(r.bias_slope.x, (high.bias.x - low.bias.x) / (2 * h), 1e-4 * (1 + std::fabs(r.bias_slope.x))) << z;
      EXPECT_NEAR(r.bias_slope.y, (high.bias.y - low.bias.y) / (2 * h), 1e-4 * (1 + std::fabs(r.bias_slope.y))) << z;
    }
  }
}

TEST(ResponseLaw, WorkIsTheIntegralOfTheForce) {
  const Sample sample(kKinds[0], 12);
  double work = 0;
  constexpr int kSteps = 20000;
  const double h = 1.5 * kDepthScale / kSteps;
  for (int k = 0; k < kSteps; ++k) {
    work += h * sample.law.normal((k + 0.5) * h).normal_force;
    if (k % 1000 != 999) continue;
    ASSERT_NEAR(sample.law.normal((k + 1) * h).work, work, 1e-6 * work) << k;
  }
}

TEST(ResponseLaw, NothingJumpsAtTheDepthScale) {
  for (const Degrees& d : kKinds) {
    const Sample sample(d, 13);
    const ResponseAtDepth low = sample.law.at(kDepthScale * (1 - 1e-9)), high = sample.law.at(kDepthScale * (1 + 1e-9));
    EXPECT_NEAR(low.normal_force, high.normal_force, 1e-6);
    EXPECT_NEAR(low.work, high.work, 1e-9);
    EXPECT_NEAR(low.bias.x, high.bias.x, 1e-6);
    EXPECT_NEAR(low.stiffness.m, high.stiffness.m, 1e-3);
    EXPECT_NEAR(low.normal_slope, high.normal_slope, 1e-3 * (1 + low.normal_slope));
    EXPECT_NEAR(low.normal_coupling.m, high.normal_coupling.m, 1e-3 * (1 + std::fabs(low.normal_coupling.m)));
  }
}

TEST(ResponseLaw, ForceVanishesAtTheSurface) {
  for (const Degrees& d : kKinds) {
    const Sample sample(d, 14);
    const ResponseAtDepth r = sample.law.at(1e-12);
    EXPECT_LT(r.normal_force, 1e-8);
    EXPECT_LT(length(r.bias), 1e-8);
    EXPECT_LT(r.stiffness.m, 0.1);
  }
}

// -dK/dz <= A <= dK/dz at every depth: what the file's rule on coefficients is for.
TEST(ResponseLaw, CouplingStaysWithinTheSlopeOfTheStiffness) {
  for (const Degrees& d : kKinds) {
    if (d.stiffness == 0) continue;
    const Sample sample(d, 15);
    for (double z = 1e-4; z < kDepthScale; z += 1e-4) {
      const double h = 1e-6 * z;
      const runtime::Sym2 slope = (1 / (2 * h)) * (sample.law.at(z + h).stiffness - sample.law.at(z - h).stiffness);
      const runtime::Sym2 coupling = sample.law.at(z).normal_coupling;
      for (const double sign : {1.0, -1.0}) {
        const runtime::Sym2 sum = slope + sign * coupling;
        ASSERT_GE(sum.m - std::hypot(sum.x, sum.y), -1e-4 * slope.m) << z;
      }
    }
  }
}

TEST(ResponseLaw, StiffnessAtAnAbscissaIsThatAtItsDepth) {
  const Sample sample(kKinds[0], 16);
  for (const double s : {0.0, 0.1, 0.5, 1.0}) {
    const runtime::Sym2 k = sample.law.stiffness_at(s);
    if (s == 0) {
      EXPECT_EQ(k.m, 0);
    } else {
      EXPECT_NEAR(k.m, sample.law.at(s * s * kDepthScale).stiffness.m, 1e-9);
    }
  }
}

}  // namespace
}  // namespace palpate::response_law_test
