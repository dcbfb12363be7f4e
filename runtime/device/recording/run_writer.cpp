// SPDX-License-Identifier: MIT
#include "device/recording/run_writer.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <vector>

namespace palpate::device {
namespace {

/// The file, emptied, for one writer at a time; -1 with the cause.
int open_alone(const std::string& path, std::string& error) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (file < 0) {
    error = std::strerror(errno);
    return -1;
  }
  struct stat status = {};
  if (::flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    error = "another run is being written there";
  } else if (::fstat(file, &status) != 0 || (S_ISREG(status.st_mode) && ::ftruncate(file, 0) != 0)) {
    error = std::strerror(errno);
  } else {
    return file;
  }
  ::close(file);
  return -1;
}

}  // namespace

RunWriter::RunWriter(const std::string& path, RunHeader header, const std::optional<RunHand>& hand,
                     std::size_t capacity)
    : ring_(capacity), glove_(hand.has_value()) {
  file_ = open_alone(path, open_error_);
  if (file_ < 0) return;
  if (glove_) {
    header.glove = 1;
    header.header_size += sizeof(RunHand);
    header.record_size += sizeof(HandRecord);
  }
  seal(header);
  write(&header, sizeof header);
  if (RunHand sealed = hand.value_or(RunHand()); glove_) {
    seal(sealed);
    write(&sealed, sizeof sealed);
  }
  open_error_ = result_.error;
  if (open_error_.empty()) thread_ = std::thread([this] { drain(); });
}

RunWriter::~RunWriter() { finish(); }

void RunWriter::put(const RunTick& tick) noexcept {
  ticks_.fetch_add(1, std::memory_order_relaxed);
  if (!ring_.put(tick)) dropped_.fetch_add(1, std::memory_order_relaxed);
}

void RunWriter::drain() {
  std::vector<RunTick> batch(256);
  const std::size_t record_size = sizeof(RunRecord) + (glove_ ? sizeof(HandRecord) : 0);
  std::vector<unsigned char> bytes(batch.size() * record_size);
  for (;;) {
    const bool last = finishing_.load(std::memory_order_acquire);  // read before the ring: nothing is put after it
    const std::size_t count = ring_.take(batch.data(), batch.size());
    if (count == 0) {
      if (last) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      continue;
    }
    for (std::size_t k = 0; k < count; ++k) {
      RunRecord& record = batch[k];
      seal(record);
      unsigned char* to = bytes.data() + k * record_size;
      std::memcpy(to, &record, sizeof record);
      if (!glove_) continue;
      seal(batch[k].hand);
      std::memcpy(to + sizeof record, &batch[k].hand, sizeof(HandRecord));
    }
    const std::size_t whole = write(bytes.data(), count * record_size) / record_size;
    dropped_.fetch_add(count - whole, std::memory_order_relaxed);
  }
}

/// How many bytes went in. After a refusal none do any more: the file stays readable up to there.
std::size_t RunWriter::write(const void* bytes, std::size_t size) {
  std::size_t done = 0;
  while (done < size && result_.error.empty()) {
    const ssize_t written = ::write(file_, static_cast<const char*>(bytes) + done, size - done);
    if (written >= 0) {
      done += static_cast<std::size_t>(written);
    } else if (errno != EINTR) {
      result_.error = std::strerror(errno);
    }
  }
  return done;
}

const RunWritten& RunWriter::finish() {
  finishing_.store(true, std::memory_order_release);
  if (thread_.joinable()) thread_.join();
  if (file_ < 0) return result_;
  result_.ticks = ticks_.load();
  result_.dropped = dropped_.load();
  RunEnd end;
  end.ticks = result_.ticks;
  end.dropped = result_.dropped;
  seal(end);
  write(&end, sizeof end);
  if (::close(file_) != 0 && result_.error.empty()) result_.error = std::strerror(errno);
  file_ = -1;
  return result_;
}

}  // namespace palpate::device
