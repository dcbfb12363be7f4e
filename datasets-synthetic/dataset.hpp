// SPDX-License-Identifier: GPL-3.0-or-later
// A whole synthetic data set: organ, inclusion, tool, scene and motion, ready for `palpate build`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpate::synth {

enum class Organ { slab, ball, liver, kidney, bladder, sheet };
enum class Instrument { sphere, punch, capsule, stylus };
enum class MotionKind { probe, scan };

/// Every length in m. A value that is not set is chosen to fit the organ.
struct DatasetOptions {
  Organ organ = Organ::slab;
  std::uint64_t seed = 1;       ///< varies the liver's shape and the place that is probed
  double scale = 1.0;           ///< of the organ, [0.1, 10]
  std::optional<double> edge;   ///< edge length of the organ's surface, at least scale / 2000
  std::optional<double> young;  ///< Pa
  double poisson = 0.49;

  bool inclusion = false;
  std::optional<double> inclusion_radius;
  std::optional<double> inclusion_gap;  ///< tissue over the inclusion
  double inclusion_young = 5e4;
  bool tumour = false;  ///< liver with an inclusion: both with published stiffnesses

  double pressure = 0.0;  ///< Pa inside a bladder, below the limit of its wall

  Instrument instrument = Instrument::sphere;
  bool instrument_as_mesh = false;  ///< write the tool as a closed mesh (a stylus always is one)
  double tool_radius = 0.005;
  double tool_length = 0.03;  ///< capsule, stylus; a punch is 4 radii high

  double friction = 0.3;
  std::optional<double> spacing;
  double depth = 0.005;

  MotionKind motion = MotionKind::probe;
  double motion_rate = 1000.0;  ///< rows a second
};

/// Writes the data set into `folder` (created when missing) and returns the files. Same options, same bytes.
/// Throws Error(usage) for measures that do not fit together, Error(io) when a file cannot be written.
std::vector<std::filesystem::path> write_dataset(const DatasetOptions& options, const std::filesystem::path& folder);

}  // namespace palpate::synth
