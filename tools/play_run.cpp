// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/play_run.hpp"

#include <fstream>
#include <limits>

#include "device/contact_source.hpp"
#include "formats/error.hpp"
#include "formats/response.hpp"
#include "palpate/checksum.hpp"
#include "tools/plot.hpp"

namespace palpate::cli {

using device::RunRecord;

namespace {

/// Source: as new, of the file.
template <class Source>
void replay_into(PlayedRun& played, const device::RunLog& log, Source&& source) {
  played.rows.reserve(log.records.size());
  played.replay = device::replay(log, source, [&](const RunRecord& record, const device::TickOutput& out) {
    const runtime::Tick tick = out.answer.usable ? source.tick() : runtime::Tick{};
    account(played.summary, tick, record.seconds);
    played.summary.rows_beyond += tick.beyond ? 1 : 0;
    played.summary.rows_covered += tick.covered > 0.5 ? 1 : 0;
    played.summary.starts_inside = played.summary.starts_inside || (played.rows.empty() && played.summary.touching);
    played.rows.push_back({record.time - log.records.front().time, tick});
  });
}

}  // namespace

bool is_run(const std::string& path) {
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
  const runtime::DeviceFrame frame = device::device_frame(log.header);
  if (const auto coupling = device::coupling_options(log.header)) {
    replay_into(played, log, device::CoupledSource(input.view(), tool, frame, device::coupling_in(frame, *coupling)));
  } else {
    replay_into(played, log, device::ContactSource<>(input.view(), tool, frame));
  }
  return played;
}

std::string run_svg(const device::RunLog& log, const std::string& title) {
  std::vector<double> time;
  PlotPanel force{"force on the hand (N)", {{"x", {}}, {"y", {}}, {"z", {}}, {"magnitude", {}}}};
  PlotPanel position{"position (mm)", {{"x", {}}, {"y", {}}, {"z", {}}}};
  PlotPanel depth{"depth (mm)", {{"depth", {}}}};
  PlotPanel age{"sample age (ms)", {{"age", {}}}};
  for (const RunRecord& r : log.records) {
    time.push_back(r.time - log.records.front().time);
    for (std::size_t k = 0; k < 3; ++k) {
      force.series[k].values.push_back(r.force[k]);
      position.series[k].values.push_back(1e3 * r.position[k]);
    }
    force.series[3].values.push_back(length(runtime::Vec3{r.force[0], r.force[1], r.force[2]}));
    depth.series[0].values.push_back(1e3 * r.depth);
    // Before the first sample there is none, and a stale one would hide the others.
    const double ms = 1e3 * (r.time - r.sample_time);
    age.series[0].values.push_back(r.sample_number > 0 && ms < 100 ? ms : std::numeric_limits<double>::quiet_NaN());
  }
  return line_plot_svg(title, "time (s)", time, {force, position, depth, age});
}

}  // namespace palpate::cli
