// SPDX-License-Identifier: MIT
// Reading and writing by system calls, since streams lose the cause of a failure.
#include "formats/file.hpp"

#include "formats/error.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

namespace palpate {

namespace {

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& what, int cause) {
  throw Error(ExitCode::io, path.string() + ": " + what + ": " + std::strerror(cause));
}

/// A file descriptor that closes itself.
class Descriptor {
public:
  Descriptor(const std::filesystem::path& path, int flags) : value_(::open(path.c_str(), flags | O_CLOEXEC, 0666)) {}
  ~Descriptor() {
    if (value_ >= 0) ::close(value_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  [[nodiscard]] int get() const noexcept { return value_; }
  /// 0, or the cause why what was written may not be there.
  [[nodiscard]] int close() noexcept {
    const int descriptor = value_;
    value_ = -1;
    return ::close(descriptor) == 0 ? 0 : errno;
  }

private:
  int value_;
};

int write_all(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return errno;
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return 0;
}

}  // namespace

std::string read_file(const std::filesystem::path& path, const std::string& what, std::size_t largest) {
  // Without O_NONBLOCK, opening a pipe that nobody writes to would wait for ever.
  const Descriptor file(path, O_RDONLY | O_NONBLOCK);
  if (file.get() < 0) refuse(path, "cannot open the " + what, errno);
  struct stat status = {};
  if (::fstat(file.get(), &status) != 0) refuse(path, "cannot read the " + what, errno);
  if (!S_ISREG(status.st_mode)) {
    throw Error(ExitCode::io, path.string() + ": cannot read the " + what + ": not a regular file");
  }
  std::string bytes;
  std::string block(1 << 16, '\0');
  for (;;) {
    const ssize_t count = ::read(file.get(), block.data(), block.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) refuse(path, "cannot read the " + what, errno);
    if (count == 0) return bytes;
    bytes.append(block, 0, static_cast<std::size_t>(count));
    if (bytes.size() > largest) {
      throw Error(ExitCode::bad_input, path.string() + ": too large for a " + what + "; allowed at most " +
                                           std::to_string(largest) + " bytes");
    }
  }
}

void write_file(const std::filesystem::path& path, std::string_view bytes) {
  const std::filesystem::path temporary = path.string() + "." + std::to_string(::getpid()) + ".part";
  Descriptor file(temporary, O_WRONLY | O_CREAT | O_TRUNC);
  if (file.get() < 0) refuse(path, "cannot create the file", errno);
  int cause = write_all(file.get(), bytes);
  // Before the rename: else a crash could leave the new name with nothing behind it.
  if (cause == 0 && ::fsync(file.get()) != 0) cause = errno;
  const int closing = file.close();
  if (cause == 0) cause = closing;
  if (cause == 0 && std::rename(temporary.c_str(), path.c_str()) != 0) cause = errno;
  if (cause != 0) {
    ::unlink(temporary.c_str());
    refuse(path, "cannot write the file", cause);
  }
}

void make_folder(const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) refuse(path, "cannot create the folder", error.value());
  if (!std::filesystem::is_directory(path, error)) refuse(path, "cannot create the folder", ENOTDIR);
}

}  // namespace palpate
