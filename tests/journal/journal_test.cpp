// SPDX-License-Identifier: GPL-3.0-or-later
// The journal in good health: round trip, order, several threads, one writer, the wrong file.
#include <cmath>
#include <thread>

#include "tests/journal/journal_fixture.hpp"

namespace palpate::test {
namespace {

TEST_F(JournalFiles, RoundTripKeepsEveryBit) {
  {
    Journal journal(file_, manifest_);
    EXPECT_TRUE(journal.content().pairs.empty());
    journal.append(3, make_sample(3, 1));
    journal.append(3, make_sample(3, 0));
    journal.append(3, make_sample(3, 2, SampleKind::slipping));
    journal.append(3, make_sample(3, 0, SampleKind::grasped));
    journal.append(3, make_sample(3, 0, SampleKind::tangential));
    journal.append(3, make_check());
    journal.append(3, make_outcome(true));
    journal.append(0, make_check("no mesh"));
    journal.append(0, make_outcome(false, "penetration 0.4 of the contact radius"));
    journal.sync();
  }
  const JournalContent content = read_journal(file_, manifest_);
  EXPECT_EQ(content.records, 9U);
  EXPECT_EQ(content.torn_bytes, 0U);
  ASSERT_EQ(content.pairs.size(), 2U);
  const JournalPair& pair = content.pairs.at(3);
  ASSERT_EQ(pair.samples.size(), 5U);
  EXPECT_TRUE(same_bits(pair.samples[0], make_sample(3, 0)));
  EXPECT_TRUE(same_bits(pair.samples[1], make_sample(3, 1)));
  EXPECT_TRUE(same_bits(pair.samples[2], make_sample(3, 0, SampleKind::tangential)));
  EXPECT_TRUE(same_bits(pair.samples[3], make_sample(3, 2, SampleKind::slipping)));
  EXPECT_TRUE(same_bits(pair.samples[4], make_sample(3, 0, SampleKind::grasped)));
  EXPECT_EQ(pair.samples[4].torque, make_sample(3, 0, SampleKind::grasped).torque);
  ASSERT_TRUE(pair.check.has_value());
  EXPECT_TRUE(same_bits(*pair.check, make_check()));
  EXPECT_EQ(pair.check->difference, 0.013);
  EXPECT_EQ(content.pairs.at(0).check->cause, "no mesh");
  ASSERT_TRUE(pair.outcome.has_value());
  EXPECT_TRUE(pair.outcome->accepted);
  EXPECT_EQ(pair.outcome->tangential_solves, 24U);
  EXPECT_EQ(pair.outcome->first_touch, 1.25e-5);
  EXPECT_FALSE(content.pairs.at(0).outcome->accepted);
  EXPECT_EQ(content.pairs.at(0).outcome->cause, "penetration 0.4 of the contact radius");
}

TEST_F(JournalFiles, SameBitsSeesTheLastBit) {
  const Sample a = make_sample(1, 2);
  Sample b = a;
  b.force.z() = std::nextafter(b.force.z(), 1.0);
  EXPECT_TRUE(same_bits(a, a));
  EXPECT_FALSE(same_bits(a, b));
}

TEST_F(JournalFiles, ReopeningAppends) {
  { Journal(file_, manifest_).append(0, make_sample(0, 0)); }
  {
    Journal journal(file_, manifest_);
    EXPECT_EQ(journal.content().records, 1U);
    journal.append(0, make_sample(0, 1));
  }
  EXPECT_EQ(read_journal(file_, manifest_).pairs.at(0).samples.size(), 2U);
}

TEST_F(JournalFiles, ThreadsAppendWholeRecords) {
  constexpr unsigned threads = 8, each = 500;
  {
    Journal journal(file_, manifest_);
    std::vector<std::jthread> workers;
    for (unsigned t = 0; t < threads; ++t) {
      workers.emplace_back([&journal, t] {
        for (unsigned i = 0; i < each; ++i) journal.append(t, make_sample(t, i));
        journal.append(t, make_outcome(true));
      });
    }
  }
  const JournalContent content = read_journal(file_, manifest_);
  EXPECT_EQ(content.records, threads * (each + 1U));
  for (unsigned t = 0; t < threads; ++t) {
    ASSERT_EQ(content.pairs.at(t).samples.size(), each);
    for (unsigned i = 0; i < each; ++i) EXPECT_TRUE(same_bits(content.pairs.at(t).samples[i], make_sample(t, i)));
  }
}

TEST_F(JournalFiles, OneWriterAtATime) {
  const Journal journal(file_, manifest_);
  try {
    const Journal second(file_, manifest_);
    FAIL() << "a second writer must be refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::io);
    EXPECT_NE(std::string(error.what()).find("another bake"), std::string::npos);
  }
}

TEST_F(JournalFiles, AnotherManifestIsSaid) {
  { Journal(file_, manifest_).append(0, make_sample(0, 0)); }
  const auto [code, text] = read_error(hash128("another"));
  EXPECT_EQ(code, ExitCode::bad_input);
  EXPECT_NE(text.find("another manifest"), std::string::npos) << text;
  EXPECT_THROW(Journal(file_, hash128("another")), Error);
}

TEST_F(JournalFiles, OtherFilesAreRefusedAndLeftAlone) {
  for (const std::string& content :
       {std::string("x"), std::string("PALP but something else"), std::string(5000, '\0')}) {
    write_bytes(content);
    EXPECT_EQ(read_error(manifest_).first, ExitCode::bad_input);
    EXPECT_THROW(Journal(file_, manifest_), Error);
    EXPECT_EQ(bytes(), content);
  }
  EXPECT_EQ(read_error(manifest_).first, ExitCode::bad_input);
  std::filesystem::remove(file_);
  EXPECT_EQ(read_error(manifest_).first, ExitCode::io);
  file_ = folder_;
  EXPECT_EQ(read_error(manifest_).first, ExitCode::io);
  EXPECT_THROW(Journal(folder_ / "missing" / "samples.journal", manifest_), Error);
}

}  // namespace
}  // namespace palpate::test
