// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/drive/drive_station.hpp"

#include <algorithm>
#include <cstdio>

#include "device/glove/glove_source.hpp"
#include "device/loop/contact_source.hpp"
#include "device/simulation/sim_glove.hpp"
#include "formats/io/error.hpp"
#include "tools/cli/output.hpp"

namespace palpate::cli {
namespace {

using device::kFingers;

/// A motion down to the body, to the sampled depth less the hand's own deflection, and back, drifting sideways.
device::Probing probing(const runtime::View& view, const FrameOptions& frame) {
  const double depth = view.meta->depth_scale / frame.scale;
  device::Probing motion;
  motion.stroke = -(frame.gap + depth) * frame.device_up;
  motion.sway = 0.25 * depth * any_orthogonal(frame.device_up);
  return motion;
}

/// The same for a fingertip: from where it is at rest.
double way_down(const runtime::View& view, std::uint32_t tool, const runtime::DeviceFrame& frame,
                const runtime::Pose& tip) {
  constexpr double kReach = 0.05;  // m of the hand: a finger beside the body closes in the air
  return std::min(kReach, (clearance(view, tool, frame, {tip}) + view.meta->depth_scale) / frame.scale);
}

std::string described(const device::HandCalibration& hand) {
  const auto [small, large] = std::minmax_element(hand.size.begin(), hand.size.end());
  char text[160];
  std::snprintf(
      text, sizeof text,
      "hand calibrated: fingers of %.2f to %.2f times the typical length, tips within %.1f mm of the measured", *small,
      *large, 1e3 * hand.tip_error);
  return text;
}

Station with_glove(const runtime::View& view, std::uint32_t tool, const StationOptions& options,
                   const Globals& globals) {
  if (!options.coupling.stiffness.empty()) {
    throw Error(ExitCode::usage, "--coupling: a glove has none; its pulls are smoothed and limited in their rate");
  }
  device::SimGloveOptions glove;
  const auto tips = device::SimGlove(glove).tips_at_rest();
  FrameOptions placing = options.placing;
  placing.tips.assign(tips.begin(), tips.end());
  Station station;
  station.frame = place_device(view, tool, placing);
  for (std::size_t f = 0; f < kFingers; ++f) glove.way[f] = way_down(view, tool, station.frame, tips[f]);

  auto worn = std::make_unique<device::SimGlove>(glove);
  const device::HandCalibration hand = calibrate_hand(worn->record());
  if (!hand.usable()) throw Error(ExitCode::numerical, "the hand cannot be calibrated: " + hand.problem);
  device::GloveOptions pulls;
  pulls.limit = options.limit;
  auto source = std::make_unique<device::GloveSource>(view, tool, hand, station.frame, pulls);
  if (const char* problem = source->problem()) {
    throw Error(ExitCode::usage,
                std::string("--tool ") + view.tools[tool].name + ": " + problem + ", and only spheres are fingertips");
  }
  note(globals, described(hand));
  station.hand = to_run_hand(hand, pulls);
  station.source = std::move(source);
  station.device = std::move(worn);
  return station;
}

template <class Contact>
std::unique_ptr<device::ForceSource> source(const runtime::View& view, std::uint32_t tool, const Station& station) {
  if (!station.coupling) {
    return std::make_unique<device::ContactSource<runtime::Rigid, Contact>>(view, tool, station.frame);
  }
  return std::make_unique<device::ContactSource<runtime::VirtualCoupling, Contact>>(
      view, tool, station.frame, device::coupling_in(station.frame, *station.coupling));
}

}  // namespace

Station set_up(const runtime::View& view, std::uint32_t tool, const device::DeviceKind& kind,
               const StationOptions& options, const Globals& globals) {
  if (kind.glove) return with_glove(view, tool, options, globals);
  Station station;
  station.frame = place_device(view, tool, options.placing);
  station.several = !options.single;
  station.coupling = choose_coupling(options.coupling, view, station.frame, kind, globals);
  station.source = station.several ? source<runtime::ContactSet<3>>(view, tool, station)
                                   : source<runtime::Contact>(view, tool, station);
  DriveDeviceOptions device = options.device;
  device.probing = probing(view, options.placing);
  station.device = open_drive_device(device);
  return station;
}

}  // namespace palpate::cli
