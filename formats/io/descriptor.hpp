// SPDX-License-Identifier: MIT
// File descriptors for the formats that read and write by system calls.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace palpate {

/// A file descriptor that closes itself.
class Descriptor {
public:
  /// Opens; check get(): below 0 the system refused, and errno says why.
  Descriptor(const std::filesystem::path& path, int flags);
  ~Descriptor();
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  [[nodiscard]] int get() const noexcept { return value_; }
  /// Closes now: 0, or the cause why what was written may not be there.
  [[nodiscard]] int close() noexcept;
  /// Hands the descriptor over to the caller.
  [[nodiscard]] int release() noexcept;

private:
  int value_;
};

/// Throws Error(io): "PATH: WHAT: cause".
[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& what, int cause);

/// Writes all bytes: 0, or the cause why not.
int write_all(int descriptor, std::string_view bytes);

/// Hands the bytes of an open regular file, from where the descriptor stands, to `take` block by block; `what`
/// names the file in messages. Throws Error(io).
void read_blocks(int descriptor, const std::filesystem::path& path, const std::string& what,
                 const std::function<void(std::string_view)>& take);

/// The same for a file that is opened for it.
void read_blocks(const std::filesystem::path& path, const std::string& what,
                 const std::function<void(std::string_view)>& take);

}  // namespace palpate
