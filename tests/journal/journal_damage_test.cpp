// SPDX-License-Identifier: GPL-3.0-or-later
// The journal after accidents: torn at every byte, every byte flipped, a full disk.
#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <iostream>

#include "tests/journal/journal_fixture.hpp"

namespace palpate::test {
namespace {

constexpr std::size_t header = 64, record = 128;

/// Three samples of two pairs, a check and an outcome; returns the record borders after the header.
std::vector<std::size_t> write_small(const std::filesystem::path& file, const Hash128& manifest) {
  Journal journal(file, manifest);
  std::vector<std::size_t> borders{header};
  journal.append(0, make_sample(0, 0));
  borders.push_back(std::filesystem::file_size(file));
  journal.append(1, make_sample(1, 0));
  borders.push_back(std::filesystem::file_size(file));
  journal.append(0, make_check("no mesh"));
  borders.push_back(std::filesystem::file_size(file));
  journal.append(0, make_outcome(false, "a cause"));
  borders.push_back(std::filesystem::file_size(file));
  journal.append(1, make_sample(1, 1));
  borders.push_back(std::filesystem::file_size(file));
  return borders;
}

TEST_F(JournalFiles, TornAtEveryByte) {
  const std::vector<std::size_t> borders = write_small(file_, manifest_);
  EXPECT_EQ(borders[1], header + record);
  const std::string whole = bytes();
  for (std::size_t cut = 0; cut <= whole.size(); ++cut) {
    write_bytes(whole.substr(0, cut));
    std::size_t kept = 0;
    for (const std::size_t border : borders) kept = border <= cut ? border : kept;
    const auto records = static_cast<std::size_t>(
        std::count_if(borders.begin() + 1, borders.end(), [&](std::size_t border) { return border <= cut; }));
    {
      Journal journal(file_, manifest_);
      EXPECT_EQ(journal.content().torn_bytes, cut - kept) << "cut at " << cut;
      EXPECT_EQ(journal.content().records, records) << "cut at " << cut;
      journal.append(7, make_sample(7, 0));
    }
    // Whole records are kept to the byte, and records appended after the cut are found.
    const std::size_t base = std::max(kept, header);
    EXPECT_EQ(bytes().substr(0, base), whole.substr(0, base));
    const JournalContent after = read_journal(file_, manifest_);
    EXPECT_EQ(after.torn_bytes, 0U);
    EXPECT_EQ(after.records, records + 1U);
    EXPECT_TRUE(same_bits(after.pairs.at(7).samples.at(0), make_sample(7, 0)));
  }
}

TEST_F(JournalFiles, TailOfZerosOrNoiseIsCut) {
  write_small(file_, manifest_);
  const std::string whole = bytes();
  for (const std::string& tail : {std::string(4096, '\0'), std::string(777, '\xff'), std::string(3, '\x01')}) {
    write_bytes(whole + tail);
    EXPECT_EQ(read_journal(file_, manifest_).torn_bytes, tail.size());
    EXPECT_EQ(Journal(file_, manifest_).content().records, 5U);
    EXPECT_EQ(bytes(), whole);
  }
}

TEST_F(JournalFiles, FlippedBytesAreFoundOrCut) {
  const std::vector<std::size_t> borders = write_small(file_, manifest_);
  const std::string whole = bytes();
  const std::size_t last = borders[borders.size() - 2];
  for (std::size_t at = 0; at < whole.size(); ++at) {
    for (const char mask : {char(0x01), char(0x80), char(0xff)}) {
      std::string damaged = whole;
      damaged[at] = static_cast<char>(damaged[at] ^ mask);
      write_bytes(damaged);
      if (at >= last) {
        // The last record cannot be distinguished from a torn one.
        const JournalContent content = read_journal(file_, manifest_);
        EXPECT_EQ(content.records, 4U);
        EXPECT_EQ(content.torn_bytes, whole.size() - last);
        continue;
      }
      const auto [code, text] = read_error(manifest_);
      EXPECT_EQ(code, ExitCode::bad_input) << "byte " << at;
      if (at >= header) {
        std::size_t start = 0;
        for (const std::size_t border : borders) start = border <= at ? border : start;
        EXPECT_NE(text.find("offset " + std::to_string(start)), std::string::npos) << text;
        // The way out, where it is the record itself that cannot be read.
        const std::string cut = "`truncate -s " + std::to_string(start) + " '" + file_.string() + "'`";
        EXPECT_EQ(text.find("is damaged") != std::string::npos, text.find(cut) != std::string::npos) << text;
      }
      EXPECT_THROW(Journal(file_, manifest_), Error);
      EXPECT_EQ(bytes(), damaged) << "a damaged journal is left alone";
    }
  }
}

TEST_F(JournalFiles, TwoTruthsForOneSampleAreRefused) {
  {
    Journal journal(file_, manifest_);
    journal.append(0, make_sample(0, 0));
    journal.append(0, make_sample(0, 0));
  }
  EXPECT_EQ(read_journal(file_, manifest_).pairs.at(0).samples.size(), 1U) << "an equal copy does no harm";
  {
    Sample other = make_sample(0, 0);
    other.force.x() += 1.0;
    Journal(file_, manifest_).append(0, other);
  }
  const auto [code, text] = read_error(manifest_);
  EXPECT_EQ(code, ExitCode::bad_input);
  EXPECT_NE(text.find("different sample"), std::string::npos) << text;
}

/// Appends until the file may grow no more (a limit that cuts the record in two); exit code 0 when all is as promised.
int fill_the_disk(const std::filesystem::path& file, const Hash128& manifest) {
  std::signal(SIGXFSZ, SIG_IGN);
  const rlimit limit{header + 10 * record + 50, header + 10 * record + 50};
  if (::setrlimit(RLIMIT_FSIZE, &limit) != 0) return 10;
  Journal journal(file, manifest);
  for (unsigned i = 0; i < 10; ++i) journal.append(0, make_sample(0, i));
  for (int attempt = 0; attempt < 2; ++attempt) {
    try {
      journal.append(0, make_sample(0, 10));
      return 11;
    } catch (const Error& error) {
      if (error.code() != ExitCode::io) return 12;
      std::cerr << error.what() << '\n';
    }
  }
  return 0;
}

TEST_F(JournalFiles, CutOrRemovedByAnotherProgramTakesNoMore) {
  for (const bool removed : {false, true}) {
    std::filesystem::remove(file_);
    Journal journal(file_, manifest_);
    for (unsigned k = 0; k < 3; ++k) journal.append(0, make_sample(0, k));
    const auto size = std::filesystem::file_size(file_) - 50;
    removed ? static_cast<void>(std::filesystem::remove(file_)) : std::filesystem::resize_file(file_, size);
    for (int again = 0; again < 2; ++again) {
      try {
        journal.append(0, make_sample(0, 3));
        FAIL() << "a record that no reader would find was accepted";
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::io);
        EXPECT_NE(std::string(error.what()).find("samples.journal"), std::string::npos) << error.what();
      }
    }
    if (removed) continue;
    EXPECT_EQ(read_journal(file_, manifest_).records, 2U);
  }
}

TEST_F(JournalFiles, FullDiskLeavesAWholeJournal) {
  EXPECT_EXIT(std::_Exit(fill_the_disk(file_, manifest_)), testing::ExitedWithCode(0), "bytes before are safe");
  const JournalContent content = read_journal(file_, manifest_);
  EXPECT_EQ(content.records, 10U);
  EXPECT_EQ(content.torn_bytes, 0U);
  EXPECT_EQ(std::filesystem::file_size(file_), header + 10 * record);
}

}  // namespace
}  // namespace palpate::test
