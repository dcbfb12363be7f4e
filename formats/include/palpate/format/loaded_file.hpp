// SPDX-License-Identifier: MIT
// A file read into memory with the C library alone, for systems without POSIX mmap. The runtime itself needs only bytes.
#pragma once

#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace palpate::runtime {

/// Reads a whole file into memory that it owns, aligned for every type, and frees it on destruction.
class LoadedFile {
public:
  explicit LoadedFile(const char* path) {
    std::FILE* const file = std::fopen(path, "rb");
    if (file == nullptr) {
      error_ = errno != 0 ? errno : EIO;
      return;
    }
    read(file);
    std::fclose(file);
    if (error_ != 0) release();
  }
  ~LoadedFile() { release(); }
  LoadedFile(const LoadedFile&) = delete;
  LoadedFile& operator=(const LoadedFile&) = delete;

  /// False when the file could not be read. An empty file has no bytes.
  [[nodiscard]] bool ok() const { return error_ == 0; }
  /// The system's message for the failure.
  [[nodiscard]] const char* error() const { return std::strerror(error_); }
  [[nodiscard]] const void* data() const { return data_; }
  [[nodiscard]] std::size_t size() const { return size_; }

private:
  void read(std::FILE* file) {
    constexpr std::size_t kFirst = std::size_t{1} << 16;  // bytes; a file without a length, such as a pipe, is read as well
    std::size_t room = 0;
    for (;;) {
      if (size_ == room) {
        room = room == 0 ? kFirst : 2 * room;
        void* const more = std::realloc(data_, room);
        if (more == nullptr) {
          error_ = ENOMEM;
          return;
        }
        data_ = more;
      }
      const std::size_t count = std::fread(static_cast<char*>(data_) + size_, 1, room - size_, file);
      size_ += count;
      if (count > 0) continue;
      if (std::ferror(file) != 0) error_ = errno != 0 ? errno : EIO;
      return;
    }
  }
  void release() {
    std::free(data_);
    data_ = nullptr;
    size_ = 0;
  }

  void* data_ = nullptr;
  std::size_t size_ = 0;
  int error_ = 0;
};

}  // namespace palpate::runtime
