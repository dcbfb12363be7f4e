// SPDX-License-Identifier: GPL-3.0-or-later
// posix_spawn with one socket for input and output: send() can be told not to raise SIGPIPE.
#include "precompute/mesh/child_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <system_error>
#include <thread>
#include <utility>

namespace palpate {
namespace {

class Descriptor {
public:
  Descriptor() = default;
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    close();
    fd_ = std::exchange(other.fd_, -1);
    return *this;
  }
  ~Descriptor() { close(); }
  void close() {
    if (fd_ >= 0) ::close(fd_);
    fd_ = -1;
  }
  [[nodiscard]] int get() const { return fd_; }
  [[nodiscard]] bool open() const { return fd_ >= 0; }

private:
  int fd_ = -1;
};

std::string system_cause(const char* what, int error) {
  return std::string(what) + ": " + std::generic_category().message(error);
}

struct SpawnSettings {
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  SpawnSettings() {
    posix_spawn_file_actions_init(&actions);
    posix_spawnattr_init(&attributes);
  }
  SpawnSettings(const SpawnSettings&) = delete;
  SpawnSettings& operator=(const SpawnSettings&) = delete;
  ~SpawnSettings() {
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
  }
};

int spawn(const std::filesystem::path& program, int socket, int error, pid_t& pid) {
  SpawnSettings settings;
  posix_spawn_file_actions_adddup2(&settings.actions, socket, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&settings.actions, socket, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&settings.actions, error, STDERR_FILENO);
  sigset_t none, all;
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawnattr_setsigmask(&settings.attributes, &none);
  posix_spawnattr_setsigdefault(&settings.attributes, &all);
  posix_spawnattr_setpgroup(&settings.attributes, 0);
  posix_spawnattr_setflags(&settings.attributes,
                           POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  std::string path = program.string();
  char* const arguments[] = {path.data(), nullptr};
  return posix_spawn(&pid, path.c_str(), &settings.actions, &settings.attributes, arguments, environ);
}

using Clock = std::chrono::steady_clock;

// Moves bytes both ways until the child closes both of its outputs. Gives a cause when it must be killed.
std::string converse(Descriptor& socket, Descriptor& error, const std::vector<char>& input, Clock::time_point deadline,
                     std::size_t most_output, ChildResult& result) {
  std::size_t sent = 0;
  std::array<char, 65536> buffer;
  const auto shut_when_sent = [&] {
    if (sent == input.size()) ::shutdown(socket.get(), SHUT_WR);
  };
  shut_when_sent();
  while (socket.open() || error.open()) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0) return "time limit reached";
    const auto wanted = static_cast<short>(sent < input.size() ? POLLIN | POLLOUT : POLLIN);
    pollfd wait[2] = {{socket.get(), wanted, 0}, {error.get(), POLLIN, 0}};
    const int ready = ::poll(wait, 2, static_cast<int>(std::min<long long>(left, 1000)));
    if (ready < 0 && errno != EINTR) return system_cause("poll", errno);
    if (ready <= 0) continue;
    if ((wait[0].revents & POLLOUT) != 0 && sent < input.size()) {
      const ssize_t n = ::send(socket.get(), input.data() + sent, input.size() - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
      if (n >= 0) {
        sent += static_cast<std::size_t>(n);
      } else if (errno == EPIPE || errno == ECONNRESET) {
        sent = input.size();  // it reads no more; its exit status says why
      } else if (errno != EAGAIN && errno != EINTR) {
        return system_cause("send", errno);
      }
      shut_when_sent();
    }
    if ((wait[0].revents & (POLLIN | POLLHUP | POLLERR)) != 0) {
      const ssize_t n = ::recv(socket.get(), buffer.data(), buffer.size(), MSG_DONTWAIT);
      if (n > 0) {
        result.output.insert(result.output.end(), buffer.data(), buffer.data() + n);
        if (result.output.size() > most_output) return "more output than expected";
      } else if (n == 0 || (errno != EAGAIN && errno != EINTR)) {
        socket.close();
      }
    }
    if ((wait[1].revents & (POLLIN | POLLHUP | POLLERR)) != 0) {
      const ssize_t n = ::read(error.get(), buffer.data(), buffer.size());
      if (n > 0) {
        result.messages.append(buffer.data(), static_cast<std::size_t>(n));
        if (result.messages.size() > 8192) result.messages.erase(0, result.messages.size() - 4096);
      } else if (n == 0 || errno != EINTR) {
        error.close();
      }
    }
  }
  return {};
}

// Waits for the end of the child, killing it at the deadline or at once when it `must_die`.
std::string reap(pid_t pid, bool must_die, Clock::time_point deadline) {
  if (must_die) ::kill(-pid, SIGKILL);
  int status = 0;
  for (;;) {
    const pid_t got = ::waitpid(pid, &status, must_die ? 0 : WNOHANG);
    if (got == pid) break;
    if (got < 0 && errno != EINTR) return system_cause("waitpid", errno);
    if (got == 0) {
      if (Clock::now() >= deadline) {
        ::kill(-pid, SIGKILL);
        must_die = true;
      } else {
        std::this_thread::sleep_for(std::chrono::microseconds(200));
      }
    }
  }
  if (WIFSIGNALED(status)) return "ended by signal " + std::to_string(WTERMSIG(status));
  if (WEXITSTATUS(status) != 0) return "exit status " + std::to_string(WEXITSTATUS(status));
  return {};
}

}  // namespace

ChildResult run_child(const std::filesystem::path& program, const std::vector<char>& input, double time_limit,
                      std::size_t most_output) {
  ChildResult result;
  int pair[2], tube[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) != 0) {
    result.cause = system_cause("socketpair", errno);
    return result;
  }
  Descriptor socket(pair[0]), far(pair[1]);
  if (::pipe2(tube, O_CLOEXEC) != 0) {
    result.cause = system_cause("pipe2", errno);
    return result;
  }
  Descriptor error(tube[0]), far_error(tube[1]);

  const double bounded = std::clamp(time_limit, 0.0, 1e6);
  const auto deadline =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(bounded));
  pid_t pid = -1;
  if (const int failed = spawn(program, far.get(), far_error.get(), pid); failed != 0) {
    result.cause = system_cause(program.string().c_str(), failed);
    return result;
  }
  far.close();
  far_error.close();
  const std::string broken = converse(socket, error, input, deadline, most_output, result);
  const std::string ended = reap(pid, !broken.empty(), deadline);
  result.cause = broken.empty() ? ended : broken;
  result.finished = result.cause.empty();
  return result;
}

std::filesystem::path find_helper(const std::string& name) {
  std::error_code failed;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", failed);
  if (failed) return {};
  const std::filesystem::path folder = self.parent_path();
  for (const auto& at : {folder / name, folder.parent_path() / "libexec" / "palpate" / name}) {
    if (std::filesystem::is_regular_file(at, failed)) return at;
  }
  return {};
}

}  // namespace palpate
