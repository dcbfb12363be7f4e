// SPDX-License-Identifier: GPL-3.0-or-later
// Every fault with every driver, through libusb, at either front end: each ends with its name, and with a zero while
// the wire lives; with the device's own watchdog where it does not.
#include "tests/device/usb/station.hpp"

#include <ostream>
#include <utility>

namespace palpate::usb_fault_test {
namespace {

using namespace test;
using device::Fault;
using device::Phase;
using device::Sample;
using device::Vec3;

constexpr Vec3 kPush{1, 2, 1};
constexpr int kAll = 1 << 30;  // packets

/// A driver's reaction to a fault.
struct Ending {
  Ending(Fault named) : fault(named) {}
  Ending(const char* reason) : why(reason) {}
  Fault fault = Fault::none;  ///< none: it goes on
  const char* why = nullptr;  ///< it cannot happen to this device: why not
};

struct Row {
  const char* name;
  bool zero;  ///< the wire lives: a zero comes through
  void (*inject)(Station&);
  Ending endings[std::size(kDrivers)];  ///< of wooden, falcon, open-link
};

void spoil(Station& at, PacketFault::Kind kind, double delay = 0) { at.port.packets({kind, kAll, delay}); }

void in_device(Station& at, void (Emulated::*what)()) {
  at.port.with_model([&] { ((*at.subject).*what)(); });
}

const Row kFaults[] = {
    {"InputStalls", true, [](Station& at) { at.port.stall_input(); }, {Fault::stalled, Fault::stalled, Fault::stalled}},
    {"OutputStalls",
     true,
     [](Station& at) { at.port.stall_output(); },
     {Fault::stalled, Fault::stalled, Fault::stalled}},
    {"ShortPackets",
     true,
     [](Station& at) { spoil(at, PacketFault::Kind::shorter); },
     {Fault::garbled, Fault::garbled, Fault::garbled}},
    {"SplitPackets",
     true,
     [](Station& at) { spoil(at, PacketFault::Kind::split); },
     {Fault::garbled, Fault::garbled, Fault::none}},  // frames on the open link may be cut anywhere
    {"GarbledPackets",
     true,
     [](Station& at) { spoil(at, PacketFault::Kind::garbled); },
     {Fault::garbled, Fault::garbled, Fault::garbled}},
    {"LatePackets",
     true,
     [](Station& at) { spoil(at, PacketFault::Kind::late, 0.3); },
     {Fault::silent, Fault::silent, Fault::silent}},
    {"Silence", true, [](Station& at) { at.port.silence(); }, {Fault::silent, Fault::silent, Fault::silent}},
    {"NothingNewIsSaid",
     true,
     [](Station& at) { in_device(at, &Emulated::mute); },
     {Fault::silent, Fault::silent, Fault::silent}},
    {"WrappedEncoder",
     true,
     [](Station& at) { in_device(at, &Emulated::wrap_encoder); },
     {Fault::impossible, Fault::impossible, Fault::impossible}},
    {"OriginLost",
     true,
     [](Station& at) { in_device(at, &Emulated::lose_origin); },
     {"its reports say nothing about an origin", Fault::reported, Fault::reported}},
    {"TooHot",
     true,
     [](Station& at) { in_device(at, &Emulated::overheat); },
     {"its reports say nothing about its motors", "its packets say nothing about its motors", Fault::reported}},
    {"TakesNoCommands", false, [](Station& at) { at.port.deafen(); }, {Fault::stalled, Fault::stalled, Fault::stalled}},
    {"UnpluggedInMidTransfer",
     false,
     [](Station& at) {
       at.port.unplug_in_transfer();
       at.drive(1, kPush, [&] { return at.port.gone(); });
       at.front->unplug();
     },
     {Fault::unplugged, Fault::unplugged, Fault::unplugged}},
};

struct Case {
  const char* driver;
  const Row* row;
  Ending ending;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const Row& row : kFaults) {
    for (std::size_t k = 0; k < std::size(kDrivers); ++k) {
      if (row.endings[k].why == nullptr) all.push_back({kDrivers[k], &row, row.endings[k]});
    }
  }
  return all;
}

void PrintTo(const Case& each, std::ostream* out) { *out << each.driver << " " << each.row->name; }

class UsbFault : public testing::TestWithParam<Case> {
protected:
  void SetUp() override {
    if (!make_front()) GTEST_SKIP() << "runs under umockdev-wrapper only";
  }

  // Ready, and its motors have a force.
  static bool pushes(Station& at) {
    at.plug(true);
    if (!at.open(false)) {
      ADD_FAILURE() << at.opened.error;
      return false;
    }
    at.reach(Phase::ready);
    const Sample sample = at.push(kPush);
    if (!at.held_up(sample)) {
      EXPECT_EQ(sample.phase, Phase::ready) << device::name(sample.fault);
    }
    return sample.phase == Phase::ready && at.holds_a_force(device::now());
  }

  // The last force went away by the driver's zero: s from the fault to that, or an hour where there was none.
  static double zeroed(Station& at, double begun) {
    const std::vector<Written> log = at.port.log();
    auto last = log.end();
    for (auto each = log.begin(); each != log.end(); ++each) {
      if (at.subject->pushes(each->bytes)) last = each;
    }
    const bool over = last != log.end() && std::next(last) != log.end();
    EXPECT_EQ(at.device->counts().zero_left, over);
    if (!over) return 3600;
    EXPECT_FALSE(at.holds_a_force(device::now() + 0.001));
    return std::next(last)->time - begun;
  }

  // Nothing reached it any more: it lets go by itself, or never.
  static void expect_watchdog(Station& at) {
    EXPECT_FALSE(at.device->counts().zero_left);
    const Written last = at.port.log().back();
    EXPECT_TRUE(at.subject->pushes(last.bytes));
    const double watchdog = at.subject->kind().watchdog;
    if (watchdog > 0) {
      EXPECT_TRUE(at.holds_a_force(last.time + 0.95 * watchdog));
      EXPECT_FALSE(at.holds_a_force(last.time + 1.05 * watchdog));
    } else {
      EXPECT_TRUE(at.holds_a_force(last.time + 60)) << "SAFETY.md says that it has none";
    }
  }
};

TEST_P(UsbFault, EndsInAZeroAndAName) {
  const Row& row = *GetParam().row;
  const Fault fault = GetParam().ending.fault;
  // A machine with other work to do may hold a thread up for longer than a fault may last: the best of some trials
  // counts for the time, each that was not held up for everything else.
  constexpr int kTrials = 40;
  double best = 3600;
  int through = 0;
  for (int trial = 0; trial < kTrials && !HasFailure() && (through == 0 || best > 0.010); ++trial) {
    Station at(GetParam().driver);
    if (!pushes(at)) continue;
    const double begun = device::now();
    row.inject(at);
    const Sample sample = fault == Fault::none ? at.drive(0.2, kPush) : at.drive(5, kPush);
    if (sample.fault != fault && at.held_up(sample)) continue;
    EXPECT_STREQ(device::name(sample.fault), device::name(fault));
    EXPECT_EQ(sample.phase, fault == Fault::none ? Phase::ready : Phase::stopped);
    ++through;
    if (fault == Fault::none) {
      EXPECT_GT(at.pushes_since(begun + 0.1), 0);
      best = 0;
      continue;
    }
    at.device->close();
    EXPECT_EQ(at.device->read().phase, Phase::closed);
    EXPECT_EQ(at.device->read().fault, fault);
    if (row.zero) {
      best = std::min(best, zeroed(at, begun));
    } else {
      expect_watchdog(at);
      best = 0;
    }
    if (!at.front->is_prompt() && best < 3600) best = 0;
  }
  EXPECT_LE(best, 0.010);
  if (row.zero) RecordProperty("zero_after_us", static_cast<int>(1e6 * best));
}

INSTANTIATE_TEST_SUITE_P(All, UsbFault, testing::ValuesIn(cases()), [](const testing::TestParamInfo<Case>& each) {
  return test_name(each.param.driver) + "_" + each.param.row->name;
});

// Another firmware than the driver's own is found out before there is any force: it is not loaded (the Falcon's, which
// echoes it and never runs), it announces itself (the open link's), or its reports have the length of the arm with a
// wrist (WoodenHaptics').
class UsbFirmware : public UsbDrivers {};

TEST_P(UsbFirmware, ThatIsWrongEndsInAZeroAndAName) {
  Station at(GetParam());
  at.subject->wrong_firmware();
  at.plug(false);
  ASSERT_TRUE(at.open()) << at.opened.error;
  const Sample sample = at.drive(30, kPush);
  EXPECT_EQ(sample.phase, Phase::stopped);
  EXPECT_STREQ(device::name(sample.fault), device::name(Fault::firmware));
  EXPECT_EQ(at.pushes_since(0), 0);
  at.device->close();
  EXPECT_TRUE(at.device->counts().zero_left || !at.front->is_prompt());
  EXPECT_FALSE(at.holds_a_force(device::now() + 0.001));
}

INSTANTIATE_TEST_SUITE_P(Drivers, UsbFirmware, testing::ValuesIn(kDrivers),
                         [](const testing::TestParamInfo<const char*>& each) { return test_name(each.param); });

}  // namespace
}  // namespace palpate::usb_fault_test
