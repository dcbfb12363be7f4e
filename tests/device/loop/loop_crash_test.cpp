// SPDX-License-Identifier: GPL-3.0-or-later
// Signals: Ctrl-C once and twice, and what a program that crashes still does.
#include "device/loop/stop_signals.hpp"
#include "tests/device/loop/loop_child.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

namespace palpate::test {
namespace {

using device::StopFlags;
using device::StopSignals;
using device::TickInput;

TEST(StopSignals, TheFirstAsksAndTheSecondIsAnEmergency) {
  for (const int signal : {SIGINT, SIGTERM}) {
    StopFlags flags;
    const StopSignals signals(flags);
    std::raise(signal);
    EXPECT_EQ(flags.requests(), TickInput::stop);
    std::raise(signal);
    EXPECT_EQ(flags.requests(), TickInput::stop | TickInput::emergency_stop);
  }
  for (const int signal : {SIGHUP, SIGQUIT, SIGTSTP, SIGPIPE}) {
    StopFlags flags;
    const StopSignals signals(flags);
    std::raise(signal);
    EXPECT_EQ(flags.requests(), TickInput::emergency_stop) << signal;
  }
}

TEST(StopSignals, APipeThatIsIgnoredStaysSo) {
  std::signal(SIGPIPE, SIG_IGN);
  {
    StopFlags flags;
    const StopSignals signals(flags);
    std::raise(SIGPIPE);
    EXPECT_EQ(flags.requests(), 0);
  }
  EXPECT_EQ(std::signal(SIGPIPE, SIG_DFL), SIG_IGN);
}

TEST(StopSignals, AreAsBeforeAfterwards) {
  const auto mine = [](int) {};
  std::signal(SIGINT, mine);
  {
    StopFlags flags;
    const StopSignals signals(flags);
  }
  EXPECT_EQ(std::signal(SIGINT, SIG_DFL), static_cast<void (*)(int)>(mine));
}

/// A real SIGSEGV. Through a null pointer it would be undefined, and a sanitizer's to end.
void touch_forbidden_memory() {
  void* page = ::mmap(nullptr, 1, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  *static_cast<volatile char*>(page) = 1;
}

/// Runs a loop with a force in a child that then crashes by itself; how the child ended.
template <class Crash>
int crash_in_child(Shared& shared, const Crash& crash) {
  const pid_t child = ::fork();
  if (child == 0) {
    StopFlags flags;
    const StopSignals signals(flags);
    SharedDevice device(shared);
    KnownSource source;
    device::ForceLoop loop(device, source, short_ramp(), flags);
    loop.start();
    wait_for(shared.pushed);
    crash();
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return status;
}

TEST(Crash, OfAnyOtherThreadSendsZeroAndEndsAsItWould) {
  const std::function<void()> crashes[] = {[] { touch_forbidden_memory(); }, [] { std::abort(); },
                                           [] { std::raise(SIGFPE); }};
  const int ends[] = {SIGSEGV, SIGABRT, SIGFPE};
  for (int k = 0; k < 3; ++k) {
    SharedMemory shared;
    const int status = crash_in_child(*shared, crashes[k]);
    EXPECT_TRUE(shared->pushed);
    EXPECT_TRUE(WIFSIGNALED(status));
    EXPECT_EQ(WTERMSIG(status), ends[k]);
    EXPECT_EQ(shared->force, 0) << "the hand was left with a force";
  }
}

TEST(Crash, HasALastWord) {
  static int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    StopFlags flags;
    const StopSignals signals(flags, [] { (void)!::write(ends[1], "!", 1); });
    std::abort();
  }
  ::close(ends[1]);
  char word[2] = {};
  EXPECT_EQ(::read(ends[0], word, sizeof word), 1);
  ::close(ends[0]);
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(WTERMSIG(status), SIGABRT);
}

// The thread that speaks with a device goes on meanwhile and takes commands for stale.
TEST(Crash, OfTheForceThreadLeavesTimeForTheStalenessRule) {
  class Crashes : public KnownSource {
  public:
    device::Answer answer(const Sample& sample, double seconds) noexcept override {
      if (++calls_ == 100) touch_forbidden_memory();
      return KnownSource::answer(sample, seconds);
    }

  private:
    int calls_ = 0;
  };
  // A machine that does much else may hold any thread up for longer: one of some trials counts.
  bool released = false;
  for (int k = 0; k < 6 && !released; ++k) {
    SharedMemory shared;
    const pid_t child = ::fork();
    if (child == 0) {
      StopFlags flags;
      const StopSignals signals(flags);
      SharedDevice device(*shared);
      Crashes source;
      std::thread speaks([&] {
        for (;;) {
          if (shared->pushed && device::now() - shared->last > device::kStale) shared->force = 0;
          std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
      });
      device::ForceLoop loop(device, source, short_ramp(), flags);
      loop.start();
      loop.join();
      ::_exit(0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_TRUE(shared->pushed);
    EXPECT_EQ(WTERMSIG(status), SIGSEGV);
    released = shared->force == 0;
  }
  EXPECT_TRUE(released);
}

}  // namespace
}  // namespace palpate::test
