// SPDX-License-Identifier: MIT
// Reading, mending and appending to the samples journal.
#include "formats/journal/journal.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string>

#include "formats/io/descriptor.hpp"
#include "formats/io/error.hpp"
#include "formats/journal/journal_record.hpp"
#include "palpate/format/checksum.hpp"

namespace palpate {
namespace {

using journal::Bytes;

[[noreturn]] void fail_input(const std::filesystem::path& file, const std::string& what) {
  throw Error(ExitCode::bad_input, file.string() + ": " + what);
}

auto append_to(Bytes& bytes) {
  return [&bytes](std::string_view block) { bytes.insert(bytes.end(), block.begin(), block.end()); };
}

/// Checks the header; false when it is cut short (nothing was ever recorded).
bool check_header(const Bytes& bytes, const Hash128& manifest, const std::filesystem::path& file) {
  if (bytes.empty()) return false;
  const std::size_t known = std::min<std::size_t>(bytes.size(), 8);
  if (std::memcmp(bytes.data(), journal::magic, known) != 0) fail_input(file, "is not a Palpate journal");
  if (bytes.size() < journal::header_size) return false;
  const Bytes expected = journal::encode_header(manifest);
  std::uint64_t sum = 0;
  std::memcpy(&sum, bytes.data() + 56, sizeof sum);
  if (sum != checksum::of(bytes.data(), 56)) {
    fail_input(file,
               "offset 0: the journal's header is damaged, which says the plan of its records; without this file "
               "everything is solved again");
  }
  if (std::memcmp(bytes.data() + 8, expected.data() + 8, 8) != 0) {
    std::uint32_t version = 0;
    std::memcpy(&version, bytes.data() + 8, sizeof version);
    fail_input(file, "is a journal of version " + std::to_string(version) + "; this program reads version " +
                         std::to_string(journal::version));
  }
  Hash128 found;
  std::memcpy(&found.high, bytes.data() + 16, 8);
  std::memcpy(&found.low, bytes.data() + 24, 8);
  if (!(found == manifest)) {
    fail_input(file, "belongs to another manifest (" + to_hex(found) + ", now " + to_hex(manifest) +
                         "): scene, surfaces or plan have changed since; remove the work folder or choose another one");
  }
  return true;
}

void insert(JournalContent& content, const journal::RecordView& record, std::size_t offset,
            const std::filesystem::path& file) {
  JournalPair& pair = content.pairs[record.pair];
  const auto clash = [&](const std::string& what) {
    fail_input(file, "offset " + std::to_string(offset) + ": a second, different " + what + " of pair " +
                         std::to_string(record.pair));
  };
  if (record.type == journal::RecordType::outcome) {
    PairOutcome outcome = journal::decode_outcome(record);
    if (pair.outcome && journal::encode(0, *pair.outcome) != journal::encode(0, outcome)) clash("outcome");
    pair.outcome = std::move(outcome);
    return;
  }
  if (record.type == journal::RecordType::check) {
    PairCheck check = journal::decode_check(record);
    if (pair.check && !same_bits(*pair.check, check)) clash("check");
    pair.check = std::move(check);
    return;
  }
  const Sample sample = journal::decode_sample(record);
  const auto key = [](const Sample& s) { return std::pair(s.kind, s.index); };
  const auto at = std::lower_bound(pair.samples.begin(), pair.samples.end(), sample,
                                   [&](const Sample& a, const Sample& b) { return key(a) < key(b); });
  if (at != pair.samples.end() && key(*at) == key(sample)) {
    if (!same_bits(*at, sample)) clash("sample " + std::to_string(sample.index));
    return;
  }
  pair.samples.insert(at, sample);
}

/// Reads every record; stops at a torn tail and refuses damage before it.
JournalContent parse(const Bytes& bytes, const Hash128& manifest, const std::filesystem::path& file) {
  JournalContent content;
  if (!check_header(bytes, manifest, file)) {
    content.torn_bytes = bytes.size();
    return content;
  }
  std::size_t at = journal::header_size;
  while (at < bytes.size()) {
    const auto record = journal::whole_record(bytes.data() + at, bytes.size() - at);
    if (!record) {
      // A tail is torn only when nothing whole follows: a flipped length must not cut good records off.
      for (std::size_t next = at + 1; next < bytes.size(); ++next) {
        if (journal::whole_record(bytes.data() + next, bytes.size() - next)) {
          fail_input(file, "offset " + std::to_string(at) + ": the record there is damaged (" +
                               std::to_string(next - at) + " bytes before the next whole record); `truncate -s " +
                               std::to_string(at) + " '" + file.string() +
                               "'` keeps what is before it, and the rest is solved again");
        }
      }
      content.torn_bytes = bytes.size() - at;
      break;
    }
    insert(content, *record, at, file);
    ++content.records;
    at += record->size;
  }
  return content;
}

void write_fully(int descriptor, const Bytes& bytes, const std::filesystem::path& file) {
  const int cause = write_all(descriptor, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  if (cause != 0) refuse(file, "cannot write the journal", cause);
}

}  // namespace

bool same_bits(const Sample& a, const Sample& b) { return journal::encode(0, a) == journal::encode(0, b); }
bool same_bits(const PairCheck& a, const PairCheck& b) { return journal::encode(0, a) == journal::encode(0, b); }

JournalContent read_journal(const std::filesystem::path& file, const Hash128& manifest) {
  Bytes bytes;
  read_blocks(file, "journal", append_to(bytes));
  return parse(bytes, manifest, file);
}

Journal::Journal(const std::filesystem::path& file, const Hash128& manifest) : file_(file) {
  Descriptor descriptor(file, O_RDWR | O_CREAT | O_APPEND);
  if (descriptor.get() < 0) refuse(file, "cannot open the journal", errno);
  if (::flock(descriptor.get(), LOCK_EX | LOCK_NB) != 0) {
    if (errno == EWOULDBLOCK) throw Error(ExitCode::io, "another bake is writing " + file.string());
    refuse(file, "cannot lock the journal", errno);
  }
  Bytes bytes;
  read_blocks(descriptor.get(), file, "journal", append_to(bytes));
  content_ = parse(bytes, manifest, file);
  size_ = bytes.size() - content_.torn_bytes;
  if (content_.torn_bytes > 0 && ::ftruncate(descriptor.get(), static_cast<off_t>(size_)) != 0) {
    refuse(file, "cannot cut the torn tail of the journal", errno);
  }
  if (size_ == 0) {
    const Bytes header = journal::encode_header(manifest);
    write_fully(descriptor.get(), header, file);
    size_ = header.size();
  }
  descriptor_ = descriptor.release();
}

Journal::~Journal() { ::close(descriptor_); }

void Journal::append(std::uint32_t pair, const Sample& sample) { write_record(journal::encode(pair, sample)); }

void Journal::append(std::uint32_t pair, const PairOutcome& outcome) { write_record(journal::encode(pair, outcome)); }

void Journal::append(std::uint32_t pair, const PairCheck& check) { write_record(journal::encode(pair, check)); }

void Journal::write_record(const Bytes& record) {
  const std::lock_guard lock(mutex_);
  if (failed_) throw Error(ExitCode::io, "the journal " + file_.string() + " takes no more: an earlier write failed");
  // A record behind a hole, or in a file without a name, would be lost.
  struct stat now = {};
  if (::fstat(descriptor_, &now) != 0) refuse(file_, "cannot look at the journal", errno);
  if (now.st_nlink == 0 || static_cast<std::uint64_t>(now.st_size) != size_) {
    failed_ = true;
    throw Error(ExitCode::io, file_.string() + ": another program " +
                                  (now.st_nlink == 0 ? "removed the journal"
                                                     : "changed the journal's length from " + std::to_string(size_) +
                                                           " to " + std::to_string(now.st_size) + " bytes") +
                                  " during the bake; run the same command again to solve what is lost");
  }
  try {
    write_fully(descriptor_, record, file_);
  } catch (const Error& error) {
    failed_ = true;
    // Should even this fail, the tail is torn, and the next opening cuts it off.
    const bool taken_back = ::ftruncate(descriptor_, static_cast<off_t>(size_)) == 0;
    throw Error(error.code(), std::string(error.what()) + "; the " + std::to_string(size_) + " bytes before are safe" +
                                  (taken_back ? "" : ", the tail is torn"));
  }
  size_ += record.size();
}

void Journal::sync() {
  const std::lock_guard lock(mutex_);
  if (::fdatasync(descriptor_) != 0) refuse(file_, "cannot put the journal on the disk", errno);
}

}  // namespace palpate
