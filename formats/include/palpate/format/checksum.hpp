// SPDX-License-Identifier: MIT
// XXH64, the checksum of response files and journals, written from its public specification.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace palpate::checksum {

namespace detail {
inline constexpr std::uint64_t kPrime1 = 0x9E3779B185EBCA87u, kPrime2 = 0xC2B2AE3D27D4EB4Fu,
                               kPrime3 = 0x165667B19E3779F9u, kPrime4 = 0x85EBCA77C2B2AE63u,
                               kPrime5 = 0x27D4EB2F165667C5u;
inline std::uint64_t rotate(std::uint64_t v, int bits) { return (v << bits) | (v >> (64 - bits)); }
inline std::uint64_t round(std::uint64_t lane, std::uint64_t word) {
  return rotate(lane + word * kPrime2, 31) * kPrime1;
}
template <class Word>
Word load(const unsigned char* p) {
  Word w;
  std::memcpy(&w, p, sizeof w);
  return w;
}
}  // namespace detail

/// XXH64 of `size` bytes fed in any number of pieces; seed 0, little-endian host.
class Xxh64 {
public:
  void update(const void* data, std::size_t size) {
    const auto* p = static_cast<const unsigned char*>(data);
    total_ += size;
    if (held_ > 0) {
      const std::size_t take = size < 32 - held_ ? size : 32 - held_;
      if (take > 0) std::memcpy(buffer_ + held_, p, take);
      held_ += take;
      p += take;
      size -= take;
      if (held_ < 32) return;
      stripe(buffer_);
      held_ = 0;
    }
    for (; size >= 32; p += 32, size -= 32) stripe(p);
    if (size > 0) std::memcpy(buffer_, p, size);
    held_ = size;
  }

  [[nodiscard]] std::uint64_t digest() const {
    using namespace detail;
    std::uint64_t h = kPrime5;
    if (total_ >= 32) {
      h = rotate(lane_[0], 1) + rotate(lane_[1], 7) + rotate(lane_[2], 12) + rotate(lane_[3], 18);
      for (const std::uint64_t lane : lane_) h = (h ^ detail::round(0, lane)) * kPrime1 + kPrime4;
    }
    h += total_;
    const unsigned char* p = buffer_;
    std::size_t left = held_;
    for (; left >= 8; p += 8, left -= 8) {
      h = rotate(h ^ detail::round(0, load<std::uint64_t>(p)), 27) * kPrime1 + kPrime4;
    }
    if (left >= 4) {
      h = rotate(h ^ (load<std::uint32_t>(p) * kPrime1), 23) * kPrime2 + kPrime3;
      p += 4;
      left -= 4;
    }
    for (; left > 0; ++p, --left) h = rotate(h ^ (*p * kPrime5), 11) * kPrime1;
    h = (h ^ (h >> 33)) * kPrime2;
    h = (h ^ (h >> 29)) * kPrime3;
    return h ^ (h >> 32);
  }

private:
  void stripe(const unsigned char* p) {
    for (int k = 0; k < 4; ++k) lane_[k] = detail::round(lane_[k], detail::load<std::uint64_t>(p + 8 * k));
  }

  std::uint64_t lane_[4] = {detail::kPrime1 + detail::kPrime2, detail::kPrime2, 0, 0 - detail::kPrime1};
  unsigned char buffer_[32] = {};
  std::size_t held_ = 0;
  std::uint64_t total_ = 0;
};

/// XXH64 of `size` bytes.
inline std::uint64_t of(const void* data, std::size_t size) {
  Xxh64 hash;
  hash.update(data, size);
  return hash.digest();
}

/// Checksum of a response file: XXH64 with the eight bytes at `field` taken as zero. size > field + 8.
inline std::uint64_t of_file(const unsigned char* bytes, std::size_t size, std::size_t field) {
  Xxh64 hash;
  const unsigned char zero[8] = {};
  hash.update(bytes, field);
  hash.update(zero, sizeof zero);
  hash.update(bytes + field + 8, size - field - 8);
  return hash.digest();
}

}  // namespace palpate::checksum
