// SPDX-License-Identifier: MIT
#include "device/recording/run_reader.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace palpate::device {
namespace {

RunLog failed(const std::string& error) {
  RunLog log;
  log.error = error;
  return log;
}

bool terminated(const char* text, std::size_t size) { return std::memchr(text, 0, size) != nullptr; }

// Only what an honest writer cannot have written: the checksum has found the accidents.
const char* wrong_in(const RunHeader& h) {
  const runtime::DeviceFrame frame = device_frame(h);
  if (const char* wrong = safety_limits(h).validate()) return wrong;
  if (!frame.pose.valid()) return "the frame is no pose";
  if (!(frame.scale > 0 && std::isfinite(frame.scale))) return "the scale is not above 0";
  if (!(frame.force_scale >= 0 && std::isfinite(frame.force_scale))) return "the scale of the force is below 0";
  if (const auto coupling = coupling_options(h)) {
    if (const char* wrong = coupling->validate()) return wrong;
    if (!(frame.force_scale > 0)) return "a coupling, and no force";
  }
  if (h.glove > 1 || (h.glove == 1 && h.version < 3)) return "neither of a glove nor of another device";
  if (h.several > 1 || (h.several == 1 && (h.version < 5 || h.glove == 1))) {
    return "felt neither at one place nor at several";
  }
  // Up to version 3 a torque was the scene's times force_scale alone: another one, where metres are scaled.
  if (h.version < 4 && h.glove == 0 && h.torque_limit > 0 && frame.scale != 1) {
    return "torques of a scaled hand, which versions before 4 made wrong: they cannot be replayed";
  }
  if (!terminated(h.device, sizeof h.device) || !terminated(h.tool_name, sizeof h.tool_name) ||
      !terminated(h.response, sizeof h.response)) {
    return "a name does not end";
  }
  return nullptr;
}

const char* wrong_in(const RunRecord& r, std::uint32_t before) {
  if (r.number <= before) return "its number does not follow";
  if (r.phase > static_cast<std::uint8_t>(Phase::stopped)) return "unknown phase";
  if (r.sample_fault > static_cast<std::uint8_t>(Fault::reported) ||
      r.fault > static_cast<std::uint8_t>(Fault::reported)) {
    return "unknown fault";
  }
  if (r.mode > static_cast<std::uint8_t>(Mode::stopped) || r.cause > static_cast<std::uint8_t>(Cause::deadlines)) {
    return "unknown mode or cause";
  }
  return nullptr;
}

}  // namespace

bool is_run_log(const void* data, std::size_t size) {
  return size >= sizeof RunHeader::kMagic && std::memcmp(data, RunHeader::kMagic, sizeof RunHeader::kMagic) == 0;
}

RunLog read_run_log(const void* data, std::size_t size) {
  const auto* bytes = static_cast<const unsigned char*>(data);
  RunLog log;
  if (!is_run_log(data, size)) return failed("not a recording of a run: it does not begin with PALPRUN");
  if (size < sizeof(RunHeader)) return failed("cut short within its header");
  std::memcpy(&log.header, bytes, sizeof(RunHeader));
  if (log.header.version < 1 || log.header.version > RunHeader::kVersion) {
    return failed("version " + std::to_string(log.header.version) + " of the recording, this reads 1 to " +
                  std::to_string(RunHeader::kVersion));
  }
  if (!sealed(log.header)) return failed("the checksum of its header is wrong");
  if (const char* wrong = wrong_in(log.header)) return failed(std::string("header: ") + wrong);
  const bool glove = log.header.glove == 1;
  const std::size_t record_size = sizeof(RunRecord) + (glove ? sizeof(HandRecord) : 0);
  std::size_t at = sizeof(RunHeader) + (glove ? sizeof(RunHand) : 0);
  if (log.header.header_size != at || log.header.record_size != record_size) {
    return failed("sizes of header and records that its version does not have");
  }
  if (size < at) return failed("cut short within its header");
  if (glove) {
    std::memcpy(&log.hand.emplace(), bytes + sizeof(RunHeader), sizeof(RunHand));
    if (!sealed(*log.hand)) return failed("the checksum of its hand is wrong");
    if (const char* wrong = wrong_in(*log.hand)) return failed(std::string("hand: ") + wrong);
  }

  if ((size - at) % record_size == sizeof(RunEnd)) {
    std::memcpy(&log.end, bytes + size - sizeof(RunEnd), sizeof(RunEnd));
    log.complete = std::memcmp(log.end.magic, RunEnd::kMagic, sizeof log.end.magic) == 0 && sealed(log.end);
    if (log.complete) size -= sizeof(RunEnd);
  }
  log.records.reserve((size - at) / record_size);
  for (std::uint32_t number = 0; size - at >= record_size; at += record_size) {
    RunTick tick;
    RunRecord& record = tick;
    std::memcpy(&record, bytes + at, sizeof record);
    if (glove) std::memcpy(&tick.hand, bytes + at + sizeof record, sizeof tick.hand);
    const std::string where = "record " + std::to_string(log.records.size()) + " (byte " + std::to_string(at) + "): ";
    if (!sealed(record) || (glove && !sealed(tick.hand))) return failed(where + "its checksum is wrong");
    if (const char* wrong = wrong_in(record, number)) return failed(where + wrong);
    number = record.number;
    log.records.push_back(tick);
  }
  log.torn = size - at;
  if (log.complete && log.records.size() + log.end.dropped != log.end.ticks) {
    return failed("its end counts " + std::to_string(log.end.ticks) + " ticks, " + std::to_string(log.end.dropped) +
                  " of them dropped; it has " + std::to_string(log.records.size()));
  }
  log.ok = true;
  return log;
}

}  // namespace palpate::device
