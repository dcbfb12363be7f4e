// SPDX-License-Identifier: GPL-3.0-or-later
// Damaged files: every truncation and every flipped bit is refused; what passes a mended checksum is harmless.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>

#include "palpate/runtime.hpp"
#include "tests/support/response_samples.hpp"

namespace palpate {
namespace {

using runtime::OpenResult;
using runtime::View;
using Options = test::ResponseSampleOptions;

// A small file that has every section.
std::vector<std::byte> small_file(int coupled = 0) {
  Options options;
  options.coupled = coupled;
  options.cells = 1;
  options.tools = Options::Tools::capsule;
  options.spins = 2;
  options.search = true;
  options.grasp = options.turn = true;
  return encode(test::box_content(options));
}

void mend(std::vector<std::byte>& bytes) {
  constexpr std::size_t kField = offsetof(layout::FileHeader, checksum);
  const std::uint64_t sum =
      checksum::of_file(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(), kField);
  std::memcpy(bytes.data() + kField, &sum, sizeof sum);
}

TEST(Checksum, MeetsThePublishedVectors) {
  const auto of = [](const std::string& text) { return checksum::of(text.data(), text.size()); };
  EXPECT_EQ(of(""), 0xEF46DB3751D8E999u);
  EXPECT_EQ(of("a"), 0xD24EC4F1A98C6E5Bu);
  EXPECT_EQ(of("abc"), 0x44BC2CF5AD770999u);
}

TEST(Checksum, IsTheSameHoweverTheBytesArrive) {
  std::string text;
  for (int i = 0; i < 200; ++i) text += static_cast<char>(i * 37);
  for (std::size_t size = 0; size < text.size(); ++size) {
    checksum::Xxh64 whole, pieces;
    whole.update(text.data(), size);
    for (std::size_t at = 0; at < size; at += 7) pieces.update(text.data() + at, std::min<std::size_t>(7, size - at));
    ASSERT_EQ(whole.digest(), pieces.digest()) << size;
  }
}

TEST(Damage, EveryTruncationIsRefused) {
  for (const int coupled : {0, 4}) {
    const std::vector<std::byte> good = small_file(coupled);
    ASSERT_TRUE(View::open(good.data(), good.size()));
    for (std::size_t size = 0; size < good.size(); ++size) {
      const OpenResult result = View::open(good.data(), size);
      ASSERT_FALSE(result) << size;
      ASSERT_NE(std::string(result.error).find("truncated"), std::string::npos) << result.error;
    }
  }
}

TEST(Damage, EveryTruncationWithAMendedHeaderIsRefused) {
  const std::vector<std::byte> good = small_file();
  for (std::uint64_t size = sizeof(layout::FileHeader); size < good.size(); ++size) {
    std::vector<std::byte> cut(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size));
    std::memcpy(cut.data() + offsetof(layout::FileHeader, file_size), &size, sizeof size);
    mend(cut);
    ASSERT_FALSE(View::open(cut.data(), cut.size())) << size;
  }
}

TEST(Damage, ASizeThatIsNoMultipleOf64IsRefused) {
  std::vector<std::byte> bytes = small_file();
  bytes.resize(bytes.size() + 8);
  const std::uint64_t size = bytes.size();
  std::memcpy(bytes.data() + offsetof(layout::FileHeader, file_size), &size, sizeof size);
  mend(bytes);
  const OpenResult result = View::open(bytes.data(), bytes.size());
  ASSERT_FALSE(result);
  EXPECT_NE(std::string(result.error).find("multiple of 64"), std::string::npos) << result.error;
}

// A trusted opening gives the same view; what it looks at is still checked, what it trusts is not.
TEST(Damage, ATrustedOpeningReadsNoRecord) {
  std::vector<std::byte> bytes = small_file();
  const OpenResult checked = View::open(bytes.data(), bytes.size());
  const OpenResult trusted = View::open_trusted(bytes.data(), bytes.size());
  ASSERT_TRUE(trusted) << trusted.error;
  EXPECT_EQ(std::memcmp(&checked.view, &trusted.view, sizeof(View)), 0);
  EXPECT_FALSE(View::open_trusted(bytes.data(), bytes.size() - 64));
  bytes[bytes.size() - 1] ^= std::byte{1};
  EXPECT_FALSE(View::open(bytes.data(), bytes.size()));
  EXPECT_TRUE(View::open_trusted(bytes.data(), bytes.size()));
  bytes[offsetof(layout::FileHeader, features)] ^= std::byte{1};
  EXPECT_FALSE(View::open_trusted(bytes.data(), bytes.size()));
}

TEST(Damage, AnotherVersionIsRefusedByItsNumber) {
  std::vector<std::byte> bytes = small_file();
  const std::uint32_t before = 1;
  std::memcpy(bytes.data() + offsetof(layout::FileHeader, version), &before, sizeof before);
  mend(bytes);
  EXPECT_STREQ(View::open(bytes.data(), bytes.size()).error,
               "version 1, this reader knows 2: fit its scene again (palpate fit)");
}

TEST(Damage, TheOtherByteOrderIsRefusedByItsName) {
  std::vector<std::byte> bytes = small_file();
  const auto version = bytes.begin() + offsetof(layout::FileHeader, version);
  std::reverse(version, version + sizeof(layout::FileHeader::version));
  mend(bytes);
  EXPECT_STREQ(View::open(bytes.data(), bytes.size()).error,
               "of the other byte order: response files and those who read them are little-endian");
}

TEST(Damage, TrailingBytesAreRefused) {
  std::vector<std::byte> bytes = small_file();
  bytes.resize(bytes.size() + 8);
  const OpenResult result = View::open(bytes.data(), bytes.size());
  ASSERT_FALSE(result);
  EXPECT_NE(std::string(result.error).find("trailing"), std::string::npos) << result.error;
}

TEST(Damage, EveryFlippedBitIsRefused) {
  std::vector<std::byte> bytes = small_file();
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (int bit = 0; bit < 8; ++bit) {
      bytes[at] ^= static_cast<std::byte>(1 << bit);
      ASSERT_FALSE(View::open(bytes.data(), bytes.size())) << "byte " << at << " bit " << bit;
      bytes[at] ^= static_cast<std::byte>(1 << bit);
    }
  }
}

TEST(Damage, GarbageAndNothingAreRefused) {
  EXPECT_FALSE(View::open(nullptr, 0));
  std::vector<std::byte> bytes(4096, std::byte{0x5a});
  EXPECT_FALSE(View::open(bytes.data(), bytes.size()));
  EXPECT_FALSE(View::open(bytes.data() + 1, 100));
  for (const char* text : {"", "{}", "PALPATE", "solid stl"}) EXPECT_FALSE(View::open(text, std::strlen(text)));
}

// Ticks a damaged but accepted file over and into the body: forces stay numbers.
void expect_harmless(const View& view, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  for (std::uint32_t tool = 0; tool < view.meta->tool_count; ++tool) {
    runtime::Contact contact(view, tool);
    const runtime::Vec3 from{0.04 * unit(random), 0.04 * unit(random), 0.05};
    const runtime::Vec3 to{0.04 * unit(random), 0.04 * unit(random), -0.01};
    for (int i = 0; i <= 40; ++i) {
      const auto pose =
          runtime::Pose::from_quaternion(1, 0.2 * unit(random), 0.2 * unit(random), 0, from + (i / 40.0) * (to - from));
      const runtime::Tick tick = contact.tick(pose);
      ASSERT_TRUE(std::isfinite(length(tick.force)) && std::isfinite(length(tick.torque)));
    }
  }
}

void expect_refused_or_harmless(const std::vector<std::byte>& good) {
  std::mt19937 random(20240601);
  int accepted = 0, refused = 0;
  for (int round = 0; round < 20000; ++round) {
    std::vector<std::byte> bytes = good;
    const int changes = 1 + static_cast<int>(random() % 3);
    for (int i = 0; i < changes; ++i) {
      const std::size_t at = random() % bytes.size();
      switch (random() % 4) {
        case 0:
          bytes[at] ^= static_cast<std::byte>(1 << (random() % 8));
          break;
        case 1:
          bytes[at] = static_cast<std::byte>(random());
          break;
        case 2: {  // a whole word: 0, all ones, NaN, infinity
          const std::uint32_t words[] = {0, 0xffffffffu, 0x7fc00000u, 0x7f800000u, 1, 0x80000000u};
          std::memcpy(bytes.data() + at / 4 * 4, &words[random() % 6], 4);
          break;
        }
        default:  // a word from elsewhere
          std::memcpy(bytes.data() + at / 4 * 4, good.data() + random() % good.size() / 4 * 4, 4);
      }
    }
    mend(bytes);
    const OpenResult result = View::open(bytes.data(), bytes.size());
    if (!result) {
      ++refused;
      ASSERT_NE(result.error[0], 0);
      continue;
    }
    ++accepted;
    expect_harmless(result.view, random);
  }
  EXPECT_GT(accepted, 100);  // padding, positions, coefficients that stay in range
  EXPECT_GT(refused, 100);
}

TEST(Damage, MutationsWithAMendedChecksumAreRefusedOrHarmless) { expect_refused_or_harmless(small_file()); }

TEST(Damage, MutationsOfACoupledFileAreRefusedOrHarmless) { expect_refused_or_harmless(small_file(4)); }

// Every rule of SPINS, broken one at a time.
TEST(Damage, SpinsThatAreNoneAreRefused) {
  const std::vector<std::byte> good = small_file();
  const View view = View::open(good.data(), good.size()).view;
  ASSERT_NE(view.spins, nullptr);
  ASSERT_EQ(view.spins[0], 1U);
  ASSERT_EQ(view.spins[1], 2U);
  const auto message = [&](const void* at, const auto& value) -> std::string {
    std::vector<std::byte> bytes = good;
    std::memcpy(bytes.data() + (static_cast<const std::byte*>(at) - good.data()), &value, sizeof value);
    mend(bytes);
    return View::open(bytes.data(), bytes.size()).error;
  };
  const auto spins = [&](std::uint32_t vertex, std::uint32_t value) { return message(view.spins + vertex, value); };
  const std::uint32_t last = view.meta->tool_vertex_count - 1;
  EXPECT_EQ(spins(0, 1), "");
  EXPECT_EQ(spins(0, 0), "SPINS: vertex 0: 0 spins, allowed 1 to 64 of its tool");
  EXPECT_EQ(spins(1, 65), "SPINS: vertex 1: 65 spins, allowed 1 to 64 of its tool");
  EXPECT_EQ(spins(1, 3), "SPINS: vertex 2: is not vertex 1 turned about its normal");
  EXPECT_EQ(spins(2, 1), "SPINS: vertex 2: belongs to the one before");
  EXPECT_EQ(spins(last - 1, 3), "SPINS: vertex " + std::to_string(last - 1) + ": 3 spins, allowed 1 to 64 of its tool");
  const layout::ToolVertexRecord* vertices = view.tool_vertices;
  EXPECT_EQ(message(&vertices[2].meridian, vertices[2].meridian + 1e-6f),
            "SPINS: vertex 2: is not vertex 1 turned about its normal");
  EXPECT_EQ(message(&vertices[2].point[1], 1e-6f), "SPINS: vertex 2: is not vertex 1 turned about its normal");
  EXPECT_EQ(message(&view.tool_patches[1].vertex[0], 2U), "TOOL_PATCHES: patch 1 names a later spin");
  // Without the section the bits do not fit; without tool vertices there is nothing to turn.
  EXPECT_EQ(message(good.data() + offsetof(layout::FileHeader, features), view.features & ~layout::feature_spin),
            "section SPINS must be absent in this file");
}

TEST(Damage, ReliefsOutOfRangeAreRefused) {
  Options options;
  options.cells = 1;
  options.relief = true;
  const std::vector<std::byte> good = encode(test::box_content(options));
  const View view = View::open(good.data(), good.size()).view;
  const auto message = [&](const void* at, const auto& value) -> std::string {
    std::vector<std::byte> bytes = good;
    std::memcpy(bytes.data() + (static_cast<const std::byte*>(at) - good.data()), &value, sizeof value);
    mend(bytes);
    return View::open(bytes.data(), bytes.size()).error;
  };
  const void* const relief = &view.response_head(2) + 1;
  EXPECT_EQ(message(relief, 0.0f), "");
  EXPECT_EQ(message(relief, 0.2f), "");
  for (const float wrong : {-1e-6f, 0.2001f, std::numeric_limits<float>::quiet_NaN()}) {
    EXPECT_EQ(message(relief, wrong), "RESPONSES: response 2: relief out of 0 to 0.2");
  }
  EXPECT_EQ(message(&view.meta->relief_count, 2U),
            "META: 2 reliefs a response, allowed 1 in a file with friction, else 0");
  EXPECT_NE(message(&view.meta->relief_count, 0U), "") << "elements of another size";
  EXPECT_EQ(message(&view.meta->reserved, 1U), "META: reserved bytes are not zero");
  options.friction = false;
  EXPECT_THROW(encode(test::box_content(options)), Error);
}

// Every rule of a coupled response, broken one at a time in one response.
TEST(Damage, CoefficientsThatAreNotPassiveAreRefused) {
  const std::vector<std::byte> good = small_file(4);
  const View view = View::open(good.data(), good.size()).view;
  const coupled::Degrees d = layout::coupled_degrees(*view.meta);
  const coupled::Places p = coupled::places(d);
  const auto message = [&](int index, std::int16_t value) -> std::string {
    std::vector<std::byte> bytes = good;
    const auto at = reinterpret_cast<const std::byte*>(view.coupled_law(2)) + sizeof(float) + 2 * index - good.data();
    std::memcpy(bytes.data() + at, &value, sizeof value);
    mend(bytes);
    return View::open(bytes.data(), bytes.size()).error;
  };
  EXPECT_EQ(message(p.stiffness, 8000), "");
  const std::string passive =
      "RESPONSES: response 2: stiffness and coupling break the inequalities that make it passive";
  EXPECT_EQ(message(0, -1), "RESPONSES: response 2: the normal force must start at zero and not decrease");
  EXPECT_EQ(message(1, 0), "RESPONSES: response 2: the normal force must start at zero and not decrease");
  for (int k = 0; k <= d.stiffness; ++k) {
    EXPECT_EQ(message(p.stiffness + 3 * k, 0), passive) << k;
    EXPECT_EQ(message(p.stiffness + 3 * k + 1, 9000), passive) << k;
    EXPECT_EQ(message(p.stiffness + 3 * k + 2, -9000), passive) << k;
  }
  for (int k = p.coupling; k < p.cubic; ++k) {
    EXPECT_EQ(message(k, 9000), passive) << k;
    EXPECT_EQ(message(k, -9000), passive) << k;
  }
  for (int k = p.cubic; k < p.limit; ++k) EXPECT_EQ(message(k, 2000), passive) << k;
  for (int k = p.limit; k < p.end; ++k) {
    EXPECT_EQ(message(k, -1), "RESPONSES: response 2: the friction limit is out of 0 to 10") << k;
    EXPECT_EQ(message(k, 32001), "RESPONSES: response 2: the friction limit is out of 0 to 10") << k;
  }
  if (p.end % 2 != 0) {
    EXPECT_EQ(message(p.end, 1), "RESPONSES: response 2: padding is not zero");
  }
}

TEST(Damage, BitsOutOfRangeAndPackedPaddingAreRefused) {
  Options options;
  options.cells = 1;
  options.lateral = false;
  options.coupled = 2;
  options.bits = 12;  // 22 of them: a byte is left over
  const std::vector<std::byte> good = encode(test::box_content(options));
  const View view = View::open(good.data(), good.size()).view;
  const coupled::Degrees d = layout::coupled_degrees(*view.meta);
  const std::uint32_t packed = static_cast<std::uint32_t>(coupled::places(d).limit) * 12;
  const auto message = [&](const unsigned char* at, unsigned char value) -> std::string {
    std::vector<std::byte> bytes = good;
    bytes[static_cast<std::size_t>(reinterpret_cast<const std::byte*>(at) - good.data())] = std::byte{value};
    mend(bytes);
    return View::open(bytes.data(), bytes.size()).error;
  };
  const auto* const bits = reinterpret_cast<const unsigned char*>(&view.meta->coef_bits);
  for (const int wrong : {0, 1, 10, 32}) {
    EXPECT_EQ(message(bits, static_cast<unsigned char>(wrong)),
              "META: " + std::to_string(wrong) + " bits a coefficient, allowed 8, 12 or 16 in a coupled file, else 0");
  }
  EXPECT_NE(message(bits, 8), "") << "elements of another size";
  const unsigned char* const law = view.coupled_law(2);
  ASSERT_NE(packed % 16, 0U);
  EXPECT_EQ(message(law + layout::coupled_limit_offset(coupled::places(d), 12) - 1, 0x80),
            "RESPONSES: response 2: padding is not zero");
  EXPECT_EQ(message(law + 5, 8), "RESPONSES: response 2: the normal force must start at zero and not decrease");
}

}  // namespace
}  // namespace palpate
