// SPDX-License-Identifier: GPL-3.0-or-later
// Quantiles and shares.
#include "precompute/verify/held_out/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace palpate::verify {
namespace {

struct Figure {
  std::size_t contact;
  double error, depth;
};

ErrorStatistics over(const std::vector<Figure>& figures) {
  ErrorStatistics s;
  std::vector<double> errors;
  for (const Figure& f : figures) {
    errors.push_back(f.error);
    // A figure that is no number is the worst there can be, never a gap in the statistics.
    if (f.error <= s.worst) continue;
    s.worst = std::isfinite(f.error) ? f.error : HUGE_VAL;
    s.worst_contact = f.contact;
    s.worst_depth = f.depth;
  }
  s.count = errors.size();
  const auto share = [&](double limit) {
    return s.count == 0 ? 0.0
                        : static_cast<double>(
                              std::count_if(errors.begin(), errors.end(), [&](double e) { return e <= limit; })) /
                              static_cast<double>(s.count);
  };
  s.within_1 = share(0.01);
  s.within_2 = share(0.02);
  s.within_5 = share(0.05);
  s.within_10 = share(0.10);
  for (double& e : errors) {
    if (!std::isfinite(e)) e = HUGE_VAL;
  }
  s.median = quantile(errors, 0.5);
  s.p95 = quantile(errors, 0.95);
  return s;
}

ErrorStatistics of_kind(const std::vector<HeldOut>& contacts, std::initializer_list<SampleKind> kinds,
                        bool at_pairs = false) {
  std::vector<Figure> figures;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    if (contacts[c].at_pair != at_pairs) continue;
    for (const ForcePair& f : contacts[c].forces) {
      if (std::find(kinds.begin(), kinds.end(), f.kind) != kinds.end())
        figures.push_back({c, f.error, -f.deflection.dot(contacts[c].frame.n)});
    }
  }
  return over(figures);
}

ErrorStatistics of_turns(const std::vector<HeldOut>& contacts) {
  std::vector<Figure> figures;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    for (const ForcePair& f : contacts[c].forces) {
      if (f.turn) figures.push_back({c, f.turn->error, -f.deflection.dot(contacts[c].frame.n)});
    }
  }
  return over(figures);
}

ErrorStatistics of_limits(const std::vector<HeldOut>& contacts) {
  std::vector<Figure> figures;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    if (contacts[c].at_pair) continue;
    for (const LimitPair& l : contacts[c].limits) figures.push_back({c, l.error, l.depth});
  }
  return over(figures);
}

}  // namespace

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const double at = q * static_cast<double>(values.size() - 1);
  const auto low = static_cast<std::size_t>(at);
  const std::size_t high = std::min(low + 1, values.size() - 1);
  if (values[low] == values[high]) return values[low];
  return values[low] + (at - static_cast<double>(low)) * (values[high] - values[low]);
}

VerifyStatistics summarise(const std::vector<HeldOut>& contacts) {
  VerifyStatistics s;
  s.contacts = contacts.size();
  s.accepted = static_cast<std::size_t>(
      std::count_if(contacts.begin(), contacts.end(), [](const HeldOut& c) { return c.accepted; }));
  s.refused = s.contacts - s.accepted;
  s.normal = of_kind(contacts, {SampleKind::normal});
  s.tangential = of_kind(contacts, {SampleKind::tangential});
  s.limit = of_limits(contacts);
  s.paths = of_kind(contacts, {SampleKind::path});
  s.grasped = of_kind(contacts, {SampleKind::grasped});
  s.spins = of_kind(contacts, {SampleKind::normal, SampleKind::tangential}, true);
  s.turned = of_turns(contacts);
  return s;
}

}  // namespace palpate::verify
