// SPDX-License-Identifier: GPL-3.0-or-later
// posix_spawn with one socket for input and output, because send() has a flag against SIGPIPE.
#include "precompute/mesh/volume/child_process.hpp"

#include "formats/io/error.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <system_error>
#include <thread>
#include <utility>

namespace palpate::mesh {
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

// A fault of the system or of the installation, not of the child's task.
[[noreturn]] void fail(const std::string& what, int error) {
  throw Error(ExitCode::io, what + ": " + std::generic_category().message(error));
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

constexpr const char* kTimeLimit = "time limit reached";
constexpr double kPatience = 10.0;  // longest wait over the processor time allowed

// Counts the time down in which this process waits: what passes while it is stopped itself (Ctrl-Z) is not counted.
class Patience {
public:
  explicit Patience(double seconds) : left_(seconds) {}
  bool over() {
    const Clock::time_point now = Clock::now();
    left_ -= std::min(std::chrono::duration<double>(now - last_).count(), 2 * kSlice);
    last_ = now;
    return left_ <= 0;
  }
  /// Milliseconds until the next check.
  [[nodiscard]] int slice() const { return 1 + static_cast<int>(1e3 * std::min(left_, kSlice)); }

private:
  using Clock = std::chrono::steady_clock;
  static constexpr double kSlice = 1.0;  // s
  double left_;
  Clock::time_point last_ = Clock::now();
};

// Lowers one limit of a process, and its hard limit; one that has ended already needs none.
void limit(const std::string& program, pid_t pid, decltype(RLIMIT_CPU) what, double most, double hard) {
  const auto lower = [](double value, rlim_t bound) {
    return value < static_cast<double>(bound) ? static_cast<rlim_t>(value) : bound;
  };
  rlimit now{};
  bool done = ::prlimit(pid, what, nullptr, &now) == 0;
  if (done) {
    const rlimit wanted{lower(most, now.rlim_cur), lower(hard, now.rlim_max)};
    done = ::prlimit(pid, what, &wanted, nullptr) == 0;
  }
  if (!done && errno != ESRCH) fail(program + ": cannot be limited", errno);
}

std::vector<char*> pointers(std::vector<std::string>& words) {
  std::vector<char*> all;
  for (std::string& word : words) all.push_back(word.data());
  all.push_back(nullptr);
  return all;
}

// Ours, and in the place of some its own.
std::vector<std::string> variables_of(const ChildStart& start) {
  std::vector<std::string> all = start.environment;
  for (char** ours = environ; *ours != nullptr; ++ours) {
    const std::string variable = *ours, name = variable.substr(0, variable.find('=') + 1);
    const bool given = std::any_of(start.environment.begin(), start.environment.end(),
                                   [&](const std::string& v) { return v.compare(0, name.size(), name) == 0; });
    if (!given) all.push_back(variable);
  }
  return all;
}

// A started program; it ends with this object at the latest.
class Child {
public:
  Child(const std::filesystem::path& program, int socket, int error, const ChildLimits& limits,
        const ChildStart& start) {
    SpawnSettings settings;
    if (!start.folder.empty()) posix_spawn_file_actions_addchdir_np(&settings.actions, start.folder.c_str());
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
    const std::string path = program.string();
    std::vector<std::string> words{path};
    words.insert(words.end(), start.arguments.begin(), start.arguments.end());
    std::vector<std::string> variables = variables_of(start);
    const int failed = posix_spawn(&pid_, path.c_str(), &settings.actions, &settings.attributes, pointers(words).data(),
                                   pointers(variables).data());
    if (failed != 0) {
      pid_ = -1;
      fail(path + ": cannot be started", failed);
    }
    try {
      // The signal at the soft limit is distinct from other ends; the hard limit kills a child that ignores it.
      const double seconds = std::max(std::ceil(limits.cpu_time), 1.0);
      limit(path, pid_, RLIMIT_CPU, seconds, seconds + 1);
      if (limits.memory > 0) {
        const auto bytes = static_cast<double>(limits.memory);
        limit(path, pid_, RLIMIT_AS, bytes, bytes);
      }
    } catch (...) {
      kill();
      throw;
    }
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() { kill(); }

  void kill() noexcept {
    if (pid_ < 0) return;
    ::kill(-pid_, SIGKILL);
    while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
  }

  // Waits for its end and gives the cause of a bad one.
  std::string reap(Patience& patience, double& cpu_time) {
    int status = 0;
    rusage used{};
    for (pid_t got = 0; got != pid_;) {
      got = ::wait4(pid_, &status, WNOHANG, &used);
      if (got < 0 && errno != EINTR) fail("waitpid", errno);
      if (got == pid_) continue;
      if (patience.over()) {
        kill();
        return kTimeLimit;
      }
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
    pid_ = -1;
    const auto seconds = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
    cpu_time = seconds(used.ru_utime) + seconds(used.ru_stime);
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU) return kTimeLimit;
    if (WIFSIGNALED(status)) return "ended by signal " + std::to_string(WTERMSIG(status));
    if (WEXITSTATUS(status) != 0) return "exit status " + std::to_string(WEXITSTATUS(status));
    return {};
  }

private:
  pid_t pid_ = -1;
};

// Moves bytes both ways until the child closes both of its outputs. Gives a cause when it must be killed.
std::string converse(Descriptor& socket, Descriptor& error, const std::vector<char>& input, Patience& patience,
                     std::size_t most_output, ChildResult& result) {
  std::size_t sent = 0;
  std::array<char, 65536> buffer;
  const auto shut_when_sent = [&] {
    if (sent == input.size()) ::shutdown(socket.get(), SHUT_WR);
  };
  shut_when_sent();
  while (socket.open() || error.open()) {
    if (patience.over()) return kTimeLimit;
    const auto wanted = static_cast<short>(sent < input.size() ? POLLIN | POLLOUT : POLLIN);
    pollfd wait[2] = {{socket.get(), wanted, 0}, {error.get(), POLLIN, 0}};
    const int ready = ::poll(wait, 2, patience.slice());
    if (ready < 0 && errno != EINTR) fail("poll", errno);
    if (ready <= 0) continue;
    if ((wait[0].revents & POLLOUT) != 0 && sent < input.size()) {
      const ssize_t n = ::send(socket.get(), input.data() + sent, input.size() - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
      if (n >= 0) {
        sent += static_cast<std::size_t>(n);
      } else if (errno == EPIPE || errno == ECONNRESET) {
        sent = input.size();  // it reads no more; its exit status says why
      } else if (errno != EAGAIN && errno != EINTR) {
        fail("send", errno);
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

}  // namespace

ChildResult run_child(const std::filesystem::path& program, const std::vector<char>& input, const ChildLimits& limits,
                      const ChildStart& start) {
  int pair[2], tube[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) != 0) fail(program.string() + ": socketpair", errno);
  Descriptor socket(pair[0]), far(pair[1]);
  if (::pipe2(tube, O_CLOEXEC) != 0) fail(program.string() + ": pipe2", errno);
  Descriptor error(tube[0]), far_error(tube[1]);

  Patience patience(kPatience * limits.cpu_time);
  Child child(program, far.get(), far_error.get(), limits, start);
  far.close();
  far_error.close();
  ChildResult result;
  result.cause = converse(socket, error, input, patience, limits.output, result);
  if (result.cause.empty()) result.cause = child.reap(patience, result.cpu_time);
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

}  // namespace palpate::mesh
