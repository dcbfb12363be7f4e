// SPDX-License-Identifier: GPL-3.0-or-later
// Damaged files: every truncation and every flipped bit is refused; what passes a mended checksum is harmless.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>

#include "formats/io/error.hpp"
#include "palpate/contact/bonded_contact.hpp"
#include "palpate/format/checksum.hpp"
#include "palpate/format/open.hpp"
#include "palpate/response/interpolation.hpp"
#include "tests/support/response_samples.hpp"

namespace palpate {
namespace {

using runtime::OpenResult;
using runtime::View;
using Options = test::ResponseSampleOptions;

// A small file that has every section.
std::vector<std::byte> small_file(bool friction = true) {
  Options options;
  options.friction = options.softening = friction;
  options.cells = 1;
  options.tools = Options::Tools::capsule;
  options.spins = 2;
  options.search = true;
  options.bonded = options.bonded_torque = true;
  options.modes = 8;
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
  for (const bool friction : {false, true}) {
    const std::vector<std::byte> good = small_file(friction);
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
  const auto message = [&](std::uint32_t version) -> std::string {
    std::memcpy(bytes.data() + offsetof(layout::FileHeader, version), &version, sizeof version);
    mend(bytes);
    return View::open(bytes.data(), bytes.size()).error;
  };
  EXPECT_EQ(message(3), "version 3; this reader reads version 4: make it again with `palpate build SCENE`");
  EXPECT_EQ(message(1), "version 1; this reader reads version 4: make it again with `palpate build SCENE`");
  EXPECT_EQ(message(5), "version 5; this reader reads version 4: a newer Palpate wrote it");
  EXPECT_EQ(message(4), "");
}

TEST(Damage, TheOtherByteOrderIsRefusedByItsName) {
  std::vector<std::byte> bytes = small_file();
  const auto version = bytes.begin() + offsetof(layout::FileHeader, version);
  std::reverse(version, version + sizeof(layout::FileHeader::version));
  mend(bytes);
  EXPECT_STREQ(View::open(bytes.data(), bytes.size()).error,
               "wrong byte order: response files are little-endian, this file is big-endian");
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

// Evaluates a damaged but accepted file at contacts all over the body: forces stay finite.
void expect_harmless(const View& view, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  const double depth = view.meta->depth_scale;
  for (std::uint32_t tool = 0; tool < view.meta->tool_count; ++tool) {
    const layout::ToolRecord& record = view.tools[tool];
    for (int i = 0; i < 10; ++i) {
      const runtime::BodyPoint at{static_cast<std::uint32_t>(random()) % view.meta->triangle_count, {0.2, 0.3, 0.5}};
      runtime::ToolPoint on{0, {0.5, 0.25, 0.25}};
      if (record.patch_count > 0) on.patch = record.first_patch + static_cast<std::uint32_t>(random()) % record.patch_count;
      const auto pose = runtime::Pose::from_quaternion(1, 0.2 * unit(random), 0.2 * unit(random), 0, {});
      runtime::BlendedResponse<> response;
      response.blend(view, tool, at, on, {1, 0, 0}, &pose);
      const runtime::Vec3 d = depth * (runtime::Vec3{unit(random), unit(random), unit(random)} - response.normal());
      ASSERT_TRUE(finite(response.force(d)));
      const runtime::BondedResponse<true> bonded(view, tool, at, on, &pose);
      if (!(bonded.depth() > 0)) continue;
      const runtime::BondedForce wrench = bonded.at(d, {0.3 * unit(random), 0.3 * unit(random), 0});
      ASSERT_TRUE(finite(wrench.force) && finite(wrench.torque));
    }
    const runtime::Vec3 near{0.04 * unit(random), 0.04 * unit(random), 0.05 * unit(random)};
    ASSERT_TRUE(std::isfinite(closest_point(view, near).signed_distance));
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

TEST(Damage, MutationsOfAFrictionlessFileAreRefusedOrHarmless) { expect_refused_or_harmless(small_file(false)); }

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
  EXPECT_EQ(spins(0, 0), "SPINS: vertex 0: 0 spins, allowed 1 to 64 and no more than its tool has vertices");
  EXPECT_EQ(spins(1, 65), "SPINS: vertex 1: 65 spins, allowed 1 to 64 and no more than its tool has vertices");
  EXPECT_EQ(spins(1, 3), "SPINS: vertex 2: is not vertex 1 rotated about its normal");
  EXPECT_EQ(spins(2, 1), "SPINS: vertex 2: is a later spin of the vertex before, its count must be 0");
  EXPECT_EQ(spins(last - 1, 3), "SPINS: vertex " + std::to_string(last - 1) + ": 3 spins, allowed 1 to 64 and no more than its tool has vertices");
  const layout::ToolVertexRecord* vertices = view.tool_vertices;
  EXPECT_EQ(message(&vertices[2].meridian, vertices[2].meridian + 1e-6f),
            "SPINS: vertex 2: is not vertex 1 rotated about its normal");
  EXPECT_EQ(message(&vertices[2].point[1], 1e-6f), "SPINS: vertex 2: is not vertex 1 rotated about its normal");
  EXPECT_EQ(message(&view.tool_patches[1].vertex[0], 2U), "TOOL_PATCHES: patch 1 names a later spin of a vertex");
  // The section does not agree with the feature bits.
  EXPECT_EQ(message(good.data() + offsetof(layout::FileHeader, features), view.features & ~layout::feature_spin),
            "section SPINS must be absent in this file");
}

TEST(Damage, SofteningOutOfRangeIsRefused) {
  Options options;
  options.cells = 1;
  options.softening = true;
  const std::vector<std::byte> good = encode(test::box_content(options));
  const View view = View::open(good.data(), good.size()).view;
  const auto message = [&](const void* at, const auto& value) -> std::string {
    std::vector<std::byte> bytes = good;
    std::memcpy(bytes.data() + (static_cast<const std::byte*>(at) - good.data()), &value, sizeof value);
    mend(bytes);
    return View::open(bytes.data(), bytes.size()).error;
  };
  const void* const softening = &view.response_head(2) + 1;
  EXPECT_EQ(message(softening, 0.0f), "");
  EXPECT_EQ(message(softening, 0.2f), "");
  for (const float wrong : {-1e-6f, 0.2001f, std::numeric_limits<float>::quiet_NaN()}) {
    EXPECT_EQ(message(softening, wrong), "RESPONSES: response 2: slip softening out of 0 to 0.2");
  }
  EXPECT_EQ(message(&view.meta->softening_count, 2U),
            "META: softening_count 2, allowed 0 or 1 with friction, 0 without");
  EXPECT_NE(message(&view.meta->softening_count, 0U), "") << "elements of another size";
  for (const std::uint32_t& r : view.meta->reserved) EXPECT_EQ(message(&r, 1U), "META: reserved bytes are not zero");
  options.friction = false;
  EXPECT_THROW(encode(test::box_content(options)), Error);
}

// Breaks every rule of META, one at a time.
TEST(Damage, MetaOutOfRangeIsRefused) {
  const std::vector<std::byte> good = small_file();
  const View view = View::open(good.data(), good.size()).view;
  const layout::Meta& m = *view.meta;
  const auto message = [&](const void* at, const auto& value) -> std::string {
    std::vector<std::byte> bytes = good;
    std::memcpy(bytes.data() + (static_cast<const std::byte*>(at) - good.data()), &value, sizeof value);
    mend(bytes);
    return View::open(bytes.data(), bytes.size()).error;
  };
  const std::string tangential =
      "META: tangential_scale must be at least 1e-9 and below 1000 m with friction, 0 without";
  for (const double wrong : {0.0, 1e-10, 1e3, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ(message(&m.depth_scale, wrong), "META: depth_scale must be at least 1e-9 and below 1000 m");
    if (wrong != 0) {
      EXPECT_EQ(message(&m.tangential_scale, wrong), tangential);
    }
  }
  EXPECT_EQ(message(&m.tangential_scale, -1e-3), tangential);
  const auto degrees = [](const char* four, const char* rule) {
    return std::string("META: degrees ") + four + " (normal, bias, stiffness, friction): " + rule;
  };
  EXPECT_EQ(message(&m.tangential_scale, 0.0),
            degrees("5, 4, 3, 2", "stiffness_degree and friction_degree must be 0 in a frictionless file"));
  EXPECT_EQ(message(&m.normal_degree, 1U), degrees("1, 4, 3, 2", "normal_degree must be 2 to 6"));
  EXPECT_EQ(message(&m.bias_degree, 1U), degrees("5, 1, 3, 2", "bias_degree must be 0 or 2 to 6"));
  EXPECT_EQ(message(&m.stiffness_degree, 7U), degrees("5, 4, 7, 2", "stiffness_degree must be 0 or 2 to 6"));
  EXPECT_EQ(message(&m.friction_degree, 0xffffffffU),
            degrees("5, 4, 3, 4294967295", "friction_degree must be 0 to 6"));
  EXPECT_EQ(message(&m.bonded_coefs, 3U), "META: 3 coefficients of a curve of BONDED, allowed 4 to 32 or 0");
  EXPECT_EQ(message(&m.subdivision, 0U), "META: subdivision 0, allowed 1 to 255");
  EXPECT_EQ(message(&m.index_bytes, 4U), "META: indices of 4 bytes, the counts need 2");
  EXPECT_EQ(message(&m.vertex_count, 1U).find("META: 1 vertices for "), 0U);
  EXPECT_NE(message(&m.response_count, 1U).find("META: response count 1 is not "), std::string::npos);
}

// Breaks every rule of a response's coefficients, one at a time in one response.
TEST(Damage, CoefficientsThatAreNotPassiveAreRefused) {
  const std::vector<std::byte> good = small_file();
  const View view = View::open(good.data(), good.size()).view;
  const response::Degrees d = response::degrees(*view.meta);
  const response::Offsets o = response::offsets(d);
  const auto message = [&](int index, std::int16_t value) -> std::string {
    std::vector<std::byte> bytes = good;
    const auto at =
        reinterpret_cast<const std::byte*>(view.packed_coefficients(2)) + sizeof(float) + 2 * index - good.data();
    std::memcpy(bytes.data() + at, &value, sizeof value);
    mend(bytes);
    return View::open(bytes.data(), bytes.size()).error;
  };
  EXPECT_EQ(message(o.stiffness, 8000), "");
  const std::string passive =
      "RESPONSES: response 2: stiffness and coupling break the passivity inequalities -K' <= A <= K'";
  EXPECT_EQ(message(0, -1), "RESPONSES: response 2: the normal force must start at zero and not decrease");
  EXPECT_EQ(message(1, 0), "RESPONSES: response 2: the normal force must start at zero and not decrease");
  for (int k = 0; k <= d.stiffness; ++k) {
    EXPECT_EQ(message(o.stiffness + 3 * k, 0), passive) << k;
    EXPECT_EQ(message(o.stiffness + 3 * k + 1, 9000), passive) << k;
    EXPECT_EQ(message(o.stiffness + 3 * k + 2, -9000), passive) << k;
  }
  for (int k = o.coupling; k < o.friction; ++k) {
    EXPECT_EQ(message(k, 9000), passive) << k;
    EXPECT_EQ(message(k, -9000), passive) << k;
  }
  for (int k = o.friction; k < o.end; ++k) {
    EXPECT_EQ(message(k, -1), "RESPONSES: response 2: the friction coefficient is out of 0 to 10") << k;
    EXPECT_EQ(message(k, 32001), "RESPONSES: response 2: the friction coefficient is out of 0 to 10") << k;
  }
  ASSERT_NE(o.end % 2, 0);
  EXPECT_EQ(message(o.end, 1), "RESPONSES: response 2: padding is not zero");
}

TEST(Damage, BitsOutOfRangeAndPackedPaddingAreRefused) {
  Options options;
  options.cells = 1;
  options.bias = false;
  options.bits = 12;  // 22 coefficients: one byte is left over
  const std::vector<std::byte> good = encode(test::box_content(options));
  const View view = View::open(good.data(), good.size()).view;
  const response::Offsets o = response::offsets(response::degrees(*view.meta));
  const std::uint32_t packed = static_cast<std::uint32_t>(o.friction) * 12;
  const auto message = [&](const unsigned char* at, unsigned char value) -> std::string {
    std::vector<std::byte> bytes = good;
    bytes[static_cast<std::size_t>(reinterpret_cast<const std::byte*>(at) - good.data())] = std::byte{value};
    mend(bytes);
    return View::open(bytes.data(), bytes.size()).error;
  };
  const auto* const bits = reinterpret_cast<const unsigned char*>(&view.meta->coef_bits);
  for (const int wrong : {0, 1, 10, 32}) {
    EXPECT_EQ(message(bits, static_cast<unsigned char>(wrong)),
              "META: " + std::to_string(wrong) + " bits a coefficient, allowed 8, 12 or 16");
  }
  EXPECT_NE(message(bits, 8), "") << "elements of another size";
  const unsigned char* const law = view.packed_coefficients(2);
  ASSERT_NE(packed % 16, 0U);
  EXPECT_EQ(message(law + layout::friction_offset(o, 12) - 1, 0x80),
            "RESPONSES: response 2: padding is not zero");
  EXPECT_EQ(message(law + 5, 8), "RESPONSES: response 2: the normal force must start at zero and not decrease");
}

}  // namespace
}  // namespace palpate
