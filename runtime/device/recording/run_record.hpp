// SPDX-License-Identifier: MIT
// Layout of a recording of a run, as it is on disk: run-record.md.
#pragma once

#include "device/loop/safety_controller.hpp"
#include "palpate/output/device_frame.hpp"
#include "palpate/output/virtual_coupling.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <type_traits>

namespace palpate::device {

/// First in the file: what the forces were made with. Little-endian, IEEE 754, SI units.
struct RunHeader {
  static constexpr char kMagic[8] = {'P', 'A', 'L', 'P', 'R', 'U', 'N', 0};
  static constexpr std::uint32_t kVersion = 5;  ///< 1: no coupling, 2: no gloves, 3: other torques, 4: one place

  char magic[8] = {'P', 'A', 'L', 'P', 'R', 'U', 'N', 0};
  std::uint32_t version = kVersion;
  std::uint32_t header_size = 704;
  std::uint32_t record_size = 248;
  std::uint32_t tool = 0;                              ///< index in the response file
  std::uint64_t response_size = 0, response_hash = 0;  ///< of the whole response file: bytes, XXH64
  double rate = 0, limit = 0, torque_limit = 0, ramp_up = 0, ramp_down = 0, stale = 0, gap = 0, silent = 0,
         missed_share = 0;                                              ///< SafetyLimits
  double rotation[9] = {}, origin[3] = {}, scale = 0, force_scale = 0;  ///< DeviceFrame
  std::uint32_t stop_buttons = 0;
  std::uint32_t several = 0;  ///< 1: the tool was felt at several places (runtime::ContactSet<3>)
  char device[96] = {}, tool_name[64] = {}, response[256] = {};  ///< names, zero-terminated; the path as it was given
  double coupling_stiffness = 0, coupling_damping = 0;  ///< CouplingOptions, in the hand; 0: the tool is the device
  std::uint32_t coupling_trials = 0;
  std::uint32_t glove = 0;       ///< 1: a RunHand follows the header, and a HandRecord each record
  unsigned char spare[24] = {};  ///< zero
  std::uint64_t checksum = 0;    ///< XXH64 of all before
};

/// A tick: what it saw and what came of it.
struct RunRecord {
  std::uint32_t number = 0, missed = 0;
  double due = 0, time = 0, seconds = 0;
  double sample_time = 0;
  double rotation[9] = {}, position[3] = {};
  std::uint32_t sample_number = 0, buttons = 0;
  std::uint8_t phase = 0, sample_fault = 0, requests = 0;
  std::uint8_t mode = 0, cause = 0, fault = 0, usable = 0, spare = 0;
  std::uint64_t spare_too = 0;
  double depth = 0;
  double answer_force[3] = {};
  double force[3] = {}, torque[3] = {};  ///< of the command
  std::uint64_t checksum = 0;            ///< XXH64 of all before
};

/// Behind the record of a glove's tick: what its sensors read, what the source answered, and the command's pulls.
struct HandRecord {
  double joints[kFingers][kJoints] = {};
  double answer_pull[kFingers] = {}, pull[kFingers] = {};  ///< N
  std::uint64_t checksum = 0;                              ///< XXH64 of all before
};

/// A tick in memory; `hand` is of gloves alone.
struct RunTick : RunRecord {
  HandRecord hand;
};

/// Last in the file of a run that ended as it should.
struct RunEnd {
  static constexpr char kMagic[8] = {'P', 'A', 'L', 'P', 'E', 'N', 'D', 0};

  char magic[8] = {'P', 'A', 'L', 'P', 'E', 'N', 'D', 0};
  std::uint64_t ticks = 0;    ///< of the run
  std::uint64_t dropped = 0;  ///< of these not recorded: the disk was too slow
  unsigned char spare[32] = {};
  std::uint64_t checksum = 0;  ///< XXH64 of all before
};

static_assert(sizeof(RunHeader) == 704 && offsetof(RunHeader, rate) == 40 && offsetof(RunHeader, rotation) == 112 &&
              offsetof(RunHeader, device) == 232 && offsetof(RunHeader, coupling_stiffness) == 648 &&
              offsetof(RunHeader, checksum) == 696);
static_assert(sizeof(RunRecord) == 248 && offsetof(RunRecord, rotation) == 40 && offsetof(RunRecord, phase) == 144 &&
              offsetof(RunRecord, answer_force) == 168 && offsetof(RunRecord, checksum) == 240);
static_assert(offsetof(RunHeader, glove) == 668);
static_assert(sizeof(HandRecord) == 208 && offsetof(HandRecord, pull) == 160);
static_assert(sizeof(RunEnd) == 64 && offsetof(RunEnd, checksum) == 56);
static_assert(std::is_trivially_copyable_v<RunHeader> && std::is_trivially_copyable_v<RunTick>);

/// Fills in the limits of the safety controller, the frame, and the coupling in the hand where there is one.
void set_options(RunHeader& header, const SafetyLimits& options, const runtime::DeviceFrame& frame,
                 const std::optional<runtime::CouplingOptions>& coupling = {});
SafetyLimits safety_limits(const RunHeader& header);
runtime::DeviceFrame device_frame(const RunHeader& header);
std::optional<runtime::CouplingOptions> coupling_options(const RunHeader& header);

/// A tick as a record (its checksums are for whoever writes it), and back.
RunTick to_tick(const TickInput& seen, const TickOutput& out) noexcept;
TickInput to_input(const RunTick& tick);

/// Whether the same came of it, bit for bit.
bool same_output(const RunTick& tick, const TickOutput& out);

/// Sets or checks the last eight bytes.
template <class T>
void seal(T& part);
template <class T>
bool sealed(const T& part);

}  // namespace palpate::device
