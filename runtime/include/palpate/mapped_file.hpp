// SPDX-License-Identifier: MIT
// A file mapped into memory, for hosts with POSIX mmap; the runtime itself needs only bytes.
#pragma once

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstring>

namespace palpate::runtime {

/// Read-only private mapping of a whole file; unmapped on destruction. The file must not be shortened while
/// it is mapped: replace it by renaming, as Palpate's writer does.
class MappedFile {
public:
  explicit MappedFile(const char* path) {
    const int fd = ::open(path, O_RDONLY | O_CLOEXEC);
    struct stat status {};
    if (fd < 0 || ::fstat(fd, &status) != 0) {
      error_ = errno;
    } else if (!S_ISREG(status.st_mode)) {
      error_ = S_ISDIR(status.st_mode) ? EISDIR : EINVAL;
    } else if (status.st_size > 0) {
      void* mapped = ::mmap(nullptr, static_cast<std::size_t>(status.st_size), PROT_READ, MAP_PRIVATE, fd, 0);
      if (mapped == MAP_FAILED) {
        error_ = errno;
      } else {
        data_ = mapped;
        size_ = static_cast<std::size_t>(status.st_size);
      }
    }
    if (fd >= 0) ::close(fd);
  }
  ~MappedFile() {
    if (data_ != nullptr) ::munmap(data_, size_);
  }
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  /// False when the file could not be mapped; an empty file maps to no bytes.
  [[nodiscard]] bool ok() const { return error_ == 0; }
  /// Why not, as the system says it.
  [[nodiscard]] const char* error() const { return std::strerror(error_); }
  [[nodiscard]] const void* data() const { return data_; }
  [[nodiscard]] std::size_t size() const { return size_; }

private:
  void* data_ = nullptr;
  std::size_t size_ = 0;
  int error_ = 0;
};

}  // namespace palpate::runtime
