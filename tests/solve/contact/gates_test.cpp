// SPDX-License-Identifier: GPL-3.0-or-later
// Every gate refuses the state that it is there for, and names itself; a good state passes them all.
#include "precompute/solve/contact/gates.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace palpate::solve {
namespace {

// 2 mm deep in 5 kPa tissue with a contact of 3 mm: figures of a valid push.
GateState good() {
  GateState s;
  s.depth = 0.002;
  s.contact_radius = 0.003;
  s.force = 0.02;
  s.previous_force = 0.015;
  s.work = 1.6e-5;
  s.stored = 1.58e-5;
  s.energy_scale = 4e-5;
  s.min_jacobian = 0.6;
  s.contact.penetration = 2e-5;
  s.contact.points = 80;
  return s;
}

struct Fault {
  const char* gate;  // what the cause begins with
  std::function<void(GateState&)> make;
  bool tangential;  // the tangential gates see it too
};

// For the test's name and output; otherwise the bytes of the case are printed.
[[maybe_unused]] void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.gate; }

class Gates : public ::testing::TestWithParam<Fault> {};

// Only a contact that is bonded may pull; it too must answer against the move, and its energy must be accounted for.
TEST(Gates, APullIsRightWhereTheContactIsGrasped) {
  GateState pull = good();
  pull.force = -0.02;
  EXPECT_TRUE(failed_gate(pull, GateLimits{}));
  EXPECT_FALSE(failed_grasp_gate(pull, -0.001, GateLimits{}));
  EXPECT_TRUE(failed_grasp_gate(pull, 0.001, GateLimits{}));
  GateState loose = pull, torn = pull;
  loose.contact.bond_give = {0, 0, 1e-4};
  torn.contact.bond_gap = 1e-3;
  EXPECT_EQ(failed_grasp_gate(loose, -0.001, GateLimits{})->rfind("give of the bond", 0), 0U);
  EXPECT_EQ(failed_grasp_gate(torn, -0.001, GateLimits{})->rfind("gap of the bond", 0), 0U);
  pull.stored = 0.5 * pull.work;
  EXPECT_EQ(failed_grasp_gate(pull, -0.001, GateLimits{})->rfind("energy balance", 0), 0U);
}

TEST(Gates, AGoodStatePasses) {
  EXPECT_EQ(failed_gate(good(), {}), std::nullopt);
  EXPECT_EQ(failed_tangential_gate(good(), -0.01, {}), std::nullopt);
  EXPECT_EQ(failed_sticking_gate(good(), -0.01, {}), std::nullopt);
}

TEST_P(Gates, RefusesAndNamesItself) {
  GateState s = good();
  GetParam().make(s);
  const auto normal = failed_gate(s, {});
  ASSERT_TRUE(normal.has_value());
  EXPECT_EQ(normal->rfind(GetParam().gate, 0), 0U) << *normal;
  const auto tangential = failed_tangential_gate(s, -0.01, {});
  EXPECT_EQ(tangential.has_value(), GetParam().tangential);
}

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

INSTANTIATE_TEST_SUITE_P(
    Each, Gates,
    ::testing::Values(Fault{"finite", [](GateState& s) { s.force = kNan; }, true},
                      Fault{"finite", [](GateState& s) { s.stored = kNan; }, true},
                      Fault{"minimum Jacobian", [](GateState& s) { s.min_jacobian = -0.01; }, true},
                      Fault{"minimum Jacobian", [](GateState& s) { s.min_jacobian = kNan; }, true},
                      Fault{"penetration", [](GateState& s) { s.contact.penetration = 1e-4; }, true},
                      Fault{"support", [](GateState& s) { s.contact.held_overlap = 1e-4; }, true},
                      Fault{"force sign", [](GateState& s) { s.force = -0.001; }, true},
                      Fault{"force growth", [](GateState& s) { s.previous_force = 0.03; }, false},
                      Fault{"energy balance", [](GateState& s) { s.stored = 1.2e-5; }, false},
                      Fault{"energy balance", [](GateState& s) { s.stored = 2.1e-5; }, false}));

TEST(TangentialGates, AnAnswerTooSmallForASignPasses) {
  const double small = 0.9 * GateLimits{}.tangential_response * good().force;
  EXPECT_EQ(failed_tangential_gate(good(), small, {}), std::nullopt);
  EXPECT_EQ(failed_sticking_gate(good(), small, {}), std::nullopt);
  EXPECT_TRUE(failed_tangential_gate(good(), 1.2 * small, {}).has_value());
}

TEST(TangentialGates, AnAnswerAlongThePushAndAPeeledContactAreRefused) {
  EXPECT_EQ(failed_tangential_gate(good(), 0.001, {})->rfind("tangential response", 0), 0U);
  EXPECT_TRUE(failed_tangential_gate(good(), kNan, {}).has_value());
  GateState peeled = good();
  peeled.contact.points = 5;
  EXPECT_EQ(failed_tangential_gate(peeled, -0.01, {})->rfind("contact resolution", 0), 0U);
}

// A thin lobe that snaps to another state while it is pushed aside answers with a smaller force and less energy; the
// tool may also be given work back.
TEST(TangentialGates, AStuckContactThatJumpsToAnotherStateIsRefused) {
  for (const double way : {1.0, -1.0}) {
    GateState stuck = good(), jumped = good();
    stuck.work = jumped.work = way * good().work;
    stuck.stored = stuck.work - 0.3e-6;
    jumped.stored = jumped.work - 3e-6;
    EXPECT_EQ(failed_sticking_gate(stuck, -0.01, {}), std::nullopt);
    const auto failed = failed_sticking_gate(jumped, -0.01, {});
    ASSERT_TRUE(failed.has_value());
    EXPECT_EQ(failed->rfind("energy balance", 0), 0U) << *failed;
  }
  EXPECT_EQ(failed_sticking_gate(good(), 0.001, {})->rfind("tangential response", 0), 0U);
}

TEST(CheckGate, AForceFarFromThatOfTheFinerMeshIsRefused) {
  PairCheck check;
  check.compared = 6;
  check.difference = 0.03;
  EXPECT_EQ(failed_check(check, {}), std::nullopt);
  for (const double far : {0.2, kNan}) {
    check.difference = far;
    const auto failed = failed_check(check, {});
    ASSERT_TRUE(failed.has_value());
    EXPECT_EQ(failed->rfind("finer mesh", 0), 0U) << *failed;
  }
  check.compared = 0;  // nothing to compare
  EXPECT_EQ(failed_check(check, {}), std::nullopt);
}

}  // namespace
}  // namespace palpate::solve
