// SPDX-License-Identifier: MIT
// Content hashes: what ties a journal to its manifest and a response file to its inputs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace palpate {

/// 128-bit content hash (XXH3). Not cryptographic: it finds accidents, not forgeries.
struct Hash128 {
  std::uint64_t high = 0, low = 0;
  friend bool operator==(const Hash128&, const Hash128&) = default;
};

/// 32 lower-case hexadecimal digits, high word first.
std::string to_hex(const Hash128& hash);

/// Reads what to_hex wrote. Throws Error(bad_input) on anything but 32 hexadecimal digits.
Hash128 hash_from_hex(std::string_view text);

/// Hash of `size` bytes.
Hash128 hash128(const void* data, std::size_t size);
Hash128 hash128(std::string_view text);

/// Hash of a file's bytes. Throws Error(io) when it cannot be read.
Hash128 hash_file(const std::filesystem::path& file);

/// Hash of data that arrives in pieces; numbers enter as their little-endian bytes.
class Hasher {
public:
  Hasher();
  ~Hasher();
  Hasher(const Hasher&) = delete;
  Hasher& operator=(const Hasher&) = delete;

  Hasher& bytes(const void* data, std::size_t size);
  /// The length enters too, so that ("ab", "c") and ("a", "bc") differ.
  Hasher& text(std::string_view value);
  Hasher& number(double value);
  Hasher& number(std::int64_t value);

  [[nodiscard]] Hash128 digest() const;

private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace palpate
