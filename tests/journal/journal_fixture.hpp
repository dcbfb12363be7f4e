// SPDX-License-Identifier: GPL-3.0-or-later
// Samples, outcomes and a temporary journal for the journal's tests.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <string>

#include "formats/io/error.hpp"
#include "formats/journal/journal.hpp"

namespace palpate::test {

inline Sample make_sample(unsigned pair, unsigned index, SampleKind kind = SampleKind::normal) {
  Sample sample;
  sample.kind = kind;
  sample.index = static_cast<std::uint16_t>(index);
  sample.deflection = {0.1 * pair, -0.2 * index, 1e-3 * (index + 1)};
  sample.force = {1.0 / (pair + 3.0), 1.0 / 7.0, 0.3 * index};
  sample.friction_limit = 0.25 + pair;
  sample.contact_area = 1e-5;
  sample.penetration = 1e-7;
  sample.min_jacobian = 0.6;
  sample.error_estimate = 0.01;
  sample.contact_points = 40 + index;
  sample.iterations = 17;
  if (kind == SampleKind::grasped) {
    sample.rotation = {0.01, -0.02, 0.03 * index};
    sample.torque = {1e-5, 2e-5 * pair, -3e-5};
  }
  return sample;
}

inline PairOutcome make_outcome(bool accepted, std::string cause = {}) {
  PairOutcome outcome;
  outcome.accepted = accepted;
  outcome.cause = std::move(cause);
  outcome.first_touch = 1.25e-5;
  outcome.nodes = 1251;
  outcome.normal_solves = 12;
  outcome.tangential_solves = 24;
  outcome.factorisations = 8;
  return outcome;
}

inline PairCheck make_check(std::string cause = {}) {
  PairCheck check;
  check.nodes = 5123;
  check.compared = cause.empty() ? 12 : 0;
  check.within_estimate = cause.empty() ? 11 : 0;
  check.difference = cause.empty() ? 0.013 : 0.0;
  check.cause = std::move(cause);
  return check;
}

class JournalFiles : public testing::Test {
protected:
  void SetUp() override {
    folder_ =
        std::filesystem::path(testing::TempDir()) / ("palpate_journal_" + std::to_string(::getpid()) + "_" +
                                                     testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    file_ = folder_ / "samples.journal";
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string bytes() const {
    std::ifstream in(file_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void write_bytes(const std::string& content) const {
    std::ofstream(file_, std::ios::binary | std::ios::trunc).write(content.data(), std::ssize(content));
  }
  /// The error of opening for reading; done when there is none.
  [[nodiscard]] std::pair<ExitCode, std::string> read_error(const Hash128& manifest) const {
    try {
      read_journal(file_, manifest);
    } catch (const Error& error) {
      return {error.code(), error.what()};
    }
    return {ExitCode::done, {}};
  }

  std::filesystem::path folder_, file_;
  Hash128 manifest_ = hash128("manifest");
};

}  // namespace palpate::test
