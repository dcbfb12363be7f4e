// SPDX-License-Identifier: GPL-3.0-or-later
// Statistics and recorded contacts.
#include "precompute/verify/recorded.hpp"

#include "formats/error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

namespace palpate {
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
  EXPECT_EQ(s.sideways.count, 1u);
  EXPECT_DOUBLE_EQ(s.normal.median, 0.04);
  EXPECT_DOUBLE_EQ(s.normal.worst, 0.2);
  EXPECT_EQ(s.normal.worst_contact, 1u);
  EXPECT_DOUBLE_EQ(s.normal.worst_depth, 0.001);
  EXPECT_NEAR(s.normal.within_1, 1.0 / 3, 1e-12);
  EXPECT_NEAR(s.normal.within_5, 2.0 / 3, 1e-12);
}

TEST(Statistics, AForceThatIsNoNumberIsTheWorst) {
  const VerifyStatistics s = summarise({contact_with({0.01, std::nan(""), 0.02})});
  EXPECT_TRUE(std::isinf(s.normal.worst));
  EXPECT_EQ(s.normal.count, 3u);
}

TEST(Recorded, RoundTripAndFaults) {
  const auto folder = std::filesystem::temp_directory_path() / "palpate-recorded-test";
  std::filesystem::create_directories(folder);
  std::vector<HeldOut> contacts{contact_with({0.1, 0.2})};
  contacts[0].frame.origin = {0.1, 0.2, 0.3};
  contacts[0].tool_weights = {0.25, 0.75, 0};
  contacts[0].forces[1].kind = SampleKind::tangential;
  nlohmann::ordered_json report;
  report["held_out"] = to_json(contacts);
  std::ofstream(folder / "good.json") << report.dump();
  const std::vector<HeldOut> back = read_recorded(folder / "good.json");
  ASSERT_EQ(back.size(), 1u);
  EXPECT_EQ(back[0].frame.origin, contacts[0].frame.origin);
  EXPECT_EQ(back[0].tool_weights, contacts[0].tool_weights);
  ASSERT_EQ(back[0].forces.size(), 2u);
  EXPECT_EQ(back[0].forces[1].kind, SampleKind::tangential);
  EXPECT_EQ(back[0].forces[0].solved, contacts[0].forces[0].solved);

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
  EXPECT_THROW(read_recorded(folder / "missing.json"), Error);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace palpate
