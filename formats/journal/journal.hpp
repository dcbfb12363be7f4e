// SPDX-License-Identifier: MIT
// The samples journal: an append-only file with one checksummed record a solve (journal-file.md).
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <vector>

#include "formats/io/hash.hpp"
#include "formats/journal/samples.hpp"

namespace palpate {

/// The records of one pair in a journal.
struct JournalPair {
  std::vector<Sample> samples;  ///< sorted by (kind, index), each once
  std::optional<PairCheck> check;
  std::optional<PairOutcome> outcome;  ///< absent: not finished
};

/// The content of a journal, independent of the order in which it was written.
struct JournalContent {
  std::map<std::uint32_t, JournalPair> pairs;  ///< by index into the manifest's pairs
  std::uint64_t records = 0;                   ///< whole records read
  std::uint64_t torn_bytes = 0;                ///< of a torn tail, ignored (reading) or cut off (writing)

  /// Whether the pair has an outcome.
  [[nodiscard]] bool finished(std::uint32_t pair) const {
    const auto at = pairs.find(pair);
    return at != pairs.end() && at->second.outcome.has_value();
  }

  /// The pair if it was accepted, else null.
  [[nodiscard]] const JournalPair* accepted(std::uint32_t pair) const {
    const auto at = pairs.find(pair);
    return at != pairs.end() && at->second.outcome && at->second.outcome->accepted ? &at->second : nullptr;
  }
};

/// True when two samples, two checks agree in every bit.
bool same_bits(const Sample& a, const Sample& b);
bool same_bits(const PairCheck& a, const PairCheck& b);

/// Reads a journal without changing it. Throws Error(io) when the file cannot be read; Error(bad_input) when it is
/// no journal, of another version, of another manifest, or damaged before its tail (with the offset).
JournalContent read_journal(const std::filesystem::path& file, const Hash128& manifest);

/// A journal open for appending. Safe to use from several threads.
class Journal {
public:
  /// Opens or creates `file`, cuts a torn tail off, and gives what it holds. Throws as read_journal, and
  /// Error(io) when another process has it open for writing.
  Journal(const std::filesystem::path& file, const Hash128& manifest);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// The content of the file when it was opened.
  [[nodiscard]] const JournalContent& content() const noexcept { return content_; }

  /// Appends one record by one write. Throws Error(io) when the system refuses (disk full): what was appended
  /// before stays, the part of this record that was written is taken back, and the journal takes no more. The same
  /// where another program removed the file or changed its length.
  void append(std::uint32_t pair, const Sample& sample);
  void append(std::uint32_t pair, const PairOutcome& outcome);
  void append(std::uint32_t pair, const PairCheck& check);

  /// Asks the system to put what was appended on the disk. Throws Error(io).
  void sync();

private:
  void write_record(const std::vector<unsigned char>& record);

  std::filesystem::path file_;
  std::mutex mutex_;
  int descriptor_ = -1;
  bool failed_ = false;
  std::uint64_t size_ = 0;
  JournalContent content_;
};

}  // namespace palpate
