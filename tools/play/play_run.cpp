// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/play/play_run.hpp"

#include <array>
#include <filesystem>
#include <fstream>
#include <limits>
#include <tuple>

#include "device/glove/glove_source.hpp"
#include "device/loop/contact_source.hpp"
#include "formats/io/error.hpp"
#include "formats/response/response.hpp"
#include "palpate/format/checksum.hpp"
#include "tools/play/other_walls.hpp"
#include "tools/play/plot.hpp"

namespace palpate::cli {

using device::kFingers;
using device::RunTick;
using runtime::Tick;

namespace {

template <class Tie, class Contact>
std::array<Tick, 1> ticks_of(const device::ContactSource<Tie, Contact>& source) {
  return {source.tick()};
}
std::array<Tick, kFingers> ticks_of(const device::GloveSource& source) { return source.ticks(); }

/// Counts other walls and contacts that are too near.
template <class Tie, class Contact>
void count_walls(PlaySummary& summary, const OtherWalls& walls, const device::ContactSource<Tie, Contact>& source) {
  summary.rows_other_contacts += OtherWalls::missed(source.contact(), source.tool(), source.tick()) ? 1 : 0;
  summary.rows_near += walls.near(source.contact()) ? 1 : 0;
}
void count_walls(PlaySummary&, const OtherWalls&, const device::GloveSource&) {}

/// Source: as new, of the file.
template <class Source>
void replay_into(PlayedRun& played, const device::RunLog& log, const OtherWalls& walls, Source&& source) {
  using Ticks = decltype(ticks_of(source));
  std::array<PlaySummary, std::tuple_size_v<Ticks>> each{};
  played.rows.reserve(each.size() * log.records.size());
  played.replay = device::replay(log, source, [&](const RunTick& record, const device::TickOutput& out) {
    const Ticks ticks = out.answer.usable ? ticks_of(source) : Ticks{};
    const bool first = played.rows.empty();
    for (std::size_t k = 0; k < each.size(); ++k) {
      account(each[k], ticks[k], record.seconds);
      each[k].rows_extrapolated += ticks[k].extrapolated ? 1 : 0;
      each[k].rows_filled += ticks[k].filled_share > 0.5 ? 1 : 0;
      each[k].starts_inside = each[k].starts_inside || (first && each[k].touching);
      const int finger = each.size() > 1 ? static_cast<int>(k) + 1 : 0;
      played.rows.push_back({record.time - log.records.front().time, ticks[k], finger});
    }
    if (out.answer.usable) count_walls(played.summary, walls, source);
  });
  for (const PlaySummary& one : each) add(played.summary, one);
}

template <class Contact>
void replay_held(PlayedRun& played, const device::RunLog& log, const OtherWalls& walls, const runtime::View& view,
                 std::uint32_t tool) {
  const runtime::DeviceFrame frame = device::device_frame(log.header);
  if (const auto coupling = device::coupling_options(log.header)) {
    replay_into(played, log, walls,
                device::ContactSource<runtime::VirtualCoupling, Contact>(view, tool, frame,
                                                                         device::coupling_in(frame, *coupling)));
  } else {
    replay_into(played, log, walls, device::ContactSource<runtime::Rigid, Contact>(view, tool, frame));
  }
}

/// Force on the hand and where it is.
std::vector<PlotPanel> handle_panels(const device::RunLog& log) {
  PlotPanel force{"force on the hand (N)", {{"x", {}}, {"y", {}}, {"z", {}}, {"magnitude", {}}}};
  PlotPanel position{"position (mm)", {{"x", {}}, {"y", {}}, {"z", {}}}};
  for (const RunTick& r : log.records) {
    for (std::size_t k = 0; k < 3; ++k) {
      force.series[k].values.push_back(r.force[k]);
      position.series[k].values.push_back(1e3 * r.position[k]);
    }
    force.series[3].values.push_back(length(runtime::Vec3{r.force[0], r.force[1], r.force[2]}));
  }
  return {force, position};
}

/// Pulls on the fingers and how far these are bent.
std::vector<PlotPanel> glove_panels(const device::RunLog& log) {
  PlotPanel pull = finger_panel("pull on the finger (N)"), bend = finger_panel("bend of its root (degrees)");
  const device::HandCalibration hand = device::calibration_of(*log.hand);
  for (const RunTick& r : log.records) {
    const device::HandJoints angles = hand.angles(device::to_input(r).sample.joints);
    for (std::size_t f = 0; f < kFingers; ++f) {
      pull.series[f].values.push_back(r.hand.pull[f]);
      const double degrees = 180 / device::kPi * angles[f][device::Joint::root];
      bend.series[f].values.push_back(r.sample_number > 0 ? degrees : std::numeric_limits<double>::quiet_NaN());
    }
  }
  return {pull, bend};
}

}  // namespace

bool is_run(const std::string& path) {
  // Opening a pipe that nobody writes to would wait, and what is read of one is gone.
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return false;
  std::ifstream file(path, std::ios::binary);
  char begin[sizeof device::RunHeader::kMagic] = {};
  file.read(begin, sizeof begin);
  return file.gcount() == sizeof begin && device::is_run_log(begin, sizeof begin);
}

device::RunLog read_run(const std::string& path) {
  const std::vector<std::byte> bytes = read_bytes(path);
  device::RunLog log = device::read_run_log(bytes.data(), bytes.size());
  if (!log.ok) throw Error(ExitCode::bad_input, path + ": " + log.error);
  return log;
}

std::uint64_t response_hash(const ResponseInput& input) { return checksum::of(input.view().bytes, input.view().size); }

PlayedRun play_run(const device::RunLog& log, const ResponseInput& input, std::uint32_t tool) {
  PlayedRun played;
  played.same_response =
      input.view().size == log.header.response_size && response_hash(input) == log.header.response_hash;
  const OtherWalls walls(input.view(), tool);
  if (log.hand) {
    device::GloveSource glove(input.view(), tool, device::calibration_of(*log.hand), device::device_frame(log.header),
                              device::glove_options(*log.hand));
    if (const char* problem = glove.problem()) {
      throw Error(ExitCode::bad_input, std::string("tool '") + input.view().tools[tool].name + "': " + problem +
                                           ", and the run was a glove's");
    }
    replay_into(played, log, walls, glove);
  } else if (log.header.several == 1) {
    replay_held<runtime::ContactSet<3>>(played, log, walls, input.view(), tool);
  } else {
    replay_held<runtime::Contact>(played, log, walls, input.view(), tool);
  }
  return played;
}

std::string run_svg(const device::RunLog& log, const std::string& title) {
  std::vector<PlotPanel> panels = log.hand ? glove_panels(log) : handle_panels(log);
  std::vector<double> time;
  PlotPanel depth{"depth (mm)", {{"depth", {}}}};
  PlotPanel age{"sample age (ms)", {{"age", {}}}};
  for (const RunTick& r : log.records) {
    time.push_back(r.time - log.records.front().time);
    depth.series[0].values.push_back(1e3 * r.depth);
    // Before the first sample there is none, and a stale one would hide the others.
    const double ms = 1e3 * (r.time - r.sample_time);
    age.series[0].values.push_back(r.sample_number > 0 && ms < 100 ? ms : std::numeric_limits<double>::quiet_NaN());
  }
  panels.insert(panels.end(), {depth, age});
  return line_plot_svg(title, "time (s)", time, panels);
}

}  // namespace palpate::cli
