// SPDX-License-Identifier: MIT
// Reading and writing by system calls, since streams lose the cause of a failure.
#include "formats/io/descriptor.hpp"

#include "formats/io/error.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace palpate {

Descriptor::Descriptor(const std::filesystem::path& path, int flags)
    : value_(::open(path.c_str(), flags | O_CLOEXEC, 0666)) {}

Descriptor::~Descriptor() {
  if (value_ >= 0) ::close(value_);
}

int Descriptor::close() noexcept { return ::close(release()) == 0 ? 0 : errno; }

int Descriptor::release() noexcept { return std::exchange(value_, -1); }

void refuse(const std::filesystem::path& path, const std::string& what, int cause) {
  throw Error(ExitCode::io, path.string() + ": " + what + ": " + std::strerror(cause));
}

int write_all(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return errno;
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return 0;
}

void read_blocks(int descriptor, const std::filesystem::path& path, const std::string& what,
                 const std::function<void(std::string_view)>& take) {
  struct stat status = {};
  if (::fstat(descriptor, &status) != 0) refuse(path, "cannot read the " + what, errno);
  if (!S_ISREG(status.st_mode)) {
    throw Error(ExitCode::io, path.string() + ": cannot read the " + what + ": not a regular file");
  }
  std::string block(1 << 16, '\0');
  for (;;) {
    const ssize_t count = ::read(descriptor, block.data(), block.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) refuse(path, "cannot read the " + what, errno);
    if (count == 0) return;
    take(std::string_view(block).substr(0, static_cast<std::size_t>(count)));
  }
}

void read_blocks(const std::filesystem::path& path, const std::string& what,
                 const std::function<void(std::string_view)>& take) {
  // Without O_NONBLOCK, opening a pipe that nobody writes to would wait for ever.
  const Descriptor file(path, O_RDONLY | O_NONBLOCK);
  if (file.get() < 0) refuse(path, "cannot open the " + what, errno);
  read_blocks(file.get(), path, what, take);
}

}  // namespace palpate
