// SPDX-License-Identifier: GPL-3.0-or-later
// runtime_battery TICKS[:SEED] FILE...: the property battery on response files, so many ticks for each tool, driver and
// motion, as two tables in Markdown (battery.md); exits 5 where a promise is broken. Another SEED (1 unless told) draws
// other motions. A file more is named by PALPATE_BATTERY_FILE.
#include <cinttypes>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <vector>

#include "palpate/format/mapped_file.hpp"
#include "tests/runtime/battery.hpp"

namespace palpate::test {
namespace {

constexpr Motion kMotions[] = {Motion::press, Motion::graze, Motion::corner, Motion::turn, Motion::fast};

double percent(std::uint64_t part, std::uint64_t whole) {
  return whole > 0 ? 100.0 * static_cast<double>(part) / static_cast<double>(whole) : 0;
}

/// Rows of one text.
class Rows {
public:
  [[gnu::format(printf, 2, 3)]] void print(const char* format, ...) {
    char text[400];
    std::va_list values;
    va_start(values, format);
    std::vsnprintf(text, sizeof text, format, values);
    va_end(values);
    all_ += text;
  }
  [[nodiscard]] const char* text() const { return all_.c_str(); }

private:
  std::string all_;
};

/// A row a tool: of all its drivers and motions at once, and, of the driver that searches itself, what the energy
/// account does.
struct Tables {
  std::uint64_t ticks = 0;
  int broken = 0;  ///< promises, which are told as they come
  unsigned seed = 1;
  Rows promises, account;

  void add(const char* file, std::uint64_t each, const runtime::View& view, std::uint32_t tool) {
    BatteryResult fine, fast;  // apart, for a step is another thing in fast motions
    for (const Driver driver : {Driver::alone, Driver::late, Driver::online, Driver::several}) {
      for (const Motion motion : kMotions) {
        const BatteryCase c{motion, driver, tool, each, seed + tool, 0.25};
        const BatteryResult r = run_battery(view, c);
        if (const std::string fault = broken_promise(c, r); !fault.empty()) {
          ++broken;
          std::fprintf(stderr, "%s %s %s %s: %s\n", file, view.tools[tool].name, name(driver), name(motion),
                       fault.c_str());
        }
        (motion == Motion::fast ? fast : fine).add(r);
        if (driver == Driver::alone) add_account(file, view, c, r);
      }
    }
    BatteryResult all = fine;
    all.add(fast);
    promises.print("| %s %s | %.0f %% | %.0f %% | %.2f | %.2f | %.2f | %.1g | %.1g | %.1g | %.1g | %016" PRIx64 " |\n",
                   file, view.tools[tool].name, percent(all.touching, all.ticks), percent(all.sliding, all.ticks),
                   all.force, fine.step, fast.step, all.begin, fine.gain, fast.gain, all.drag, all.hash);
    ticks += all.ticks;
  }

private:
  void add_account(const char* file, const runtime::View& view, const BatteryCase& c, const BatteryResult& r) {
    if (c.motion == kMotions[0]) account.print("| %s %s |", file, view.tools[c.tool].name);
    account.print(" %.3f %%", percent(r.acting, r.touching));
    if (r.gross > 0) account.print(" (%.2g %%)", 100 * r.lost / r.gross);
    account.print(c.motion == Motion::fast ? " |\n" : " |");
  }
};

}  // namespace
}  // namespace palpate::test

int main(int argc, char** argv) {
  std::vector<std::string> files(argv + (argc < 2 ? argc : 2), argv + argc);
  if (const char* more = std::getenv("PALPATE_BATTERY_FILE")) files.emplace_back(more);
  char* rest = nullptr;
  const std::uint64_t ticks = argc < 2 ? 0 : std::strtoull(argv[1], &rest, 10);
  palpate::test::Tables tables;
  if (ticks > 0 && *rest == ':') tables.seed = static_cast<unsigned>(std::strtoul(rest + 1, &rest, 10));
  if (ticks == 0 || *rest != 0 || tables.seed == 0 || files.empty()) {
    return std::fprintf(stderr, "usage: runtime_battery TICKS[:SEED] FILE...\n"), 1;
  }
  for (const std::string& file : files) {
    const palpate::runtime::MappedFile bytes(file.c_str());
    const palpate::runtime::OpenResult opened = palpate::runtime::View::open(bytes.data(), bytes.size());
    if (!opened) return std::fprintf(stderr, "%s: %s\n", file.c_str(), opened.error), 2;
    const std::string stem = std::filesystem::path(file).stem().string();
    for (std::uint32_t tool = 0; tool < opened.view.meta->tool_count; ++tool) {
      tables.add(stem.c_str(), ticks, opened.view, tool);
    }
  }
  std::printf(
      "| file, tool | touching | sliding | force | step | step, fast | begin or end | gain | gain, fast | drag | bits "
      "|\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n%s\n"
      "The energy account acts in this share of the touching ticks, and takes this share of the work:\n\n"
      "| file, tool | press | graze | corner | turn | fast |\n"
      "| --- | --- | --- | --- | --- | --- |\n%s\n%" PRIu64 " ticks, %d broken promises\n",
      tables.promises.text(), tables.account.text(), tables.ticks, tables.broken);
  return tables.broken == 0 ? 0 : 5;
}
