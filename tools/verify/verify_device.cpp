// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/verify/verify_device.hpp"

#include "device/simulation/sim_glove.hpp"
#include "device/stability/safety.hpp"
#include "formats/io/error.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/output.hpp"
#include "tools/cli/response_input.hpp"
#include "tools/cli/verify_checks.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

namespace palpate::cli {
namespace {

using Json = nlohmann::ordered_json;

const device::SimKind& kind_of(const std::string& name) {
  for (const std::string& tried : {name, "sim-" + name}) {
    if (const device::SimKind* kind = device::find_sim_kind(tried)) return *kind;
  }
  for (const device::DeviceKind& kind : device::kDevices) {
    if (!device::is_called(kind, name)) continue;
    if (const device::SimKind* stand_in = device::find_stand_in(kind)) return *stand_in;
    throw Error(ExitCode::usage, "--device " + name + ": no bound is computed, because its mechanics are not known");
  }
  if (name == device::kSimGlove.name || name == "glove") {
    throw Error(ExitCode::usage,
                "--device " + name + ": no bound is computed for gloves, only for devices with a handle");
  }
  std::string known;
  for (const device::SimKind& kind : device::sim_kinds()) {
    const std::string called = kind.kind.name;
    known += (known.empty() ? "" : ", ") + (called.starts_with("sim-") ? called.substr(4) + ", " : "") + called;
  }
  for (const device::DeviceKind& kind : device::kDevices) {
    const device::SimKind* const stand_in = device::find_stand_in(kind);
    if (stand_in != nullptr && known.find(kind.key) == std::string::npos) known += std::string(", ") + kind.key;
  }
  throw Error(ExitCode::usage, "--device " + name + ": not known; there are " + known);
}

const char* verdict(const device::Safety& s) {
  if (!s.settles()) return "oscillates in a usual grip";
  return s.passive_for_any_hand() ? "safe in any hand" : "settles in a usual grip, not in every hand";
}

Json to_json(const device::Safety& s, const DeviceCommand& command, const device::SimKind& kind) {
  return {{"file", command.response},
          {"device", kind.kind.name},
          {"rate_Hz", command.rate},
          {"scale", command.scale},
          {"stiffest",
           {{"stiffness_N_per_m", s.file.slope.norm},
            {"tool", s.file.tool},
            {"site", s.file.site},
            {"tool_vertex", s.file.tool_vertex},
            {"depth_m", s.file.depth}}},
          {"stiffness_in_hand_N_per_m", s.stiffness},
          {"passive_by_damping_N_per_m", s.passive.by_damping},
          {"passive_by_friction_N_per_m", s.passive.by_friction},
          {"onset_N_per_m", s.onset.stiffness},
          {"onset_Hz", s.onset.frequency},
          {"verdict", verdict(s)},
          {"largest_scale", s.largest_scale},
          {"largest_coupling_N_per_m", s.largest_coupling}};
}

std::string to_text(const device::Safety& s, const DeviceCommand& command, const device::SimKind& kind) {
  char text[1024];
  std::snprintf(text, sizeof text,
                "stiffest response: %.0f N/m (tool %u, site %u, %.1f mm deep), in the hand %.0f N/m\n"
                "%s at %.0f Hz: any hand up to %.0f N/m (hold and delay %.0f, encoder steps %.0f)\n"
                "in a usual grip oscillations of 1 mm begin at %.0f N/m, %.0f Hz\n"
                "%s: %s\n",
                s.file.slope.norm, s.file.tool, s.file.site, 1e3 * s.file.depth, s.stiffness, kind.kind.name,
                command.rate, s.passive.least(), s.passive.by_damping, s.passive.by_friction, s.onset.stiffness,
                s.onset.frequency, command.response.c_str(), verdict(s));
  std::string out = text;
  if (!s.passive_for_any_hand()) {
    std::snprintf(text, sizeof text,
                  "safe in any hand with forces scaled by %.3g at most, or a virtual coupling of at most %.0f N/m "
                  "('palpate drive --coupling auto'), or the passivity controller\n",
                  s.largest_scale, s.largest_coupling);
    out += text;
  }
  return out;
}

}  // namespace

void run_device_command(const DeviceCommand& command, const Globals& globals) {
  const device::SimKind& kind = kind_of(command.device);
  const ResponseInput input(command.response);
  device::SafetyOptions options;
  options.timing.period = 1 / command.rate;
  options.scale = command.scale;
  if (const auto wrong = options.validate()) throw Error(ExitCode::usage, "--rate, --scale: " + *wrong);
  const device::Safety s = safety(input.view(), kind.plant, options);
  const Json json = to_json(s, command, kind);
  if (!command.report.empty()) write_report(command.report, json);
  if (globals.json) {
    print_json(json);
  } else {
    print(to_text(s, command, kind));
  }
  if (!s.settles()) throw Error(ExitCode::tolerance, command.response + ": " + verdict(s) + " on " + kind.kind.name);
}

}  // namespace palpate::cli
