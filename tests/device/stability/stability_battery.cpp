// SPDX-License-Identifier: GPL-3.0-or-later
// stability_battery [--every N] [--list] FILE.palp...: predicted against simulated onsets of oscillation, as a table in
// Markdown; exit code 5 where the bound for any hand is above an onset, fewer than 90 % are within a factor of 1.2, or
// the passivity controller lets a contact oscillate, gives the hand more than the trace beyond what it gave, or makes
// more than its bound, or a contact behind a safe virtual coupling oscillates.
#include "tests/device/stability/stability_cases.hpp"

#include "palpate/format/mapped_file.hpp"
#include "palpate/palpate.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <map>

namespace palpate::test {
namespace {

struct Row {
  std::vector<double> ratio, conservatism;  ///< simulated over predicted, simulated over passive
  int cases = 0, none = 0, only_one = 0, above = 0, trials = 0, controlled = 0, controlled_oscillate = 0;
  double given = 0, made = 0, share = 0;
  int coupled = 0, coupled_oscillate = 0;
  double coupled_given = 0, softest = HUGE_VAL, stiffest = 0;
  double least = HUGE_VAL, most = 0;  ///< N/m, of the simulated
};

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return NAN;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
}

double within(const Row& row) {
  const auto inside =
      std::count_if(row.ratio.begin(), row.ratio.end(), [](double r) { return r < 1.2 && r > 1 / 1.2; });
  return 100.0 * static_cast<double>(inside) / static_cast<double>(row.cases - row.none);
}

void add(Row& row, const StabilityResult& r) {
  ++row.cases;
  row.trials += r.trials;
  row.controlled += r.controlled;
  row.controlled_oscillate += r.controlled_oscillate;
  row.given = std::max(row.given, r.given);
  row.made = std::max(row.made, r.made);
  row.share = std::max(row.share, r.made_share);
  row.coupled += r.coupled;
  row.coupled_oscillate += r.coupled_oscillate;
  row.coupled_given = std::max(row.coupled_given, r.coupled_given);
  row.softest = std::min(row.softest, r.softest);
  row.stiffest = std::max(row.stiffest, r.stiffest);
  const bool predicted = std::isfinite(r.predicted), simulated = std::isfinite(r.simulated);
  if (!predicted && !simulated) {
    ++row.none;
  } else if (predicted != simulated) {
    ++row.only_one;
  } else {
    row.ratio.push_back(r.simulated / r.predicted);
  }
  if (r.passive_oscillates || r.simulated < r.passive) ++row.above;
  if (!simulated) return;
  row.conservatism.push_back(r.simulated / r.passive);
  row.least = std::min(row.least, r.simulated);
  row.most = std::max(row.most, r.simulated);
}

void print(const std::string& name, const Row& row) {
  std::printf("| %s | %d | %d | %d |", name.c_str(), row.cases, row.none, row.only_one);
  if (row.ratio.empty()) {
    std::printf(" | | | | | |");
  } else {
    std::printf(" %.0f to %.0f | %.1f | %.2f | %.2f to %.2f | %.1f | %.1f |", row.least, row.most, within(row),
                quantile(row.ratio, 0.5), quantile(row.ratio, 0.05), quantile(row.ratio, 0.95),
                quantile(row.conservatism, 0.0), quantile(row.conservatism, 0.5));
  }
  std::printf(" %d | %d of %d | %.3f | %.2f | %.2f | %d of %d | %.2f |", row.above, row.controlled_oscillate,
              row.controlled, 1e3 * row.given, 1e3 * row.made, row.share, row.coupled_oscillate, row.coupled,
              1e3 * row.coupled_given);
  if (row.coupled > 0) {
    std::printf(" %.0f to %.0f |\n", row.softest, row.stiffest);
  } else {
    std::printf(" |\n");
  }
}

int run(int every, bool list, const std::vector<ContactLaw>& laws) {
  std::map<std::string, Row> rows[5];
  Row all;
  int number = 0;
  const std::vector<NamedHand> grips = hands();
  for (const device::SimKind& kind : device::sim_kinds()) {
    for (const ContactLaw& law : laws) {
      for (const NamedHand& hand : grips) {
        for (const double rate : {1000.0, 2000.0, 4000.0}) {
          for (const double delay : {0.0004, 0.0015, 0.004}) {
            if (number++ % every != 0) continue;
            const StabilityResult r = examine({&kind, &law, &hand, rate, delay});
            char rates[32], delays[32];
            std::snprintf(rates, sizeof rates, "%4.0f Hz", rate);
            std::snprintf(delays, sizeof delays, "%.1f ms", 1e3 * delay);
            const std::string names[] = {kind.kind.name, law.name, hand.name, rates, delays};
            for (int k = 0; k < 5; ++k) add(rows[k][names[k]], r);
            add(all, r);
            if (list) {
              std::printf("%s, %s, %s, %s, %s: predicted %.0f N/m at %.0f Hz, simulated %.0f, bound %.0f\n",
                          kind.kind.name, law.name.c_str(), hand.name.c_str(), rates, delays, r.predicted, r.frequency,
                          r.simulated, r.passive);
            }
          }
        }
      }
    }
  }
  std::printf(
      "| of | cases | no onset | only one | onset N/m | within 1.2, %% | ratio, median | 5 to 95 %% | onset / bound, "
      "least | "
      "median | bound above | controlled oscillate | given, mJ | made, mJ | of its bound | coupled oscillate | "
      "given, mJ | "
      "couplings N/m |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  print("all", all);
  for (const auto& by : rows) {
    for (const auto& [name, row] : by) print(name, row);
  }
  std::printf("\n%d closed-loop simulations.\n", all.trials);
  return all.above == 0 && within(all) >= 90 && all.controlled_oscillate == 0 && all.given <= kTrace &&
                 all.share <= 1 && all.coupled_oscillate == 0
             ? 0
             : 5;
}

}  // namespace
}  // namespace palpate::test

int main(int argc, char** argv) {
  using namespace palpate;
  int every = 1;
  bool list = false;
  std::deque<runtime::MappedFile> files;
  std::deque<runtime::View> views;
  std::vector<test::ContactLaw> laws = test::plain_laws();
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--every") == 0 && i + 1 < argc) {
      every = std::max(1, std::atoi(argv[++i]));
      continue;
    }
    if (std::strcmp(argv[i], "--list") == 0) {
      list = true;
      continue;
    }
    files.emplace_back(argv[i]);
    if (!files.back().ok()) {
      std::fprintf(stderr, "%s: %s\n", argv[i], files.back().error());
      return 2;
    }
    const runtime::OpenResult opened = runtime::View::open(files.back().data(), files.back().size());
    if (!opened) {
      std::fprintf(stderr, "%s: %s\n", argv[i], opened.error);
      return 2;
    }
    views.push_back(opened.view);
    std::string name = argv[i];
    name = name.substr(name.rfind('/') + 1);
    laws.push_back(test::file_law(name, views.back()));
  }
  return test::run(every, list, laws);
}
