// SPDX-License-Identifier: MIT
// Whole files: read with a limit, written so that they appear whole or not at all.
#include "formats/io/file.hpp"

#include "formats/io/descriptor.hpp"
#include "formats/io/error.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>

namespace palpate {

namespace {

/// The file behind a chain of symbolic links, there already or not.
std::filesystem::path behind_links(const std::filesystem::path& path) {
  constexpr int kMostLinks = 40;  // as the system itself
  std::filesystem::path file = path;
  std::error_code error;
  for (int i = 0; i < kMostLinks; ++i) {
    if (!std::filesystem::is_symlink(file, error)) return file;
    const std::filesystem::path target = std::filesystem::read_symlink(file, error);
    if (error) refuse(path, "cannot follow the link", error.value());
    file = file.parent_path() / target;  // an absolute target replaces the folder
  }
  refuse(path, "cannot follow the link", ELOOP);
}

/// A pipe, a terminal, a device: there is nothing to replace, its name must stay.
void write_straight(const std::filesystem::path& path, std::string_view bytes) {
  Descriptor file(path, O_WRONLY);
  if (file.get() < 0) refuse(path, "cannot open for writing", errno);
  int cause = write_all(file.get(), bytes);
  const int closing = file.close();
  if (cause == 0) cause = closing;
  if (cause != 0) refuse(path, "cannot write", cause);
}

}  // namespace

std::string read_file(const std::filesystem::path& path, const std::string& what, std::size_t largest) {
  std::string bytes;
  read_blocks(path, what, [&](std::string_view block) {
    bytes.append(block);
    if (bytes.size() > largest) {
      throw Error(ExitCode::bad_input, path.string() + ": too large for a " + what + "; allowed at most " +
                                           std::to_string(largest) + " bytes");
    }
  });
  return bytes;
}

void write_file(const std::filesystem::path& path, std::string_view bytes) {
  struct stat status = {};
  const bool there = ::stat(path.c_str(), &status) == 0;
  if (there && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode)) return write_straight(path, bytes);
  const std::filesystem::path target = behind_links(path);
  const std::filesystem::path temporary = target.string() + "." + std::to_string(::getpid()) + ".part";
  Descriptor file(temporary, O_WRONLY | O_CREAT | O_TRUNC);
  if (file.get() < 0) refuse(path, "cannot create the file", errno);
  int cause = write_all(file.get(), bytes);
  // Before the rename: else a crash could leave the new name with nothing behind it.
  if (cause == 0 && ::fsync(file.get()) != 0) cause = errno;
  const int closing = file.close();
  if (cause == 0) cause = closing;
  if (cause == 0 && std::rename(temporary.c_str(), target.c_str()) != 0) cause = errno;
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
