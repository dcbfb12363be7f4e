// SPDX-License-Identifier: GPL-3.0-or-later
// runtime_battery TICKS FILE...: the property battery on response files, so many ticks for each tool, driver and
// motion, as a table in Markdown (battery.md); exits 5 where a promise is broken. A file more is named by
// PALPATE_BATTERY_FILE.
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <vector>

#include "palpate/mapped_file.hpp"
#include "tests/runtime/battery.hpp"

namespace palpate::test {
namespace {

/// One row a tool, of all its drivers and motions. Returns the number of broken promises, which are told as they come.
int run(const std::string& file, std::uint64_t ticks, const runtime::View& view, std::uint64_t& total) {
  int broken = 0;
  for (std::uint32_t tool = 0; tool < view.meta->tool_count; ++tool) {
    BatteryResult fine, fast;  // apart, for a step is another thing in fast motions
    for (const Driver driver : {Driver::alone, Driver::late, Driver::online}) {
      for (const Motion motion : {Motion::press, Motion::graze, Motion::corner, Motion::turn, Motion::fast}) {
        const BatteryCase c{motion, driver, tool, ticks, 1 + tool, 0.25};
        const BatteryResult r = run_battery(view, c);
        if (const std::string fault = broken_promise(c, r); !fault.empty()) {
          ++broken;
          std::fprintf(stderr, "%s %s %s %s: %s\n", file.c_str(), view.tools[tool].name, name(driver), name(motion),
                       fault.c_str());
        }
        (motion == Motion::fast ? fast : fine).add(r);
      }
    }
    BatteryResult all = fine;
    all.add(fast);
    const auto percent = [&](std::uint64_t n) {
      return 100.0 * static_cast<double>(n) / static_cast<double>(all.ticks);
    };
    std::printf("| %s %s | %.0f %% | %.0f %% | %.2f | %.2f | %.2f | %.1g | %.1g | %.1g | %016" PRIx64 " |\n",
                file.c_str(), view.tools[tool].name, percent(all.touching), percent(all.sliding), all.force, fine.step,
                fast.step, all.begin, all.gain, all.drag, all.hash);
    std::fflush(stdout);
    total += all.ticks;
  }
  return broken;
}

}  // namespace
}  // namespace palpate::test

int main(int argc, char** argv) {
  std::vector<std::string> files(argv + (argc < 2 ? argc : 2), argv + argc);
  if (const char* more = std::getenv("PALPATE_BATTERY_FILE")) files.emplace_back(more);
  const std::uint64_t ticks = argc < 2 ? 0 : std::strtoull(argv[1], nullptr, 10);
  if (ticks == 0 || files.empty()) return std::fprintf(stderr, "usage: runtime_battery TICKS FILE...\n"), 1;
  std::printf(
      "| file, tool | touching | sliding | force | step | step, fast | begin or end | gain | drag | bits |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
  std::uint64_t total = 0;
  int broken = 0;
  for (const std::string& file : files) {
    const palpate::runtime::MappedFile bytes(file.c_str());
    const palpate::runtime::OpenResult opened = palpate::runtime::View::open(bytes.data(), bytes.size());
    if (!opened) return std::fprintf(stderr, "%s: %s\n", file.c_str(), opened.error), 2;
    broken += palpate::test::run(std::filesystem::path(file).stem().string(), ticks, opened.view, total);
  }
  std::printf("\n%" PRIu64 " ticks, %d broken promises\n", total, broken);
  return broken == 0 ? 0 : 5;
}
