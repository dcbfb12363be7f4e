// SPDX-License-Identifier: MIT
// Only async-signal-safe work happens in the handlers.
#include "device/loop/stop_signals.hpp"

#include <time.h>

#include <atomic>
#include <cerrno>

namespace palpate::device {
namespace {

constexpr std::size_t kStack = 64 * 1024;

std::atomic<StopFlags*> flags_of_the_loop{nullptr};
std::atomic<void (*)()> last_of_all{nullptr};

extern "C" void on_stop(int signal) {
  StopFlags* flags = flags_of_the_loop.load();
  if (flags == nullptr) return;
  const bool again = (flags->requests() & TickInput::stop) != 0;
  if ((signal == SIGINT || signal == SIGTERM) && !again) {
    flags->stop();
  } else {
    flags->emergency_stop();
  }
}

// The handler is gone when this begins (SA_RESETHAND): what is raised here ends the program as if nothing had caught
// it.
extern "C" void on_crash(int signal) {
  if (StopFlags* flags = flags_of_the_loop.load()) flags->emergency_stop();
  timespec left{0, StopSignals::kHold * 1000000L};
  while (::nanosleep(&left, &left) != 0 && errno == EINTR) {
  }
  if (void (*last)() = last_of_all.load()) last();
  ::raise(signal);
}

bool is_crash(int signal) {
  return signal == SIGSEGV || signal == SIGBUS || signal == SIGFPE || signal == SIGILL || signal == SIGABRT;
}

}  // namespace

StopSignals::StopSignals(StopFlags& flags, void (*last)()) : stack_(new char[kStack]) {
  flags_of_the_loop.store(&flags);
  last_of_all.store(last);
  stack_t stack = {};
  stack.ss_sp = stack_.get();
  stack.ss_size = kStack;
  ::sigaltstack(&stack, &stack_before_);
  for (std::size_t k = 0; k < sizeof kSignals / sizeof kSignals[0]; ++k) {
    struct sigaction action = {};
    action.sa_handler = is_crash(kSignals[k]) ? on_crash : on_stop;
    sigemptyset(&action.sa_mask);
    action.sa_flags = is_crash(kSignals[k]) ? static_cast<int>(SA_RESETHAND | SA_ONSTACK) : SA_RESTART;
    ::sigaction(kSignals[k], &action, &before_[k]);
    // A program that writes to pipes and sockets looks at what write() says.
    if (kSignals[k] == SIGPIPE && before_[k].sa_handler == SIG_IGN) ::sigaction(SIGPIPE, &before_[k], nullptr);
  }
}

StopSignals::~StopSignals() {
  for (std::size_t k = 0; k < sizeof kSignals / sizeof kSignals[0]; ++k) ::sigaction(kSignals[k], &before_[k], nullptr);
  ::sigaltstack(&stack_before_, nullptr);
  flags_of_the_loop.store(nullptr);
  last_of_all.store(nullptr);
}

}  // namespace palpate::device
