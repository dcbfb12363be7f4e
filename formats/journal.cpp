// SPDX-License-Identifier: MIT
// Reading, mending and appending to the samples journal.
#include "formats/journal.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string>

#include "formats/error.hpp"
#include "formats/journal_record.hpp"

namespace palpate {
namespace {

using journal::Bytes;

[[noreturn]] void fail_io(const std::filesystem::path& file, const char* action, int error) {
  throw Error(ExitCode::io,
              std::string("cannot ") + action + " the journal " + file.string() + ": " + std::strerror(error));
}

[[noreturn]] void fail_input(const std::filesystem::path& file, const std::string& what) {
  throw Error(ExitCode::bad_input, file.string() + ": " + what);
}

class Descriptor {
public:
  Descriptor(const std::filesystem::path& file, int flags) : value_(::open(file.c_str(), flags | O_CLOEXEC, 0644)) {
    if (value_ < 0) fail_io(file, "open", errno);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (value_ >= 0) ::close(value_);
  }
  [[nodiscard]] int get() const noexcept { return value_; }
  int release() noexcept { return std::exchange(value_, -1); }

private:
  int value_;
};

Bytes read_all(int descriptor, const std::filesystem::path& file) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) fail_io(file, "read", errno);
  if (!S_ISREG(status.st_mode)) throw Error(ExitCode::io, "the journal " + file.string() + " is not a regular file");
  Bytes bytes;
  std::size_t got = 0;
  for (;;) {
    bytes.resize(std::max(static_cast<std::size_t>(status.st_size), got) + 65536);
    const ssize_t n = ::pread(descriptor, bytes.data() + got, bytes.size() - got, static_cast<off_t>(got));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail_io(file, "read", errno);
    if (n == 0) break;
    got += static_cast<std::size_t>(n);
  }
  bytes.resize(got);
  return bytes;
}

/// Checks the header; false when it is cut short (nothing was ever recorded).
bool check_header(const Bytes& bytes, const Hash128& manifest, const std::filesystem::path& file) {
  if (bytes.empty()) return false;
  const std::size_t known = std::min<std::size_t>(bytes.size(), 8);
  if (std::memcmp(bytes.data(), journal::magic, known) != 0) fail_input(file, "is not a Palpate journal");
  if (bytes.size() < journal::header_size) return false;
  const Bytes expected = journal::encode_header(manifest);
  std::uint64_t checksum = 0;
  std::memcpy(&checksum, bytes.data() + 56, sizeof checksum);
  if (checksum != checksum64(bytes.data(), 56)) fail_input(file, "offset 0: the journal's header is damaged");
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
                               std::to_string(next - at) + " bytes before the next whole record)");
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
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t n = ::write(descriptor, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail_io(file, "write", errno);
    done += static_cast<std::size_t>(n);
  }
}

}  // namespace

bool same_bits(const Sample& a, const Sample& b) { return journal::encode(0, a) == journal::encode(0, b); }

JournalContent read_journal(const std::filesystem::path& file, const Hash128& manifest) {
  const Descriptor descriptor(file, O_RDONLY);
  return parse(read_all(descriptor.get(), file), manifest, file);
}

Journal::Journal(const std::filesystem::path& file, const Hash128& manifest) : file_(file) {
  Descriptor descriptor(file, O_RDWR | O_CREAT | O_APPEND);
  if (::flock(descriptor.get(), LOCK_EX | LOCK_NB) != 0) {
    if (errno == EWOULDBLOCK) throw Error(ExitCode::io, "another bake is writing " + file.string());
    fail_io(file, "lock", errno);
  }
  const Bytes bytes = read_all(descriptor.get(), file);
  content_ = parse(bytes, manifest, file);
  size_ = bytes.size() - content_.torn_bytes;
  if (content_.torn_bytes > 0 && ::ftruncate(descriptor.get(), static_cast<off_t>(size_)) != 0) {
    fail_io(file, "cut the torn tail of", errno);
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

void Journal::write_record(const Bytes& record) {
  const std::lock_guard lock(mutex_);
  if (failed_) throw Error(ExitCode::io, "the journal " + file_.string() + " takes no more: an earlier write failed");
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
  if (::fdatasync(descriptor_) != 0) fail_io(file_, "put on the disk", errno);
}

}  // namespace palpate
