// SPDX-License-Identifier: MIT
// Content hashes over libxxhash.
#include "formats/io/hash.hpp"

#include <xxhash.h>

#include <bit>
#include <new>

#include "formats/io/descriptor.hpp"
#include "formats/io/error.hpp"

static_assert(std::endian::native == std::endian::little, "hashes are taken on little-endian machines");

namespace palpate {

std::string to_hex(const Hash128& hash) {
  static constexpr char digits[] = "0123456789abcdef";
  std::string text(32, '0');
  for (std::size_t i = 0; i < 16; ++i) {
    text[i] = digits[(hash.high >> (60 - 4 * i)) & 15U];
    text[16 + i] = digits[(hash.low >> (60 - 4 * i)) & 15U];
  }
  return text;
}

Hash128 hash_from_hex(std::string_view text) {
  Hash128 hash;
  if (text.size() != 32) throw Error(ExitCode::bad_input, "a content hash has 32 hexadecimal digits");
  for (std::size_t i = 0; i < 32; ++i) {
    const char c = text[i];
    std::uint64_t digit = 0;
    if (c >= '0' && c <= '9') {
      digit = static_cast<std::uint64_t>(c - '0');
    } else if (c >= 'a' && c <= 'f') {
      digit = static_cast<std::uint64_t>(c - 'a') + 10U;
    } else {
      throw Error(ExitCode::bad_input, "a content hash has 32 lower-case hexadecimal digits");
    }
    std::uint64_t& word = i < 16 ? hash.high : hash.low;
    word = (word << 4U) | digit;
  }
  return hash;
}

Hash128 hash128(const void* data, std::size_t size) {
  const XXH128_hash_t hash = XXH3_128bits(data, size);
  return {hash.high64, hash.low64};
}

Hash128 hash128(std::string_view text) { return hash128(text.data(), text.size()); }

Hash128 hash_file(const std::filesystem::path& file) {
  Hasher hasher;
  read_blocks(file, "file", [&](std::string_view block) { hasher.bytes(block.data(), block.size()); });
  return hasher.digest();
}

struct Hasher::State {
  // xxhash's own allocator aligns the state as its vector code needs it.
  XXH3_state_t* xxh = XXH3_createState();
  State() {
    if (xxh == nullptr || XXH3_128bits_reset(xxh) != XXH_OK) throw std::bad_alloc();
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() { XXH3_freeState(xxh); }
};

Hasher::Hasher() : state_(std::make_unique<State>()) {}
Hasher::~Hasher() = default;

Hasher& Hasher::bytes(const void* data, std::size_t size) {
  if (size > 0) XXH3_128bits_update(state_->xxh, data, size);
  return *this;
}

Hasher& Hasher::text(std::string_view value) {
  number(static_cast<std::int64_t>(value.size()));
  return bytes(value.data(), value.size());
}

Hasher& Hasher::number(double value) { return bytes(&value, sizeof value); }
Hasher& Hasher::number(std::int64_t value) { return bytes(&value, sizeof value); }

Hash128 Hasher::digest() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(state_->xxh);
  return {hash.high64, hash.low64};
}

}  // namespace palpate
