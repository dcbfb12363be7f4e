// SPDX-License-Identifier: GPL-3.0-or-later
// fork and exec; output through files, so that no pipe can fill up.
#include "tests/support/run_program.hpp"

#include "tests/support/temporary_folder.hpp"

#include <fcntl.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <thread>

namespace palpate::test {

namespace {

constexpr int kCannotStart = 126, kCannotMount = 125;

bool redirect(const std::filesystem::path& file, int descriptor) {
  const int opened = ::open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
  return opened >= 0 && ::dup2(opened, descriptor) >= 0;
}

/// In the child, never returns.
[[noreturn]] void start(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                        const RunOptions& options, const std::filesystem::path& out,
                        const std::filesystem::path& error) {
  std::vector<char*> argv{const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  for (const std::string& variable : options.environment) ::putenv(const_cast<char*>(variable.c_str()));
  if (!redirect(out, STDOUT_FILENO) || !redirect(error, STDERR_FILENO)) ::_exit(kCannotStart);
  if (!options.folder.empty() && ::chdir(options.folder.c_str()) != 0) ::_exit(kCannotStart);
  if (!options.small_disk.empty()) {
    // In a mount name space of the child's own: it goes away with it.
    if (::unshare(CLONE_NEWNS) != 0 || ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
        ::mount("tmpfs", options.small_disk.c_str(), "tmpfs", 0, "size=64k") != 0) {
      ::_exit(kCannotMount);
    }
  }
  if (options.file_limit) {
    const rlimit limit{*options.file_limit, *options.file_limit};
    if (::setrlimit(RLIMIT_FSIZE, &limit) != 0) ::_exit(kCannotStart);
  }
  ::execv(program.c_str(), argv.data());
  ::_exit(kCannotStart);
}

}  // namespace

RunResult run_program(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                      const RunOptions& options) {
  using Clock = std::chrono::steady_clock;
  const TemporaryFolder folder;
  const auto out = options.output.empty() ? folder.path() / "out" : options.output;
  const auto error = folder.path() / "error";
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("cannot fork");
  if (child == 0) start(program, arguments, options, out, error);

  RunResult result;
  const auto begin = Clock::now();
  bool interrupted = false;
  int status = 0;
  for (;;) {
    const pid_t ended = ::waitpid(child, &status, WNOHANG);
    if (ended < 0) throw std::runtime_error("cannot wait for " + program.string());
    if (ended == child) break;
    const auto elapsed = Clock::now() - begin;
    if (options.interrupt && !interrupted && elapsed > *options.interrupt) {
      ::kill(child, SIGINT);
      interrupted = true;
    }
    if (!result.timed_out && elapsed > std::chrono::duration<double>(options.time_limit)) {
      ::kill(child, SIGKILL);
      result.timed_out = true;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  if (WIFEXITED(status)) result.exit_code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) result.signal = WTERMSIG(status);
  result.mounted = options.small_disk.empty() || result.exit_code != kCannotMount;
  if (result.exit_code == kCannotStart) throw std::runtime_error("cannot start " + program.string());
  if (options.output.empty()) result.out = file_content(out);
  result.error = file_content(error);
  return result;
}

}  // namespace palpate::test
