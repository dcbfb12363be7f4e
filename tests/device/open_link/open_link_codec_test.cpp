// SPDX-License-Identifier: GPL-3.0-or-later
// The open link's frames: those that open_link.md prints, round trips, streams with noise.
#include "device/open_link/open_link_codec.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>
#include <string>

#include "tests/device/models/usb_model.hpp"
#include "tests/device/seeded.hpp"

namespace palpate::device::openlink {
namespace {

using test::Bytes;
using test::Seeded;

Bytes bytes_of(const Frame& frame) { return {frame.bytes, frame.bytes + frame.size()}; }

// The frames that the specification prints: lines that begin with four blanks and A7.
std::vector<Bytes> printed() {
  std::ifstream page(PALPATE_OPEN_LINK);
  std::vector<Bytes> frames;
  for (std::string line; std::getline(page, line);) {
    if (line.rfind("    A7 ", 0) != 0) continue;
    std::istringstream words(line);
    frames.emplace_back();
    for (unsigned byte = 0; words >> std::hex >> byte;) frames.back().push_back(static_cast<std::uint8_t>(byte));
  }
  return frames;
}

std::vector<Frame> read_all(Reader& reader, const Bytes& bytes) {
  std::vector<Frame> frames;
  for (const std::uint8_t byte : bytes) {
    reader.put(byte);
    for (Frame frame; reader.get(frame);) frames.push_back(frame);
  }
  return frames;
}

Drive any_drive(Seeded& random) {
  Drive drive;
  drive.on = random.below(2) == 1;
  for (float& value : drive.force) value = static_cast<float>(random.between(-9, 9));
  for (float& value : drive.torque) value = static_cast<float>(random.between(-1, 1));
  return drive;
}

State any_state(Seeded& random) {
  State state;
  state.clock = static_cast<std::uint32_t>(random.below(1ULL << 32));
  state.flags = random.byte();
  state.fault = random.byte();
  state.heard = random.byte();
  state.buttons = static_cast<std::uint32_t>(random.below(1ULL << 32));
  for (float& value : state.position) value = static_cast<float>(random.between(-1, 1));
  for (float& value : state.orientation) value = static_cast<float>(random.between(-1, 1));
  return state;
}

Capabilities good() {
  Capabilities c;
  c.peak_force = 5;
  c.continuous_force = 2;
  c.radius = 0.1F;
  c.rate = 1000;
  c.watchdog = 0.02F;
  return c;
}

TEST(OpenLinkCodec, CheckIsTheOneOfTheSpecification) {
  const char digits[] = "123456789";
  EXPECT_EQ(crc(reinterpret_cast<const std::uint8_t*>(digits), 9), 0x29b1);
}

TEST(OpenLinkCodec, FramesAreThoseOfTheSpecification) {
  const auto frames = printed();
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(bytes_of(encode(0, Hello{})), frames[0]);
  EXPECT_EQ(bytes_of(encode(1, Drive{})), frames[1]);
  Drive up;
  up.on = true;
  up.force[2] = 1.5F;
  EXPECT_EQ(bytes_of(encode(2, up)), frames[2]);
}

TEST(OpenLinkCodec, FieldsAreWhereTheSpecificationPutsThem) {
  Capabilities c = good();
  c.buttons = 3;
  c.peak_torque = 0.25F;
  c.stiffness = 1024;
  std::strcpy(c.name, "any handle at al");
  const Frame frame = encode(9, c);
  const std::uint8_t* p = frame.payload();
  ASSERT_EQ(frame.payload_size(), 50U);
  EXPECT_EQ(Bytes(p, p + 10), (Bytes{1, 0, 7, 7, 3, 0, 0x00, 0x00, 0xa0, 0x40}));  // 5.0 is 40A00000
  EXPECT_EQ(Bytes(p + 14, p + 22), (Bytes{0x00, 0x00, 0x80, 0x3e, 0x00, 0x00, 0x80, 0x44}));
  EXPECT_EQ(std::string(p + 34, p + 50), "any handle at al");
  State s;
  s.clock = 0x01020304;
  s.flags = State::kHomed | State::kTripped;
  s.fault = 6;
  s.heard = 7;
  s.buttons = 0x80000001;
  s.position[2] = 1;
  s.orientation[3] = -1;
  const Frame state = encode(10, s);
  p = state.payload();
  ASSERT_EQ(state.payload_size(), 40U);
  EXPECT_EQ(Bytes(p, p + 12), (Bytes{4, 3, 2, 1, 5, 6, 7, 0, 1, 0, 0, 0x80}));
  EXPECT_EQ(Bytes(p + 20, p + 28), (Bytes{0, 0, 0x80, 0x3f, 0, 0, 0x80, 0x3f}));
  EXPECT_EQ(Bytes(p + 36, p + 40), (Bytes{0, 0, 0x80, 0xbf}));
}

TEST(OpenLinkCodec, WhatIsWrittenIsRead) {
  Seeded random(1);
  for (int i = 0; i < 1000; ++i) {
    const Drive drive = any_drive(random);
    Drive drive_read;
    ASSERT_TRUE(decode(encode(random.byte(), drive), drive_read));
    EXPECT_EQ(drive_read.on, drive.on);
    EXPECT_TRUE(std::equal(drive.force, drive.force + 3, drive_read.force));
    EXPECT_TRUE(std::equal(drive.torque, drive.torque + 3, drive_read.torque));
    const State state = any_state(random);
    State state_read;
    const Frame frame = encode(random.byte(), state);
    ASSERT_TRUE(decode(frame, state_read));
    EXPECT_EQ(bytes_of(encode(frame.sequence(), state_read)), bytes_of(frame));
    EXPECT_FALSE(decode(frame, drive_read));
  }
}

TEST(OpenLinkCodec, LongerFramesAreReadAndShorterOnesAreNot) {
  for (std::size_t size = 0; size <= kMostPayload; ++size) {
    Frame frame = encode(0, State{});
    frame.bytes[2] = static_cast<std::uint8_t>(size);
    State state;
    EXPECT_EQ(decode(frame, state), size >= 40) << size;
    frame = encode(0, Drive{});
    frame.bytes[2] = static_cast<std::uint8_t>(size);
    Drive drive;
    EXPECT_EQ(decode(frame, drive), size >= 25) << size;
  }
}

TEST(OpenLinkCodec, NewerIsAheadByLessThanHalfTheCircle) {
  for (int a = 0; a < 256; ++a) {
    for (int b = 0; b < 256; ++b) {
      const int ahead = (a - b + 256) % 256;
      EXPECT_EQ(newer(static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(b)), ahead >= 1 && ahead <= 127);
    }
  }
}

// Cut anywhere, with noise (sync bytes among it) between: every frame that arrived whole is found, nothing else is.
TEST(OpenLinkCodec, NoiseCostsNoFrame) {
  Seeded random(2);
  for (int round = 0; round < 300; ++round) {
    Bytes stream;
    std::vector<Bytes> sent;
    std::size_t noise = 0;
    for (int i = 0; i < 20; ++i) {
      for (std::uint64_t k = random.below(3) == 0 ? random.below(100) : 0; k > 0; --k, ++noise) {
        stream.push_back(random.below(5) == 0 ? kSync : random.byte());
      }
      Bytes frame = bytes_of(random.below(2) == 0 ? encode(random.byte(), any_drive(random))
                                                  : encode(random.byte(), any_state(random)));
      const std::uint64_t harm = random.below(6);
      if (harm == 0) {
        frame[random.below(frame.size())] ^= static_cast<std::uint8_t>(1 + random.below(255));
        noise += frame.size();
      } else if (harm == 1) {
        // Not its ends, which the noise beside it might well replace.
        frame.erase(frame.begin() + 1 + static_cast<std::ptrdiff_t>(random.below(frame.size() - 2)));
        noise += frame.size();
      } else {
        sent.push_back(frame);
      }
      stream.insert(stream.end(), frame.begin(), frame.end());
    }
    // Enough behind it for whatever noise at the end announces.
    stream.insert(stream.end(), kMostFrame, 0);
    Reader reader;
    const auto frames = read_all(reader, stream);
    ASSERT_EQ(frames.size(), sent.size()) << round;
    for (std::size_t i = 0; i < frames.size(); ++i) ASSERT_EQ(bytes_of(frames[i]), sent[i]);
    ASSERT_EQ(reader.drain_noise(), noise + kMostFrame);
  }
}

TEST(OpenLinkCodec, AnyBytesAreFramesAndNoise) {
  Seeded random(3);
  Reader reader;
  const std::size_t fed = 500000;
  std::size_t framed = 0;
  for (std::size_t i = 0; i < fed; ++i) {
    const std::uint64_t what = random.below(8);
    reader.put(what == 0 ? kSync : what == 1 ? static_cast<std::uint8_t>(random.below(70)) : random.byte());
    for (Frame frame; reader.get(frame);) {
      framed += frame.size();
      EXPECT_LE(frame.size(), kMostFrame);
    }
  }
  const std::size_t noise = reader.drain_noise();
  EXPECT_LE(framed + noise, fed);
  EXPECT_GE(framed + noise + kMostFrame, fed);
}

TEST(OpenLinkCapabilities, WhatIsOutOfBoundsIsNamed) {
  EXPECT_EQ(wrong(good()), nullptr);
  const float nan = std::nanf(""), infinite = std::numeric_limits<float>::infinity();
  const std::pair<const char*, std::function<void(Capabilities&)>> cases[] = {
      {"position", [](Capabilities& c) { c.measures = 0x3b; }},
      {"buttons", [](Capabilities& c) { c.buttons = 33; }},
      {"peak force", [](Capabilities& c) { c.peak_force = 0; }},
      {"peak force", [](Capabilities& c) { c.peak_force = 1001; }},
      {"peak force", [=](Capabilities& c) { c.peak_force = nan; }},
      {"continuous", [](Capabilities& c) { c.continuous_force = 6; }},
      {"continuous", [](Capabilities& c) { c.continuous_force = -1; }},
      {"torque", [](Capabilities& c) { c.drives = 0x0f; }},
      {"torque", [](Capabilities& c) { c.peak_torque = 101; }},
      {"stiffness", [=](Capabilities& c) { c.stiffness = infinite; }},
      {"stiffness", [](Capabilities& c) { c.stiffness = -1; }},
      {"radius", [](Capabilities& c) { c.radius = 0; }},
      {"radius", [](Capabilities& c) { c.radius = 11; }},
      {"rate", [](Capabilities& c) { c.rate = 499; }},
      {"rate", [=](Capabilities& c) { c.rate = nan; }},
      {"watchdog", [](Capabilities& c) { c.watchdog = 0; }},
      {"watchdog", [](Capabilities& c) { c.watchdog = 0.2F; }},
  };
  for (const auto& [word, spoil] : cases) {
    Capabilities c = good();
    spoil(c);
    const char* cause = wrong(c);
    ASSERT_NE(cause, nullptr) << word;
    EXPECT_NE(std::string(cause).find(word), std::string::npos) << cause;
  }
}

}  // namespace
}  // namespace palpate::device::openlink
