// SPDX-License-Identifier: GPL-3.0-or-later
#include "precompute/bake/parallel.hpp"

#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace palpate::bake {

bool parallel_for(std::size_t count, unsigned threads, const std::function<bool()>& stop,
                  const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next{0};
  std::atomic<bool> halt{false}, stopped{false};
  std::exception_ptr failure;
  std::mutex guard;
  const auto run = [&] {
    try {
      for (std::size_t k = next++; k < count && !halt; k = next++) {
        if (stop && stop()) {
          stopped = halt = true;
          return;
        }
        work(k);
      }
    } catch (...) {  // kept whole, rethrown by the calling thread; the others end after the piece they are in
      halt = true;
      const std::lock_guard lock(guard);
      if (!failure) failure = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> others;
    // If a thread cannot be started, the running ones are stopped and joined on the way out.
    try {
      for (unsigned k = 1; k < threads; ++k) others.emplace_back(run);
    } catch (...) {
      halt = true;
      throw;
    }
    run();
  }
  if (failure) std::rethrow_exception(failure);
  return !stopped;
}

}  // namespace palpate::bake
