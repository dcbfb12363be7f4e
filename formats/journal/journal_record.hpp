// SPDX-License-Identifier: MIT
// Bytes of the journal's header and records; the journal's own files use this, nobody else.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "formats/io/hash.hpp"
#include "formats/journal/samples.hpp"

namespace palpate::journal {

inline constexpr std::size_t header_size = 64;
inline constexpr std::size_t prefix_size = 16;   ///< of a record, before its payload
inline constexpr std::size_t checksum_size = 8;  ///< of a record, after its payload
inline constexpr std::size_t max_payload = 65536;
inline constexpr std::size_t max_cause = 4096;  ///< longer causes are cut

inline constexpr std::uint32_t version = 1;
inline constexpr char magic[9] = "PALPJRNL";

enum class RecordType : std::uint32_t { sample = 1, outcome = 2, check = 3 };

using Bytes = std::vector<unsigned char>;

Bytes encode_header(const Hash128& manifest);
Bytes encode(std::uint32_t pair, const Sample& sample);
Bytes encode(std::uint32_t pair, const PairOutcome& outcome);
Bytes encode(std::uint32_t pair, const PairCheck& check);

/// The position of a whole record in a buffer.
struct RecordView {
  RecordType type = RecordType::sample;
  std::uint32_t pair = 0;
  const unsigned char* payload = nullptr;
  std::size_t payload_size = 0;
  std::size_t size = 0;  ///< of the whole record
};

/// The record at `data`, when a whole one with a right checksum and a known layout is there.
std::optional<RecordView> whole_record(const unsigned char* data, std::size_t available);

Sample decode_sample(const RecordView& record);
PairOutcome decode_outcome(const RecordView& record);
PairCheck decode_check(const RecordView& record);

}  // namespace palpate::journal
