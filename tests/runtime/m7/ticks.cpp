// SPDX-License-Identifier: GPL-3.0-or-later
// On the board: ticks all tools of the response files in flash, and writes the records to standard output.
#include "tests/runtime/m7/ticks.hpp"

#include <cstdio>

#include "tests/runtime/m7/clock.hpp"

extern "C" const unsigned char files_begin[], files_end[];  // one after the other

namespace palpate::test {
namespace {

// Those of the sample files, the fewest first.
struct Program {
  std::uint32_t features;
  ProgramTick (*begin)(const runtime::View&, std::uint32_t tool);
};
constexpr Program kPrograms[] = {{0, begin_program<0>},    {1, begin_program<1>},   {2, begin_program<2>},
                                 {4, begin_program<4>},    {3, begin_program<3>},   {6, begin_program<6>},
                                 {7, begin_program<7>},    {11, begin_program<11>}, {71, begin_program<71>},
                                 {131, begin_program<131>}};

ProgramTick begin(const runtime::View& view, std::uint32_t tool) {
  const std::uint32_t needed = view.features & ~layout::kFeaturesBesideContacts;
  for (const Program& program : kPrograms) {
    if ((needed & ~program.features) == 0) return program.begin(view, tool);
  }
  return nullptr;
}

}  // namespace
}  // namespace palpate::test

int main() {
  using namespace palpate;
  const test::Clock clock;
  if (!clock.counts()) return 1;
  for (const unsigned char* file = files_begin; file < files_end;) {
    const auto size = static_cast<std::size_t>(reinterpret_cast<const layout::FileHeader*>(file)->file_size);
    const runtime::OpenResult opened = runtime::View::open(file, size);
    if (!opened) return std::fprintf(stderr, "%s\n", opened.error), 2;
    test::tick_all(opened.view, clock, test::begin,
                   [](const test::TickRecord& r, test::Hand) { std::fwrite(&r, sizeof r, 1, stdout); });
    file += size;
  }
}
