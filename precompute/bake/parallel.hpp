// SPDX-License-Identifier: GPL-3.0-or-later
// Independent pieces of work on several threads.
#pragma once

#include <cstddef>
#include <functional>

namespace palpate::bake {

/// Calls work(k) for every k below `count`, on `threads` threads with this one among them, until `stop` (may be empty;
/// polled between pieces) says so: then false. An exception ends every thread after the piece it is in and is rethrown.
bool parallel_for(std::size_t count, unsigned threads, const std::function<bool()>& stop,
                  const std::function<void(std::size_t)>& work);
/// The same without an end before the last.
inline void parallel_for(std::size_t count, unsigned threads, const std::function<void(std::size_t)>& work) {
  parallel_for(count, threads, {}, work);
}

}  // namespace palpate::bake
