// SPDX-License-Identifier: GPL-3.0-or-later
// Faults on the wire, through libusb: each ends with its name, and with a zero while the wire lives; with the device's
// own watchdog where it does not.
#include "tests/device/rig.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <ostream>

namespace palpate {
namespace {

using namespace test;
using device::Fault;
using device::Phase;
using device::Sample;
using device::Vec3;

constexpr Vec3 kPush{1, 2, 1};

struct Case {
  const char* name;
  Fault fault;
  bool zero;  ///< the wire lives: a zero comes through
  std::function<void(Rig&)> inject;
};

void PrintTo(const Case& each, std::ostream* out) { *out << each.name; }

void spoil(Rig& rig, PacketFault::Kind kind) { rig.port.packets({kind}); }

const Case kCases[] = {
    {"InputStalls", Fault::stalled, true, [](Rig& rig) { rig.port.stall_input(); }},
    {"OutputStalls", Fault::stalled, true, [](Rig& rig) { rig.port.stall_output(); }},
    {"Silence", Fault::silent, true, [](Rig& rig) { rig.port.silence(); }},
    {"ShortPackets", Fault::garbled, true, [](Rig& rig) { spoil(rig, PacketFault::Kind::shorter); }},
    {"SplitPackets", Fault::garbled, true, [](Rig& rig) { spoil(rig, PacketFault::Kind::split); }},
    {"GarbledPackets", Fault::garbled, true, [](Rig& rig) { spoil(rig, PacketFault::Kind::garbled); }},
    {"LatePackets", Fault::silent, true,
     [](Rig& rig) {
       rig.port.packets({PacketFault::Kind::late, 1 << 30, 0.05});
     }},
    {"EncodersLeap", Fault::impossible, true, [](Rig& rig) { rig.port.with_model([&] { rig.model.leap(3000); }); }},
    {"TakesNoCommands", Fault::stalled, false, [](Rig& rig) { rig.port.deafen(); }},
    {"UnpluggedInMidTransfer", Fault::unplugged, false, [](Rig& rig) {
       rig.port.deafen();  // a command is under way
       pause(0.002);
       rig.port.unplug();
     }}};

class UsbFault : public testing::TestWithParam<Case> {};

TEST_P(UsbFault, EndsInAZeroAndAName) {
  // A machine with other work to do may hold a thread up for longer than a fault may last: the best of some trials
  // counts for the time, each of them for everything else.
  constexpr int kTrials = 6;
  double best = 1;
  for (int trial = 0; trial < kTrials && best > 0.010; ++trial) {
    Rig rig({}, quick_homing(false));
    ASSERT_TRUE(rig.device) << rig.opened.error;
    if (!rig.reach(Phase::ready)) continue;
    if (rig.drive(0.03, kPush).phase != Phase::ready) continue;
    const double begun = device::now();
    GetParam().inject(rig);
    const Sample sample = rig.drive(1, kPush);
    ASSERT_EQ(sample.phase, Phase::stopped);
    if (sample.fault == Fault::silent && GetParam().fault != Fault::silent) continue;  // held up for 20 ms
    EXPECT_STREQ(device::name(sample.fault), device::name(GetParam().fault));
    rig.device->close();
    EXPECT_EQ(rig.device->read().phase, Phase::closed);
    EXPECT_EQ(rig.device->read().fault, GetParam().fault);
    EXPECT_EQ(rig.device->counts().zero_left, GetParam().zero);
    const std::vector<Written> log = rig.port.log();
    ASSERT_FALSE(log.empty());
    if (GetParam().zero) {
      EXPECT_TRUE(is_zero(log.back().bytes));
      // From the last command that pushed to the zero after it.
      const auto last =
          std::find_if(log.rbegin(), log.rend(), [](const Written& each) { return !is_zero(each.bytes); });
      ASSERT_NE(last, log.rend());
      ASSERT_NE(last, log.rbegin());
      best = std::min(best, std::prev(last)->time - begun);
    } else {
      EXPECT_FALSE(is_zero(log.back().bytes));
      const double left = log.back().time;
      EXPECT_NE(rig.model.milliamps(left + 0.4), (std::array<int, 3>{}));
      EXPECT_EQ(rig.model.milliamps(left + WoodenModel::kWatchdog + 1e-6), (std::array<int, 3>{}));
      best = 0;
    }
  }
  EXPECT_LE(best, 0.010);
  RecordProperty("zero_after_us", static_cast<int>(1e6 * best));
}

INSTANTIATE_TEST_SUITE_P(Wire, UsbFault, testing::ValuesIn(kCases),
                         [](const testing::TestParamInfo<Case>& each) { return each.param.name; });

// A few bad packets among good ones are passed over.
TEST(UsbFaults, AFewBadPacketsAreNoFault) {
  Rig rig;
  ASSERT_TRUE(rig.reach(Phase::ready));
  for (const auto kind : {PacketFault::Kind::shorter, PacketFault::Kind::split, PacketFault::Kind::garbled}) {
    const std::uint32_t before = rig.drive(0.02, kPush).number;
    rig.port.packets({kind, 3});
    const Sample sample = rig.drive(0.1, kPush);
    EXPECT_EQ(sample.phase, Phase::ready);
    EXPECT_GT(sample.number, before + 5);
  }
}

// A device that takes no command for a moment gets none that is old, then the newest.
TEST(UsbFaults, ACommandThatIsStuckIsCalledBack) {
  Rig rig;
  ASSERT_TRUE(rig.reach(Phase::ready));
  rig.drive(0.03, kPush);
  rig.port.deafen();
  rig.drive(0.05, kPush);
  EXPECT_GT(rig.device->counts().blocked, 0u);
  const double heard = device::now();
  rig.drive(0.02, {0, 0, -1});  // still deaf: pushes that never leave
  rig.port.deafen(false);
  EXPECT_EQ(rig.drive(0.05, {0, 0, -1}).phase, Phase::ready);
  for (const Written& each : rig.port.log()) {
    // On the arm at home a push upwards and one to the side have currents of other signs.
    if (each.time > heard && !is_zero(each.bytes)) {
      EXPECT_LT(milliamps(each.bytes)[2], 0);
    }
  }
}

}  // namespace
}  // namespace palpate
