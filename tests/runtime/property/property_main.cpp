// SPDX-License-Identifier: GPL-3.0-or-later
// runtime_property TICKS[:SEED] FILE...: the property test on response files, as tables in Markdown. TICKS are those of
// each tool, driver and motion. SEED (1 by default) selects other motions. PALPATE_PROPERTY_FILE names one file more.
// Exit code 5: a promise is broken; the cases are written to standard error.
#include <cinttypes>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "palpate/format/mapped_file.hpp"
#include "palpate/format/open.hpp"
#include "tests/runtime/property/organ_motions.hpp"
#include "tests/runtime/property/property.hpp"

namespace palpate::test {
namespace {

double percent(std::uint64_t part, std::uint64_t whole) {
  return whole > 0 ? 100.0 * static_cast<double>(part) / static_cast<double>(whole) : 0;
}

/// Rows of one table.
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

/// One row a tool in each table.
struct Tables {
  unsigned seed = 1;
  std::uint64_t ticks = 0;
  int broken = 0;
  Rows motions, presses, slides;

  void add(const std::string& file, std::uint64_t each, const runtime::View& view, std::uint32_t tool) {
    const double friction = stiffest(view, tool).friction;
    const char* const tool_name = view.tools[tool].name;
    PropertyResult fine, fast;  // the bounds of fast motions differ
    for (const Driver driver : kDrivers) {
      for (const Motion motion : kMotions) {
        const PropertyCase c{motion, driver, tool, each, seed + tool, 0.25};
        const PropertyResult r = run_property(view, c);
        report(broken_promise(c, r, friction),
               "%s %s %s %s, seed %u: force %.2f, step %.2f, jump %.2f, onset %.2g, gain %.2g, drive %.2g", file.c_str(),
               tool_name, name(driver), name(motion), c.seed, r.force, r.step, r.jump, r.onset, r.gain, r.drive);
        (motion == Motion::fast ? fast : fine).add(r);
      }
    }
    PropertyResult all = fine;
    all.add(fast);
    motions.print("| %s %s | %.0f %% | %.0f %% | %.2f | %.2f | %.2f | %.2f | %.1g | %.1g | %.1g | %.1g | %016" PRIx64 " |\n",
                  file.c_str(), tool_name, percent(all.touching, all.ticks), percent(all.sliding, all.ticks), all.force,
                  fine.step, fast.step, fine.jump, all.onset, fine.gain, fast.gain, all.drive, all.hash);
    ticks += all.ticks;
    if (is_ball(view, tool)) add_organ(file, view, tool);
  }

private:
  void add_organ(const std::string& file, const runtime::View& view, std::uint32_t tool) {
    const char* const tool_name = view.tools[tool].name;
    for (const double aside : {0.0, 0.006}) {
      PressOptions options;
      options.aside = aside;
      options.seed = seed + 2;
      const OrganResult r = press_sites(view, tool, options);
      presses.print("| %s %s | %.0f | %u | %u | %.1f | %u | %.1f | %u | %.1g |\n", file.c_str(), tool_name, 1e3 * aside,
                    r.presses, r.stepped, 100 * r.step, r.lifts_off, 100 * r.lift, r.lost_early, r.gain);
      if (aside == 0) report(broken_promise(r), "%s %s, presses", file.c_str(), tool_name);
    }
    SlideOptions options;
    options.seed = seed + 4;
    const OrganResult r = slide_round(view, tool, options);
    slides.print("| %s %s | %.0f | %.2f | %.1f | %.2f | %.0f | %.1g |\n", file.c_str(), tool_name, 1e3 * r.travel,
                 r.travel > 0 ? 100 * r.weak_travel / r.travel : 0, r.longest_weak, r.touch_changes_per_size(),
                 100 * r.slide_step, r.gain);
    report(broken_promise(r), "%s %s, slides, seed %u", file.c_str(), tool_name, options.seed);
  }

  [[gnu::format(printf, 3, 4)]] void report(const std::string& fault, const char* format, ...) {
    if (fault.empty()) return;
    ++broken;
    std::va_list values;
    va_start(values, format);
    std::vfprintf(stderr, format, values);
    va_end(values);
    std::fprintf(stderr, ": %s\n", fault.c_str());
  }
};

}  // namespace
}  // namespace palpate::test

int main(int argc, char** argv) {
  std::vector<std::string> files(argv + (argc < 2 ? argc : 2), argv + argc);
  if (const char* more = std::getenv("PALPATE_PROPERTY_FILE")) files.emplace_back(more);
  char* end = nullptr;
  const std::uint64_t ticks = argc > 1 ? std::strtoull(argv[1], &end, 10) : 0;
  palpate::test::Tables tables;
  if (end != nullptr && *end == ':') tables.seed = static_cast<unsigned>(std::strtoul(end + 1, &end, 10));
  if (ticks == 0 || *end != 0 || tables.seed == 0 || files.empty()) {
    return std::fprintf(stderr, "usage: runtime_property TICKS[:SEED] FILE...\n"), 1;
  }
  for (const std::string& file : files) {
    const palpate::runtime::MappedFile bytes(file.c_str());
    if (!bytes.ok()) return std::fprintf(stderr, "%s: %s\n", file.c_str(), bytes.error()), 4;
    const palpate::runtime::OpenResult opened = palpate::runtime::View::open(bytes.data(), bytes.size());
    if (!opened) return std::fprintf(stderr, "%s: %s\n", file.c_str(), opened.error), 2;
    const std::string stem = std::filesystem::path(file).stem().string();
    for (std::uint32_t tool = 0; tool < opened.view.meta->tool_count; ++tool) tables.add(stem, ticks, opened.view, tool);
  }
  std::printf(
      "| file, tool | touching | sliding | force | step | step, fast | jump | onset | gain | gain, fast | drive | bits |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n%s\n"
      "Presses at every site. Steps and lifts in %% of the peak of the press.\n\n"
      "| file, tool | aside (mm) | presses | steps > 10 %% | largest step | lifts off > 10 %% | largest | lost early | gain |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- |\n%s\n"
      "Slides at constant overlap. Weak is a force below a tenth of the place's own. Steps in %% of the 90th percentile.\n\n"
      "| file, tool | travel (mm) | weak (%%) | longest weak (overlaps) | touch changes a contact size | largest step | gain |\n"
      "| --- | --- | --- | --- | --- | --- | --- |\n%s\n"
      "%" PRIu64 " ticks of random motions, %d broken promises\n",
      tables.motions.text(), tables.presses.text(), tables.slides.text(), tables.ticks, tables.broken);
  return tables.broken == 0 ? 0 : 5;
}
