// SPDX-License-Identifier: GPL-3.0-or-later
// The force thread makes no system call but its sleep: after a hundred ticks the kernel kills it for any other. A lock
// that had to wait would make one (futex).
#include "device/recording/run_writer.hpp"
#include "tests/device/loop/loop_child.hpp"
#include "tests/support/temporary_folder.hpp"

#include <gtest/gtest.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>

#include <csignal>

namespace palpate::test {
namespace {

constexpr int kRefused = 42;

// Reading the clock is no system call where the kernel's vDSO has it; where it has not, there is no other way.
bool allow_only_sleep() {
  sock_filter code[] = {BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
                        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, __NR_clock_nanosleep, 2, 0),
                        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, __NR_clock_gettime, 1, 0),
                        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_KILL_PROCESS),
                        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW)};
  sock_fprog program{static_cast<unsigned short>(std::size(code)), code};
  return ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

class Guarded : public KnownSource {
public:
  explicit Guarded(bool calls) : calls_(calls) {}
  device::Answer answer(const Sample& sample, double seconds) noexcept override {
    ++count_;
    if (count_ == 100 && !allow_only_sleep()) ::_exit(kRefused);
    if (count_ == 200 && calls_) ::syscall(SYS_getppid);
    return KnownSource::answer(sample, seconds);
  }

private:
  bool calls_;
  int count_ = 0;
};

/// How a child ends whose loop ran until it had given 1000 commands, or was killed.
int run_guarded(bool calls) {
  SharedMemory shared;
  const TemporaryFolder folder;
  const pid_t child = ::fork();
  if (child == 0) {
    device::RunHeader header;
    device::set_options(header, {}, {});
    device::RunWriter writer(folder.path() / "run", header);
    device::StopFlags flags;
    SharedDevice device(*shared);
    Guarded source(calls);
    device::LoopOptions options = short_ramp();
    options.safety.rate = 4000;
    device::ForceLoop loop(device, source, options, flags, &writer);
    loop.start();
    loop.join();
    ::_exit(0);
  }
  int status = 0;
  for (int k = 0; k < 20000; ++k) {
    if (::waitpid(child, &status, WNOHANG) == child) return status;
    if (shared->commands > 1000) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ::kill(child, SIGKILL);
  ::waitpid(child, &status, 0);
  return status;
}

TEST(LoopSystemCalls, ThereAreNoneButTheSleep) {
  const int caught = run_guarded(true);
  if (WIFEXITED(caught) && WEXITSTATUS(caught) == kRefused) GTEST_SKIP() << "seccomp is not allowed here";
  ASSERT_TRUE(WIFSIGNALED(caught));
  ASSERT_EQ(WTERMSIG(caught), SIGSYS) << "the guard does not guard";
  const int status = run_guarded(false);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(WTERMSIG(status), SIGKILL) << "a system call in the force thread";
}

}  // namespace
}  // namespace palpate::test
