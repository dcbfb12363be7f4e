// SPDX-License-Identifier: GPL-3.0-or-later
// Bytes between Palpate and its TetGen worker: native numbers, both ends are the same machine.
//   request:  header, vertices (3 doubles each), sizes (1 double each), facets (3 int32 each), switches (chars)
//   response: header, points (3 doubles each), tets (4 int32 each)
#pragma once

#include <cstdint>

namespace palpate::mesh::tetgen {

inline constexpr std::uint32_t kRequestMagic = 0x50545131;   // "PTQ1"
inline constexpr std::uint32_t kResponseMagic = 0x50545231;  // "PTR1"
inline constexpr std::uint32_t kMostItems = 20000000;        // points, facets or tets

struct RequestHeader {
  std::uint32_t magic, vertices, facets, switches;
};

struct ResponseHeader {
  std::uint32_t magic, points, tets;
  std::int32_t failure;  // 0, or the number that TetGen failed with
};

}  // namespace palpate::mesh::tetgen
