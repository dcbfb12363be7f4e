// SPDX-License-Identifier: MIT
// A file in memory: mapped where the system has POSIX mmap, read elsewhere. The runtime itself needs only bytes.
#pragma once

#if defined(_WIN32)
#include "palpate/format/loaded_file.hpp"
#else
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstring>
#endif

namespace palpate::runtime {

#if defined(_WIN32)
using MappedFile = LoadedFile;
#else
/// The bytes of a whole file, aligned to 8, released on destruction. The file must not be shortened while it is mapped.
/// Replace it by renaming, as Palpate's writer does.
class MappedFile {
public:
  explicit MappedFile(const char* path) { load(path); }
  ~MappedFile() { release(); }
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  /// False when the file could not be read. An empty file has no bytes.
  [[nodiscard]] bool ok() const { return error_ == 0; }
  /// The system's message for the failure.
  [[nodiscard]] const char* error() const { return std::strerror(error_); }
  [[nodiscard]] const void* data() const { return data_; }
  [[nodiscard]] std::size_t size() const { return size_; }

private:
  void load(const char* path) {
    const int fd = ::open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // a FIFO without writer must not block
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
  void release() {
    if (data_ != nullptr) ::munmap(data_, size_);
  }

  void* data_ = nullptr;
  std::size_t size_ = 0;
  int error_ = 0;
};
#endif

}  // namespace palpate::runtime
