// SPDX-License-Identifier: GPL-3.0-or-later
// On the board: the longest of many ticks of all tools of the response files in flash, a line each.
#include <cstdio>

#include "tests/runtime/m7/clock.hpp"
#include "tests/runtime/m7/ticks.hpp"

extern "C" const unsigned char files_begin[], files_end[];  // one after the other

int main() {
  using namespace palpate;
  constexpr int kTicks = 8000;
  const test::Clock clock;
  if (!clock.counts()) return 1;
  for (const unsigned char* file = files_begin; file < files_end;) {
    const auto size = static_cast<std::size_t>(reinterpret_cast<const layout::FileHeader*>(file)->file_size);
    const runtime::OpenResult opened = runtime::View::open(file, size);
    if (!opened) return std::fprintf(stderr, "%s\n", opened.error), 2;
    for (std::uint32_t tool = 0; tool < opened.view.meta->tool_count; ++tool) {
      for (int hand = 0; hand < 3; ++hand) {
        const std::uint32_t most = test::longest_tick(opened.view, tool, static_cast<test::Hand>(hand), kTicks, clock);
        std::printf("%u\n", unsigned(most));
      }
    }
    file += size;
  }
}
