// SPDX-License-Identifier: MIT
// Encoding and decoding of the journal's header and records (layout: journal-file.md).
#include "formats/journal/journal_record.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#include "palpate/format/checksum.hpp"

static_assert(std::endian::native == std::endian::little, "the journal is written on little-endian machines");

namespace palpate::journal {
namespace {

constexpr std::size_t sample_size = 104;
constexpr std::size_t torque_size = 48;  // rotation and torque, behind the sample
constexpr std::size_t outcome_size = 32;
constexpr std::size_t check_size = 24;

template <class T>
void put(Bytes& bytes, T value) {
  const std::size_t at = bytes.size();
  bytes.resize(at + sizeof value);
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

/// True for the kinds of sample that have a rotation and a torque.
constexpr bool has_torque(std::uint32_t kind) { return kind == static_cast<std::uint32_t>(SampleKind::grasped); }

template <class T>
T get(const unsigned char*& from) {
  T value{};
  std::memcpy(&value, from, sizeof value);
  from += sizeof value;
  return value;
}

Eigen::Vector3d get_vector(const unsigned char*& from) {
  Eigen::Vector3d v;
  for (int i = 0; i < 3; ++i) v[i] = get<double>(from);
  return v;
}

Bytes begin_record(std::size_t payload, RecordType type, std::uint32_t pair) {
  Bytes bytes;
  bytes.reserve(prefix_size + payload + checksum_size);
  put(bytes, static_cast<std::uint32_t>(payload));
  put(bytes, static_cast<std::uint32_t>(type));
  put(bytes, pair);
  put(bytes, std::uint32_t{0});
  return bytes;
}

}  // namespace

Bytes encode_header(const Hash128& manifest) {
  Bytes bytes(magic, magic + 8);
  put(bytes, version);
  put(bytes, static_cast<std::uint32_t>(header_size));
  put(bytes, manifest.high);
  put(bytes, manifest.low);
  while (bytes.size() < header_size - checksum_size) put(bytes, std::uint64_t{0});
  put(bytes, checksum::of(bytes.data(), bytes.size()));
  return bytes;
}

Bytes encode(std::uint32_t pair, const Sample& sample) {
  const auto kind = static_cast<std::uint32_t>(sample.kind);
  const bool torque = has_torque(kind);
  Bytes bytes = begin_record(sample_size + (torque ? torque_size : 0), RecordType::sample, pair);
  put(bytes, kind);
  put(bytes, static_cast<std::uint32_t>(sample.index));
  for (int i = 0; i < 3; ++i) put(bytes, sample.deflection[i]);
  for (int i = 0; i < 3; ++i) put(bytes, sample.force[i]);
  put(bytes, sample.friction_limit);
  put(bytes, sample.contact_area);
  put(bytes, sample.penetration);
  put(bytes, sample.min_jacobian);
  put(bytes, sample.error_estimate);
  put(bytes, sample.contact_points);
  put(bytes, sample.iterations);
  for (int i = 0; i < 3 && torque; ++i) put(bytes, sample.rotation[i]);
  for (int i = 0; i < 3 && torque; ++i) put(bytes, sample.torque[i]);
  put(bytes, checksum::of(bytes.data(), bytes.size()));
  return bytes;
}

Bytes encode(std::uint32_t pair, const PairOutcome& outcome) {
  const std::size_t cause = std::min(outcome.cause.size(), max_cause);
  Bytes bytes = begin_record(outcome_size + cause, RecordType::outcome, pair);
  put(bytes, std::uint32_t{outcome.accepted ? 1U : 0U});
  put(bytes, outcome.nodes);
  put(bytes, outcome.normal_solves);
  put(bytes, outcome.tangential_solves);
  put(bytes, outcome.factorisations);
  put(bytes, static_cast<std::uint32_t>(cause));
  put(bytes, outcome.first_touch);
  bytes.insert(bytes.end(), outcome.cause.begin(), outcome.cause.begin() + static_cast<std::ptrdiff_t>(cause));
  put(bytes, checksum::of(bytes.data(), bytes.size()));
  return bytes;
}

Bytes encode(std::uint32_t pair, const PairCheck& check) {
  const std::size_t cause = std::min(check.cause.size(), max_cause);
  Bytes bytes = begin_record(check_size + cause, RecordType::check, pair);
  put(bytes, check.nodes);
  put(bytes, check.compared);
  put(bytes, check.within_estimate);
  put(bytes, static_cast<std::uint32_t>(cause));
  put(bytes, check.difference);
  bytes.insert(bytes.end(), check.cause.begin(), check.cause.begin() + static_cast<std::ptrdiff_t>(cause));
  put(bytes, checksum::of(bytes.data(), bytes.size()));
  return bytes;
}

std::optional<RecordView> whole_record(const unsigned char* data, std::size_t available) {
  if (available < prefix_size + checksum_size) return std::nullopt;
  const unsigned char* at = data;
  RecordView view;
  view.payload_size = get<std::uint32_t>(at);
  const auto type = get<std::uint32_t>(at);
  view.pair = get<std::uint32_t>(at);
  const auto zero = get<std::uint32_t>(at);
  view.payload = at;
  if (zero != 0 || view.payload_size > max_payload) return std::nullopt;
  if (type < static_cast<std::uint32_t>(RecordType::sample) || type > static_cast<std::uint32_t>(RecordType::check)) {
    return std::nullopt;
  }
  view.size = prefix_size + view.payload_size + checksum_size;
  if (view.size > available) return std::nullopt;
  const unsigned char* end = data + prefix_size + view.payload_size;
  if (checksum::of(data, prefix_size + view.payload_size) != get<std::uint64_t>(end)) return std::nullopt;

  view.type = static_cast<RecordType>(type);
  if (view.type == RecordType::sample) {
    const auto kind = get<std::uint32_t>(at);
    const auto index = get<std::uint32_t>(at);
    const std::size_t size = sample_size + (has_torque(kind) ? torque_size : 0);
    if (view.payload_size != size || kind > 4 || index > 0xFFFFU) return std::nullopt;
    return view;
  }
  const bool check = view.type == RecordType::check;
  const std::size_t fixed = check ? check_size : outcome_size;
  if (view.payload_size < fixed) return std::nullopt;
  const unsigned char* cause = view.payload + (check ? 12 : 20);
  if (get<std::uint32_t>(cause) != view.payload_size - fixed) return std::nullopt;
  return view;
}

Sample decode_sample(const RecordView& record) {
  const unsigned char* at = record.payload;
  Sample sample;
  sample.kind = static_cast<SampleKind>(get<std::uint32_t>(at));
  sample.index = static_cast<std::uint16_t>(get<std::uint32_t>(at));
  sample.deflection = get_vector(at);
  sample.force = get_vector(at);
  sample.friction_limit = get<double>(at);
  sample.contact_area = get<double>(at);
  sample.penetration = get<double>(at);
  sample.min_jacobian = get<double>(at);
  sample.error_estimate = get<double>(at);
  sample.contact_points = get<std::uint32_t>(at);
  sample.iterations = get<std::uint32_t>(at);
  if (has_torque(static_cast<std::uint32_t>(sample.kind))) {
    sample.rotation = get_vector(at);
    sample.torque = get_vector(at);
  }
  return sample;
}

PairOutcome decode_outcome(const RecordView& record) {
  const unsigned char* at = record.payload;
  PairOutcome outcome;
  outcome.accepted = get<std::uint32_t>(at) != 0;
  outcome.nodes = get<std::uint32_t>(at);
  outcome.normal_solves = get<std::uint32_t>(at);
  outcome.tangential_solves = get<std::uint32_t>(at);
  outcome.factorisations = get<std::uint32_t>(at);
  const auto cause = get<std::uint32_t>(at);
  outcome.first_touch = get<double>(at);
  outcome.cause.assign(reinterpret_cast<const char*>(at), cause);
  return outcome;
}

PairCheck decode_check(const RecordView& record) {
  const unsigned char* at = record.payload;
  PairCheck check;
  check.nodes = get<std::uint32_t>(at);
  check.compared = get<std::uint32_t>(at);
  check.within_estimate = get<std::uint32_t>(at);
  const auto cause = get<std::uint32_t>(at);
  check.difference = get<double>(at);
  check.cause.assign(reinterpret_cast<const char*>(at), cause);
  return check;
}

}  // namespace palpate::journal
