// SPDX-License-Identifier: GPL-3.0-or-later
// Pairs whose samples come from no bake: recorded with a real tool or by a closed form, and their fits.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "formats/io/hash.hpp"
#include "formats/journal/samples.hpp"
#include "precompute/fit/fill.hpp"
#include "precompute/fit/laws/potential_degrees.hpp"

namespace palpate {
struct JournalContent;
}  // namespace palpate

namespace palpate::bake {
struct Plan;
}  // namespace palpate::bake

namespace palpate::fit {

struct FitReport;
struct FitSettings;

/// Recorded rows that no response is made of.
struct Passed {
  std::size_t out = 0;         ///< not in contact
  std::size_t deep = 0;        ///< deeper than sampling.depth
  std::size_t aside = 0;       ///< farther aside than a bake would push; without friction all that go aside
  std::size_t weightless = 0;  ///< of weight 0
  [[nodiscard]] std::size_t total() const { return out + deep + aside + weightless; }
};

/// "N rows passed over: ...".
std::string to_text(const Passed& passed);

/// A pair that is not solved.
struct ExternalSamples {
  bool measured = false;  ///< recorded, else by a closed form
  std::vector<Sample> samples;
  std::vector<std::string> rows;  ///< measured: per sample "file:line"
  Passed passed;                  ///< measured
};

/// Sources of the responses of a plan, by pair of the plan.
struct PairSources {
  std::map<std::uint32_t, ExternalSamples> external;
  bool solve_others = true;         ///< the other pairs are solved, else filled from neighbours
  Hash128 text;                     ///< of the canonical text of the scene's sources
  std::vector<Hash128> recordings;  ///< of their files
  /// True where a bake has to solve the pair.
  [[nodiscard]] bool solved(std::uint32_t pair) const { return solve_others && external.count(pair) == 0; }
  [[nodiscard]] bool solves_any(std::size_t pairs) const { return solve_others && external.size() < pairs; }
};

/// How many of them there are.
struct ExternalCounts {
  std::size_t measured = 0, analytic = 0;
};
ExternalCounts count_external(const PairSources& sources);

/// The samples that a pair's response is fitted to; null where it is filled from neighbours. Every pair to be solved
/// has an outcome.
const std::vector<Sample>* samples_of(std::uint32_t pair, const JournalContent& journal, const PairSources& sources);

/// True when the normal samples of a recording have a tangential force of `threshold` of their force, by medians over
/// the deeper half of them.
bool has_steady_bias(const std::vector<Sample>& samples, double threshold);

/// Throws as fit::check_recorded for the first recorded pair that is not enough for a response.
void check_external(const bake::Plan& plan, const PairSources& sources, bool friction);

/// fit::choose_degrees over pairs without noise (`exact`: solved, by closed forms) and over recorded ones. The latter
/// are fitted with many coefficients and sampled from that fit, because rows left out would measure their noise. At
/// most a dozen of each are used, so that many solved pairs do not outvote few recordings. Throws as fit_external.
DegreeChoice choose_degrees(const bake::Plan& plan, const PairSources& sources,
                            const std::vector<const std::vector<Sample>*>& exact,
                            const std::vector<const std::vector<Sample>*>& pushes, const ResponseScales& scales,
                            bool bias, const FitSettings& settings);

/// Fits a pair of them and adds its figures to `report`, the errors of a closed form to `laws`. Throws as
/// fit::fit_recorded, with the rows that were passed over, and as fit::fit_pair.
SiteResponse fit_external(const bake::Plan& plan, std::uint32_t pair, const ExternalSamples& external,
                          const ResponseScales& scales, FitReport& report,
                          std::vector<std::pair<double, std::uint32_t>>& laws);

}  // namespace palpate::fit
