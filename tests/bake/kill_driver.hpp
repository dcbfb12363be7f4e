// SPDX-License-Identifier: GPL-3.0-or-later
// Runs work in a child process, to its end or until SIGKILL at a chosen moment.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <stdexcept>
#include <thread>

namespace palpate::test {

enum class ChildEnd { killed, done, failed };

/// Forks and runs `work` in the child. Call it while this process has no other thread.
template <class Work>
pid_t start_child(const Work& work) {
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("cannot fork");
  if (child > 0) return child;
  try {
    work();
  } catch (const std::exception& error) {
    std::cerr << "child: " << error.what() << std::endl;
    std::_Exit(1);
  }
  std::_Exit(0);
}

inline ChildEnd wait_for(pid_t child) {
  int status = 0;
  if (::waitpid(child, &status, 0) != child) throw std::runtime_error("cannot wait for the child");
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL) return ChildEnd::killed;
  return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? ChildEnd::done : ChildEnd::failed;
}

/// Runs `work` to its end.
template <class Work>
ChildEnd run_child(const Work& work) {
  return wait_for(start_child(work));
}

/// Kills `work` after `delay` unless it was done before.
template <class Work>
ChildEnd run_and_kill(const Work& work, std::chrono::microseconds delay) {
  const pid_t child = start_child(work);
  std::this_thread::sleep_for(delay);
  ::kill(child, SIGKILL);
  return wait_for(child);
}

}  // namespace palpate::test
