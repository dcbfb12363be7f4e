// SPDX-License-Identifier: GPL-3.0-or-later
// palpate drive: a baked body on a haptic device, live; leaves a recording and a plot.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "device/loop/loop.hpp"
#include "device/loop/stop_signals.hpp"
#include "device/recording/run_writer.hpp"
#include "formats/io/error.hpp"
#include "formats/io/file.hpp"
#include "formats/io/same_file.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/commands.hpp"
#include "tools/cli/output.hpp"
#include "tools/drive/drive_station.hpp"
#include "tools/drive/drive_view.hpp"
#include "tools/play/play_run.hpp"

namespace palpate::cli {
namespace {

using device::Cause;
using device::Histogram;
using device::LoopReport;

struct DriveArguments {
  std::string file, device, tool, record, plot, at, up = "z", device_up, firmware;
  double rate = 1000, seconds = 0, scale = 1, force_scale = 1, limit = 3, ramp = 1;
  CouplingArguments coupling;
  int core = -1, priority = 80;
  std::optional<double> stop_button;
  bool list = false, no_record = false, single = false;
};

runtime::Vec3 point(const std::string& text) {
  std::istringstream stream(text);
  runtime::Vec3 at;
  char comma[2] = {};
  std::string rest;
  if (!(stream >> at.x >> comma[0] >> at.y >> comma[1] >> at.z) || comma[0] != ',' || comma[1] != ',' ||
      stream >> rest || !(length(at) < 1e6)) {
    throw Error(ExitCode::usage, "--at: got '" + text + "'; expected three numbers X,Y,Z in m");
  }
  return at;
}

runtime::Vec3 axis(const std::string& option, const std::string& text) {
  if (const auto named = axis_named(text)) return *named;
  throw Error(ExitCode::usage, option + ": got '" + text + "'; allowed x, y, z, -x, -y, -z");
}

std::uint32_t button_mask(const std::optional<double>& number) {
  if (!number) return ~std::uint32_t{0};
  return *number < 1 ? 0 : std::uint32_t{1} << static_cast<int>(*number - 1);
}

device::LoopOptions loop_options(const DriveArguments& options, const device::DeviceKind& kind) {
  device::LoopOptions loop;
  loop.seconds = options.seconds;
  loop.safety.rate = options.rate;
  loop.safety.limit = std::min(options.limit, kind.peak_force);
  loop.safety.ramp_up = options.ramp;
  loop.safety.stop_buttons = button_mask(options.stop_button);
  loop.realtime.core = options.core;
  loop.realtime.priority = options.priority;
  if (const char* wrong = loop.validate()) throw Error(ExitCode::usage, wrong);
  return loop;
}

FrameOptions frame_options(const DriveArguments& options, const device::DeviceKind& kind) {
  FrameOptions frame;
  frame.up = axis("--up", options.up);
  frame.device_up = options.device_up.empty() ? kind.up : axis("--device-up", options.device_up);
  frame.scale = options.scale;
  frame.force_scale = options.force_scale;
  // Within a hand's reach in both directions from the middle of the workspace.
  if (kind.workspace_radius > 0) frame.gap = std::min(frame.gap, 0.25 * kind.workspace_radius);
  if (!options.at.empty()) frame.at = point(options.at);
  return frame;
}

template <std::size_t N>
void name_in(char (&field)[N], const std::string& text) {
  std::strncpy(field, text.c_str(), N - 1);
}

device::RunHeader run_header(const device::LoopOptions& loop, const Station& station, const ResponseInput& input,
                             std::uint32_t tool, const DriveTitle& title) {
  device::RunHeader header;
  device::set_options(header, loop.safety, station.frame, station.coupling);
  header.tool = tool;
  header.several = station.several ? 1 : 0;
  header.response_size = input.view().size;
  header.response_hash = response_hash(input);
  name_in(header.device, title.device);
  name_in(header.tool_name, title.tool);
  name_in(header.response, title.file);
  return header;
}

nlohmann::ordered_json histogram_json(const Histogram& h) {
  return {{"count", h.count()},      {"mean", h.mean()},          {"median", h.quantile(0.5)},
          {"p99", h.quantile(0.99)}, {"p999", h.quantile(0.999)}, {"most", h.most()}};
}

/// Live until the loop has stopped.
void watch(device::ForceLoop& loop, device::StopFlags& stop, const device::RunWriter* record, const DriveTitle& title,
           const Globals& globals) {
  const Keys keys;
  DriveView view(title);
  const auto dropped = [&] { return record != nullptr ? record->dropped() : 0; };
  while (loop.running()) {
    const int key = keys.wait(50);
    if (key == ' ') stop.emergency_stop();
    if (key == 'q') stop.stop();
    if (!globals.quiet) view.show(loop.report(), dropped());
    if (key == 's') {
      std::fputs(drive_statistics(loop.report(), dropped()).c_str(), stderr);
      view.rest();
    }
  }
  loop.join();
  if (!globals.quiet) view.show(loop.report(), dropped());
}

/// Throws the cause of a run that did not end by a requested stop.
void throw_cause(const LoopReport& report) {
  const std::string what = "the run ended: " + standing(report.out);
  switch (report.out.cause) {
    case Cause::device:
    case Cause::stale:
      throw Error(ExitCode::io, what);
    case Cause::deadlines:
    case Cause::late:
      throw Error(ExitCode::tolerance, what);
    case Cause::source:
    case Cause::pose:
      throw Error(ExitCode::numerical, what);
    default:
      return;
  }
}

void report_run(const DriveArguments& options, const Globals& globals, const DriveTitle& title,
                const std::optional<runtime::CouplingOptions>& coupling, const LoopReport& report,
                const device::Realtime& granted, const device::RunWritten& written) {
  if (!globals.json) return print(drive_statistics(report, written.dropped));
  print_json({{"file", options.file},
              {"tool", title.tool},
              {"device", title.device},
              {"recording", options.record},
              {"plot", options.plot},
              {"ended", device::name(report.out.cause)},
              {"fault", device::name(report.out.fault)},
              {"seconds", report.elapsed},
              {"ticks", report.ticks},
              {"rate", report.rate()},
              {"asked_rate", options.rate},
              {"missed_deadlines", report.missed},
              {"late_ticks", report.late_ticks},
              {"stale_ticks", report.stale_ticks},
              {"suspensions", report.suspensions},
              {"ticks_not_recorded", written.dropped},
              {"peak_force", report.peak_force},
              {"limit", title.limit},
              {"coupling", coupling ? nlohmann::ordered_json(coupling->stiffness) : nlohmann::ordered_json()},
              {"coupling_damping", coupling ? coupling->damping : 0},
              {"period", histogram_json(report.period)},
              {"late", histogram_json(report.late)},
              {"sample_age", histogram_json(report.age)},
              {"realtime", granted.fifo},
              {"locked_memory", granted.locked},
              {"core", granted.pinned ? options.core : -1}});
}

nlohmann::ordered_json devices_json() {
  const DeviceList list = known_devices();
  nlohmann::ordered_json devices = nlohmann::ordered_json::array();
  for (const ListedDevice& d : list.devices) {
    devices.push_back({{"name", d.name}, {"what", d.what}, {"peak_force", d.peak_force}, {"state", d.state}});
  }
  return {{"devices", devices}, {"unseen", list.unseen}};
}

void run_drive(DriveArguments options, const Globals& globals) {
  if (options.list) return globals.json ? print_json(devices_json()) : print(list_devices());
  if (options.file.empty()) throw Error(ExitCode::usage, "which response file? (or --list)");
  const device::DeviceKind& kind = find_drive_kind(options.device);
  const device::LoopOptions loop_settings = loop_options(options, kind);
  // The Falcon alone reads it, and a name that is wrong is wrong with any device.
  if (!options.firmware.empty() && !std::filesystem::is_regular_file(options.firmware)) {
    throw Error(ExitCode::io, options.firmware + ": named by --firmware, but it is no regular file");
  }
  const ResponseInput input(options.file);
  const std::uint32_t tool = input.tool(options.tool);
  const DriveTitle title{options.file, input.view().tools[tool].name, kind.name, loop_settings.safety.limit,
                         kind.glove};
  options.coupling.rate = options.rate;
  if (!options.single && !kind.glove) options.coupling.places = 3;
  // Before the last run's recording is replaced.
  const Station station = set_up(input.view(), tool, kind,
                                 {{options.device, options.rate, options.priority, options.firmware, {}},
                                  frame_options(options, kind),
                                  options.coupling,
                                  loop_settings.safety.limit,
                                  options.single},
                                 globals);

  const std::string stem = std::filesystem::path(options.file).stem().string();
  if (options.record.empty() && !options.no_record) options.record = stem + ".palprun";
  if (options.plot.empty() && !options.no_record) options.plot = stem + "-run.svg";
  refuse_same({options.record, options.plot}, {options.file, options.firmware});
  // It is written last: a place that cannot be written to would waste the run.
  if (!options.plot.empty()) check_writable(options.plot);
  std::unique_ptr<device::RunWriter> record;
  if (!options.no_record) {
    record = std::make_unique<device::RunWriter>(options.record, run_header(loop_settings, station, input, tool, title),
                                                 station.hand);
    if (!record->error().empty()) throw Error(ExitCode::io, options.record + ": " + record->error());
  }

  LoopReport report;
  device::Realtime granted;
  {
    device::StopFlags stop;
    const device::StopSignals signals(stop, Keys::restore_terminal);
    device::ForceLoop loop(*station.device, *station.source, loop_settings, stop, record.get());
    granted = loop.start();
    if (!granted.refused.empty()) warn("not granted: " + granted.refused + "; the loop may be late");
    watch(loop, stop, record.get(), title, globals);
    report = loop.report();
    station.device->close();
  }
  device::release_memory();
  const device::RunWritten written = record ? record->finish() : device::RunWritten{};
  report_run(options, globals, title, station.coupling, report, granted, written);
  if (record && report.ticks > written.dropped) {
    write_file(options.plot, run_svg(read_run(options.record), "Tool '" + title.tool + "' on " + title.device));
  }
  throw_cause(report);
  if (!written.error.empty()) {
    throw Error(ExitCode::io, options.record + ": " + written.error + "; " + std::to_string(written.dropped) +
                                  " ticks are not recorded");
  }
}

}  // namespace

void add_drive(CLI::App& app, Globals& globals) {
  auto options = std::make_shared<DriveArguments>();
  Command command(app, "drive", "Drives a haptic device with a response file");
  command.option("file", options->file, "Response file (.palp)");
  command.option("--device", options->device, "Name of the device; default: the one that is plugged in").named("NAME");
  command.flag("--list", options->list, "Print the devices that are known, and stop");
  command.option("--rate", options->rate, "Rate of the force loop (Hz)").check(number_in(100, 10000)).shows_default();
  command.option("--seconds", options->seconds, "Stop after this time; default: run until Ctrl-C")
      .check(number_in(1e-3, 1e6));
  command.option("--limit", options->limit, "Largest force (N); never above the device's own")
      .check(number_in(1e-3, 100))
      .shows_default();
  command.option("--ramp", options->ramp, "Time from no force to all of it (s)")
      .check(number_in(0.01, 60))
      .shows_default();
  command.option("--tool", options->tool, "Name of the tool; default: the file's first");
  command.flag("--single", options->single, "Follow the nearest wall alone; without it up to three walls are felt");
  command.option("--scale", options->scale, "Metres of the scene for one of the hand")
      .check(number_in(1e-4, 1e4))
      .shows_default();
  command.option("--force-scale", options->force_scale, "Newtons on the hand for one of the scene")
      .check(number_in(0, 1e4))
      .shows_default();
  command.flag("--unsafe-force-scale", options->coupling.unsafe_scale,
               "Drive a --force-scale whose forces oscillate in a usual grip (verify --device)");
  command
      .option("--coupling", options->coupling.stiffness,
              "Virtual coupling between device and tool: N/m in the hand, or auto: as stiff as is safe in any hand")
      .named("auto|STIFFNESS");
  command.option("--coupling-damping", options->coupling.damping, "Damping of the coupling (N s/m in the hand)")
      .check(number_in(0, 1e6))
      .needs("--coupling");
  command.option("--at", options->at, "Position of the device's origin in the scene (m); default: over the body's top")
      .named("X,Y,Z");
  command.option("--up", options->up, "Upward axis of the scene: x, y, z, -x, -y or -z").shows_default().named("AXIS");
  command.option("--device-up", options->device_up, "Upward axis of the device; default: the kind's own").named("AXIS");
  command
      .option("--stop-button", options->stop_button,
              "The only button of the device that is an emergency stop, from 1 (0: none); default: all are")
      .check(whole_in(0, 32));
  command.option("--core", options->core, "Processor that the force loop stays on (-1: any)")
      .check(whole_in(-1, 1023))
      .shows_default();
  command.option("--priority", options->priority, "Real-time priority of the force loop (0: none)")
      .check(whole_in(0, 98))
      .shows_default();
  command.option("--firmware", options->firmware, "The maker's firmware, for a Falcon on which none runs yet")
      .named("FILE");
  const Option record =
      command.option("--record", options->record, "Recording for 'palpate play'; default: NAME.palprun here, replaced")
          .named("FILE");
  const Option plot =
      command.option("--plot", options->plot, "Plot of the run (SVG); default: NAME-run.svg here, replaced")
          .named("FILE");
  command.flag("--no-record", options->no_record, "Leave no recording and no plot").excludes(record).excludes(plot);
  command.runs([options, command, &globals] {
    options->coupling.scaled = command.given("--force-scale");
    run_drive(*options, globals);
  });
}

}  // namespace palpate::cli
