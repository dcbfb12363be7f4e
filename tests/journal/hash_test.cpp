// SPDX-License-Identifier: GPL-3.0-or-later
// Content hashes: published values, pieces against the whole, reading back.
#include "formats/io/hash.hpp"

#include <gtest/gtest.h>

#include <cstdio>

#include "formats/io/error.hpp"

namespace palpate {
namespace {

TEST(Hash, MeetsAPublishedValue) { EXPECT_EQ(to_hex(hash128("")), "99aa06d3014798d86001c324468d497f"); }

TEST(Hash, PiecesEqualTheWhole) {
  const std::string text = "palpate palpate palpate palpate palpate palpate palpate palpate palpate palpate";
  for (std::size_t cut = 0; cut <= text.size(); ++cut) {
    Hasher hasher;
    hasher.bytes(text.data(), cut).bytes(text.data() + cut, text.size() - cut);
    EXPECT_EQ(hasher.digest(), hash128(text));
  }
}

TEST(Hash, TextKeepsItsBorders) {
  EXPECT_FALSE(Hasher().text("ab").text("c").digest() == Hasher().text("a").text("bc").digest());
}

TEST(Hash, HexRoundTrip) {
  const Hash128 hash = hash128("liver");
  EXPECT_EQ(hash_from_hex(to_hex(hash)), hash);
  EXPECT_THROW(hash_from_hex("12"), Error);
  EXPECT_THROW(hash_from_hex(std::string(31, 'a') + "x"), Error);
  EXPECT_THROW(hash_from_hex(std::string(32, 'A')), Error);
}

TEST(Hash, FileEqualsItsBytes) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "hash_test.bin";
  const std::string text(200000, 'p');
  std::FILE* stream = std::fopen(file.c_str(), "wb");
  ASSERT_NE(stream, nullptr);
  ASSERT_EQ(std::fwrite(text.data(), 1, text.size(), stream), text.size());
  std::fclose(stream);
  EXPECT_EQ(hash_file(file), hash128(text));
  std::filesystem::remove(file);
  try {
    hash_file(file);
    FAIL() << "a missing file must be an error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::io);
  }
}

}  // namespace
}  // namespace palpate
