// SPDX-License-Identifier: GPL-3.0-or-later
// The Falcon's packets, and streams of them that are cut, noisy and behind an FTDI chip.
#include "device/falcon/falcon_codec.hpp"

#include <gtest/gtest.h>

#include <string>

#include "device/usb/ftdi.hpp"
#include "tests/device/models/usb_model.hpp"
#include "tests/device/seeded.hpp"

namespace palpate::device::falcon {
namespace {

using test::Bytes;
using test::Seeded;

Input any_input(Seeded& random) {
  Input input;
  for (auto& encoder : input.encoders) encoder = static_cast<std::int16_t>(random.below(65536));
  input.bits = static_cast<std::uint8_t>(random.below(128));
  return input;
}

bool same(const Input& a, const Input& b) { return a.encoders == b.encoders && a.bits == b.bits; }

std::vector<Input> read_all(Reader& reader, const Bytes& bytes) {
  std::vector<Input> inputs;
  for (const std::uint8_t byte : bytes) {
    if (reader.take(byte)) inputs.push_back(reader.input());
  }
  return inputs;
}

TEST(FalconCodec, PacketsAreThoseOfTheReference) {
  Output output;
  output.motors = {0x1234, -1, -4096};
  output.bits = Output::kHoming | Output::kRed;
  const auto bytes = encode(output);
  // Low nibble first, each from 'A' on: 4 3 2 1, f f f f, 0 0 0 f.
  EXPECT_EQ(std::string(bytes.begin(), bytes.end()), "<EDCBPPPPAAAPJA>");
  EXPECT_EQ(Input::kHomed, 0x70);
}

TEST(FalconCodec, WhatIsWrittenIsRead) {
  Seeded random(1);
  Reader reader;
  for (int i = 0; i < 2000; ++i) {
    const Input input = any_input(random);
    const auto bytes = encode(input);
    for (std::size_t k = 0; k < kPacket; ++k) ASSERT_EQ(reader.take(bytes[k]), k == kPacket - 1);
    ASSERT_TRUE(same(reader.input(), input));
  }
  EXPECT_EQ(reader.drain_noise(), 0U);
}

TEST(FalconCodec, AStreamCutAnywhereIsReadFromTheNextPacketOn) {
  Seeded random(2);
  for (std::size_t cut = 0; cut < 2 * kPacket; ++cut) {
    Bytes stream;
    std::vector<Input> sent;
    for (int i = 0; i < 6; ++i) {
      sent.push_back(any_input(random));
      const auto bytes = encode(sent.back());
      stream.insert(stream.end(), bytes.begin(), bytes.end());
    }
    stream.erase(stream.begin(), stream.begin() + static_cast<std::ptrdiff_t>(cut));
    Reader reader;
    const auto inputs = read_all(reader, stream);
    const std::size_t lost = (cut + kPacket - 1) / kPacket;
    ASSERT_EQ(inputs.size(), sent.size() - lost) << cut;
    for (std::size_t i = 0; i < inputs.size(); ++i) EXPECT_TRUE(same(inputs[i], sent[lost + i]));
    EXPECT_EQ(reader.drain_noise(), lost * kPacket - cut);
  }
}

// Every packet between two damages is found, nothing is made up, and every other byte is counted as noise.
TEST(FalconCodec, NoiseBetweenPacketsCostsNoPacket) {
  Seeded random(3);
  for (int round = 0; round < 500; ++round) {
    Bytes stream;
    std::vector<Input> sent;
    std::size_t noise = 0;
    for (int i = 0; i < 20; ++i) {
      for (std::uint64_t k = random.below(4) == 0 ? random.below(40) : 0; k > 0; --k) {
        const std::uint8_t byte = random.byte();
        if (byte == '<') continue;  // would begin a packet, and take the next one's first bytes where it fits
        stream.push_back(byte);
        ++noise;
      }
      const Input input = any_input(random);
      auto bytes = encode(input);
      if (random.below(5) == 0) {
        bytes[1 + random.below(15)] = 0x20;
        noise += kPacket;
      } else {
        sent.push_back(input);
      }
      stream.insert(stream.end(), bytes.begin(), bytes.end());
    }
    Reader reader;
    const auto inputs = read_all(reader, stream);
    ASSERT_EQ(inputs.size(), sent.size());
    for (std::size_t i = 0; i < inputs.size(); ++i) ASSERT_TRUE(same(inputs[i], sent[i]));
    ASSERT_EQ(reader.drain_noise(), noise);
  }
}

TEST(FalconCodec, AnyBytesAreAtMostPacketsAndNoise) {
  Seeded random(4);
  const char letters[] = "<AABPP>AAAAAAAAA";
  Reader reader;
  std::size_t fed = 0, packets = 0;
  for (; fed < 2000000; ++fed) {
    const auto byte = static_cast<std::uint8_t>(random.below(8) == 0 ? random.byte() : letters[random.below(16)]);
    if (!reader.take(byte)) continue;
    ++packets;
    // A packet that was read can be written, and reads the same.
    Reader other;
    for (const std::uint8_t again : encode(reader.input())) other.take(again);
    ASSERT_TRUE(same(other.input(), reader.input()));
  }
  const std::size_t noise = reader.drain_noise();
  EXPECT_LE(fed - kPacket, kPacket * packets + noise);
  EXPECT_LE(kPacket * packets + noise, fed);
}

TEST(Ftdi, StatusIsAtTheHeadOfEveryPacketOfATransfer) {
  Seeded random(5);
  for (std::size_t size = 0; size < 300; ++size) {
    Bytes transfer, payload, seen;
    for (std::size_t i = 0; i < size; ++i) {
      const bool status = i % 64 < 2;
      transfer.push_back(status ? '<' : random.byte());
      if (!status) payload.push_back(transfer.back());
    }
    ftdi::for_payload(transfer.data(), size, 64, [&](const std::uint8_t* bytes, std::size_t count) {
      ASSERT_GT(count, 0U);
      seen.insert(seen.end(), bytes, bytes + count);
    });
    ASSERT_EQ(seen, payload);
  }
}

}  // namespace
}  // namespace palpate::device::falcon
