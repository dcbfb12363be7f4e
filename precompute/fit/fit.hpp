// SPDX-License-Identifier: GPL-3.0-or-later
// From a plan and its journal to the responses of a file: fits every accepted pair, fills the rest from neighbours.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "formats/journal/journal.hpp"
#include "formats/response/response.hpp"
#include "precompute/bake/plan.hpp"
#include "precompute/bake/sampling_estimate.hpp"
#include "precompute/compliance/report.hpp"
#include "precompute/fit/external_samples.hpp"
#include "precompute/fit/laws/pair_fit.hpp"
#include "precompute/fit/laws/potential_degrees.hpp"
#include "precompute/fit/refusals.hpp"
#include "precompute/solve/pair/pair.hpp"

namespace palpate::fit {

/// Share of the tolerance that responses may miss of the samples which they are fitted to. The rest is for places
/// between sites.
inline constexpr double kFitShare = 0.5;

struct FitSettings {
  double depth_scale = 0.0;      ///< m, Z: the scene's depth
  bool friction = false;         ///< the scene has friction
  double max_residual = 1;       ///< relative error of a force beyond which its pair is refused
  double bias_threshold = 0.01;  ///< of the peak force: smaller tangential biases are left out
  double tolerance = 0.05;       ///< requested relative force error; the degrees meet kFitShare of it
  std::vector<bool> grasps;      ///< per tool, whether it bonds; empty: none does
  std::vector<bool> turns;       ///< per tool that bonds, whether it is rotated; empty: none is
  /// The path of a bake to a depth (m); required for recordings and normal indentations.
  std::function<solve::PairPath(double depth)> path;
};

/// Median, 95th percentile and worst of relative errors (share of max(|force|, 2 % of the pair's peak)).
struct ErrorFigures {
  std::size_t samples = 0;
  double median = 0.0, p95 = 0.0, worst = 0.0;
  std::uint32_t worst_pair = 0;
};

struct PairFigures {
  std::uint32_t pair = 0;
  double median = 0.0, p95 = 0.0, worst = 0.0;  ///< over all samples of the pair
};

/// Counts of the recorded rows of a pair.
struct RecordedFigures {
  std::uint32_t pair = 0;
  std::size_t rows = 0;               ///< that it is made of, outliers among them
  std::vector<std::string> outliers;  ///< "file:line" of the rows that were left out
  double rms = 0.0, worst = 0.0;      ///< N, of the others off the fit
  double depth = 0.0;                 ///< m, how deep they reach
  Passed passed;                      ///< rows that are not among `rows`
};

/// The contact surface of the file.
struct SurfaceFigures {
  std::size_t triangles = 0;
  double tolerance = 0.0, distance = 0.0;  ///< m, allowed and found, to the body's surface
  std::string fault;                       ///< why it is the mesh of patches itself; empty: it is not
};

struct FitReport {
  std::size_t planned = 0, accepted = 0;                  ///< of the pairs to be solved
  std::size_t refused = 0;                                ///< by the solver or by the fit
  std::vector<Refusals> refusals;                         ///< these, by cause
  std::size_t full = 0, carried = 0;                      ///< responses solved in full, carried to normal indentations
  std::size_t shortened = 0;                              ///< of the accepted: a tangential push ended early
  std::size_t filled = 0;                                 ///< responses from neighbours: refused and skipped ones
  std::size_t analytic = 0;                               ///< responses by a closed form; the measured ones: recorded
  std::size_t support = 0, outside = 0, unreachable = 0;  ///< of the filled ones, the reason why they were skipped
  bool bias = false, friction = false, grasp = false, turn = false;  ///< parts that the file has
  ErrorFigures normal, tangential;
  ErrorFigures paths;                          ///< along paths that the fit did not read
  ErrorFigures grasped;                        ///< of tools that bond
  ErrorFigures turned;                         ///< of the torques of rotated tools
  ErrorFigures laws;                           ///< of the fits to closed forms
  ErrorFigures left_out;                       ///< of tangential pushes carried to sites that were solved in full
  std::vector<RecordedFigures> recorded;       ///< by pair
  std::optional<bake::SamplingEstimate> sampling;  ///< of automatic sampling; filled by pipeline::fit_file
  SampleFigures held_out;                          ///< of samples left out, with the chosen degrees
  std::vector<double> softenings;              ///< of accepted pairs (slip_softening), ascending; empty where all are 0
  std::vector<PairFigures> pairs;              ///< by pair
  SurfaceFigures surface;                      ///< set with the file
  std::optional<compliance::ComplianceReport> compliance;  ///< set with the file, where the scene has [compliance]
};

/// The 95th percentile that normal forces at other contacts are expected to have: those of interpolation, of carrying
/// and of the fit are independent, and add as squares. 0 without automatic sampling.
double expected_p95(const FitReport& report);

struct FittedResponses {
  ResponseScales scales;
  std::vector<Response> responses;  ///< site * tool vertices + tool vertex over all tools
  FitReport report;
};

/// Median, 95th percentile (nearest rank) and worst of `errors`; all zero when there are none.
ErrorFigures error_figures(const std::vector<std::pair<double, std::uint32_t>>& errors);

/// Fits every pair that was solved in full, carries these responses to sites that had a normal indentation alone, and
/// fills the rest, whatever was refused. `triangles`: patches of the haptic mesh; `tool_vertices`: their number per
/// tool; `sources`: recordings and closed forms in place of the journal. Throws Error(bad_input) when a pair to be
/// solved has no outcome (the bake is not finished) and as fit_recorded, Error(numerical) with the causes when no
/// pair at all was solved in full.
FittedResponses fit_responses(const bake::Plan& plan, const std::vector<std::array<std::int32_t, 3>>& triangles,
                              const std::vector<std::uint32_t>& tool_vertices, const JournalContent& journal,
                              const FitSettings& settings, const PairSources& sources = {});

}  // namespace palpate::fit
