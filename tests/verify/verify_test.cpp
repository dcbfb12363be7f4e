// SPDX-License-Identifier: GPL-3.0-or-later
// Statistics, limits and recorded contacts.
#include "precompute/verify/held_out/recorded.hpp"

#include "formats/io/error.hpp"
#include "precompute/verify/held_out/limits.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>
#include <filesystem>
#include <fstream>

namespace palpate::verify {
namespace {

HeldOut contact_with(std::initializer_list<double> errors) {
  HeldOut c;
  c.accepted = true;
  c.depth = 0.004;
  for (const double e : errors) {
    ForcePair f;
    f.deflection = {0, 0, -0.001};
    f.solved = {0, 0, 0.5};
    f.error = e;
    c.forces.push_back(f);
  }
  return c;
}

TEST(Quantile, InterpolatesBetweenOrderStatistics) {
  EXPECT_DOUBLE_EQ(quantile({3, 1, 2}, 0.5), 2.0);
  EXPECT_DOUBLE_EQ(quantile({1, 2}, 0.25), 1.25);
  EXPECT_DOUBLE_EQ(quantile({7}, 0.95), 7.0);
  EXPECT_DOUBLE_EQ(quantile({}, 0.5), 0.0);
}

TEST(Statistics, CountsSharesAndThePlaceOfTheWorst) {
  std::vector<HeldOut> contacts{contact_with({0.005, 0.015}), contact_with({0.04, 0.2}), HeldOut{}};
  contacts[0].forces[1].kind = SampleKind::tangential;
  const VerifyStatistics s = summarise(contacts);
  EXPECT_EQ(s.contacts, 3u);
  EXPECT_EQ(s.refused, 1u);
  EXPECT_EQ(s.normal.count, 3u);
  EXPECT_EQ(s.tangential.count, 1u);
  EXPECT_DOUBLE_EQ(s.normal.median, 0.04);
  EXPECT_DOUBLE_EQ(s.normal.worst, 0.2);
  EXPECT_EQ(s.normal.worst_contact, 1u);
  EXPECT_DOUBLE_EQ(s.normal.worst_depth, 0.001);
  EXPECT_NEAR(s.normal.within_1, 1.0 / 3, 1e-12);
  EXPECT_NEAR(s.normal.within_5, 2.0 / 3, 1e-12);
}

TEST(Statistics, TorquesOfTurnsAreCountedByThemselves) {
  std::vector<HeldOut> contacts{contact_with({0.5, 0.25})};
  contacts[0].forces[1].kind = SampleKind::grasped;
  contacts[0].forces[1].turn = {{0, 0, 0.1}, {0, 0, -1e-3}, {0, 0, -1.3e-3}, 0.3};
  const VerifyStatistics s = summarise(contacts);
  EXPECT_EQ(s.turned.count, 1u);
  EXPECT_EQ(s.turned.worst, 0.3);
  EXPECT_EQ(s.grasped.worst, 0.25);
}

TEST(Statistics, FrictionLimitsAreCountedByThemselves) {
  std::vector<HeldOut> contacts{contact_with({0.1}), contact_with({0.1})};
  contacts[0].limits = {{0.001, 0.3, 0.303, 0.01}};
  contacts[1].limits = {{0.001, 0.3, 0.309, 0.03}, {0.002, 0.4, 0.32, 0.2}};
  const ErrorStatistics s = summarise(contacts).limit;
  EXPECT_EQ(s.count, 3u);
  EXPECT_DOUBLE_EQ(s.median, 0.03);
  EXPECT_EQ(s.worst_contact, 1u);
  EXPECT_DOUBLE_EQ(s.worst_depth, 0.002);
  EXPECT_EQ(summarise({contact_with({0.1})}).limit.count, 0u);
}

TEST(Statistics, AForceThatIsNoNumberIsTheWorst) {
  const VerifyStatistics s = summarise({contact_with({0.01, std::nan(""), 0.02})});
  EXPECT_TRUE(std::isinf(s.normal.worst));
  EXPECT_EQ(s.normal.count, 3u);
}

VerifyStatistics measured(std::size_t solved, std::size_t refused, double normal, double tangential) {
  VerifyStatistics s;
  s.contacts = solved + refused;
  s.accepted = solved;
  s.refused = refused;
  s.normal.count = 12 * solved;
  s.normal.p95 = normal;
  s.tangential.count = tangential > 0 ? 4 * solved : 0;
  s.tangential.p95 = tangential;
  return s;
}

TEST(Limits, NothingIsBrokenWhereNoneIsSet) {
  EXPECT_FALSE(broken_limits(measured(1, 39, 0.9, 0.9), {}));
  EXPECT_FALSE(broken_limits(measured(38, 2, 0.05, 0.2), {.p95 = 0.1, .p95_tangential = 0.3, .refused_share = 0.05}));
}

TEST(Limits, APercentileBeyondItsLimitIsNamed) {
  EXPECT_NE(broken_limits(measured(40, 0, 0.11, 0), {.p95 = 0.1})->find("normal force error is 0.11, required 0.1"),
            std::string::npos);
  const auto tangential = broken_limits(measured(40, 0, 0.11, 0.4), {.p95_tangential = 0.2});
  EXPECT_EQ(*tangential, "95th percentile of the tangential force error is 0.4, required 0.2");
  EXPECT_TRUE(broken_limits(measured(40, 0, HUGE_VAL, 0), {.p95 = 0.1}));
  EXPECT_TRUE(broken_limits(measured(40, 0, std::nan(""), 0), {.p95 = 0.1}));
}

TEST(Limits, WhatWasNotMeasuredMeetsNoLimit) {
  EXPECT_TRUE(broken_limits(measured(40, 0, 0.01, 0), {.p95_tangential = 0.2}));
  EXPECT_TRUE(broken_limits(measured(0, 40, 0, 0), {.p95 = 0.2}));
}

TEST(Limits, RefusedContactsCountWheneverALimitIsSet) {
  EXPECT_FALSE(broken_limits(measured(36, 4, 0.01, 0), {.p95 = 0.1}));
  EXPECT_NE(broken_limits(measured(35, 5, 0.01, 0), {.p95 = 0.1})->find("5 of 40 held-out contacts were refused"),
            std::string::npos);
  EXPECT_FALSE(broken_limits(measured(35, 5, 0.01, 0), {.p95 = 0.1, .refused_share = 0.2}));
  EXPECT_TRUE(broken_limits(measured(39, 1, 0.01, 0), {.refused_share = 0.0}));
}

TEST(Recorded, RoundTripAndFaults) {
  const auto folder = std::filesystem::temp_directory_path() / "palpate-recorded-test";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  std::vector<HeldOut> contacts{contact_with({0.1, 0.2, 0.3})};
  contacts[0].frame.origin = {0.1, 0.2, 0.3};
  contacts[0].tool_weights = {0.25, 0.75, 0};
  contacts[0].forces[1].kind = SampleKind::tangential;
  contacts[0].forces[2].kind = SampleKind::grasped;
  contacts[0].forces[2].turn = {{0, 0.1, 0.05}, {0, -1e-3, 2e-4}, {0, -1.1e-3, 0}, 0.2};
  contacts[0].limits = {{0.003, 0.35, 0.3, 0.14}};
  nlohmann::ordered_json report;
  report["held_out"] = to_json(contacts);
  std::ofstream(folder / "good.json") << report.dump();
  const std::vector<HeldOut> back = read_recorded(folder / "good.json");
  ASSERT_EQ(back.size(), 1u);
  EXPECT_EQ(back[0].frame.origin, contacts[0].frame.origin);
  EXPECT_EQ(back[0].tool_weights, contacts[0].tool_weights);
  ASSERT_EQ(back[0].forces.size(), 3u);
  EXPECT_EQ(back[0].forces[1].kind, SampleKind::tangential);
  EXPECT_EQ(back[0].forces[0].solved, contacts[0].forces[0].solved);
  EXPECT_FALSE(back[0].forces[1].turn);
  ASSERT_TRUE(back[0].forces[2].turn);
  EXPECT_EQ(back[0].forces[2].turn->rotation, contacts[0].forces[2].turn->rotation);
  EXPECT_EQ(back[0].forces[2].turn->solved, contacts[0].forces[2].turn->solved);
  ASSERT_EQ(back[0].limits.size(), 1u);
  EXPECT_EQ(back[0].limits[0].depth, 0.003);
  EXPECT_EQ(back[0].limits[0].solved, 0.35);

  const auto code = [&](const char* name, const std::string& text) {
    std::ofstream(folder / name) << text;
    try {
      read_recorded(folder / name);
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find(name), std::string::npos);
      return e.code();
    }
    return ExitCode::done;
  };
  EXPECT_EQ(code("empty.json", ""), ExitCode::bad_input);
  EXPECT_EQ(code("none.json", "{\"held_out\": []}"), ExitCode::bad_input);
  EXPECT_EQ(code("garbage.json", "\x01\x02\x03"), ExitCode::bad_input);
  EXPECT_EQ(code("cut.json", report.dump().substr(0, 200)), ExitCode::bad_input);
  const auto refusal = [&](const std::filesystem::path& file) -> std::pair<ExitCode, std::string> {
    try {
      read_recorded(file);
    } catch (const Error& e) {
      return {e.code(), e.what()};
    }
    return {ExitCode::done, ""};
  };
  EXPECT_EQ(refusal(folder / "missing.json").first, ExitCode::io);
  EXPECT_EQ(refusal(folder).first, ExitCode::io);
  // Nobody writes to it: it is refused, not waited for.
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(refusal(folder / "pipe").first, ExitCode::io);
  EXPECT_NE(refusal(folder / "garbage.json").second.find("garbage.json: not JSON"), std::string::npos);
  nlohmann::ordered_json wrong = report;
  wrong["held_out"][0]["forces"][2]["kind"] = "normal";
  EXPECT_EQ(code("turned_push.json", wrong.dump()), ExitCode::bad_input);
  wrong = report;
  wrong["held_out"][0]["forces"][2]["rotation_rad"] = {0, 4, 0};
  EXPECT_EQ(code("turned_too_far.json", wrong.dump()), ExitCode::bad_input);
  EXPECT_EQ(code("list.json", "[1]"), ExitCode::bad_input);
  EXPECT_EQ(code("number.json", "{\"held_out\": 3}"), ExitCode::bad_input);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace palpate::verify
