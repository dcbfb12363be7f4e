// SPDX-License-Identifier: GPL-3.0-or-later
// The runtime on a Cortex-M7, emulated instruction by instruction: the host's forces, in so many instructions.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "formats/response/response.hpp"
#include "tests/runtime/m7/ticks.hpp"

namespace palpate::test {
namespace {

using runtime::State;

#ifdef PALPATE_BOARD_TICKS

std::string output(const char* command) {
  std::string text;
  FILE* pipe = ::popen(command, "r");
  if (pipe == nullptr) return text;
  char part[4096];
  for (std::size_t got = 0; (got = std::fread(part, 1, sizeof part, pipe)) > 0;) text.append(part, got);
  EXPECT_EQ(::pclose(pipe), 0) << command;
  return text;
}

TEST(CortexM7, PrintsWhatTheExamplePrintsOnTheHost) {
  const std::string host = output(PALPATE_HOST_MICROCONTROLLER);
  EXPECT_NE(host.find("1000 ms:"), std::string::npos);
  EXPECT_EQ(output(PALPATE_BOARD_MICROCONTROLLER), host);
}

// Records of the board, tick by tick.
std::vector<TickRecord> run_board() {
  const std::string bytes = output(PALPATE_BOARD_TICKS);
  std::vector<TickRecord> records(bytes.size() / sizeof(TickRecord));
  std::memcpy(records.data(), bytes.data(), records.size() * sizeof(TickRecord));
  return records;
}

// Both compute in double precision and round to float: the same one, or now and then the next, for the board's compiler
// fuses multiplications and additions, which the host's leaves two (-ffp-contract=off).
bool same_but_for_rounding(float host, float there) { return host == there || std::nextafter(host, there) == there; }

/// Whether every number of a tick is the host's, to the precision of a float of the largest force. `beside` counts the ticks
/// whose force differs in its last bit. The board multiplies and adds at once, and a difference in rounding lasts as long as
/// the contact.
testing::AssertionResult the_same(const TickRecord& host, const TickRecord& there, int& beside) {
  constexpr float kCancels = 1e-15f;  // m: lever arms of some centimetres, beside which such a torque is none
  if (host.state != there.state) return testing::AssertionFailure() << "state " << there.state << " for " << host.state;
  constexpr float kFloat = 2e-7f, kLever = 0.03f;  // N, of forces up to 1 N; m
  const float none = kCancels * std::hypot(host.force[0], host.force[1], host.force[2]);
  bool exact = true;
  for (int k = 0; k < 3; ++k) {
    if (!same_but_for_rounding(host.force[k], there.force[k]) &&
        !(std::abs(host.force[k] - there.force[k]) <= kFloat)) {
      return testing::AssertionFailure() << "force " << k << ": " << there.force[k] << " for " << host.force[k];
    }
    if (!same_but_for_rounding(host.torque[k], there.torque[k]) &&
        !(std::abs(host.torque[k] - there.torque[k]) <= none + kFloat * kLever)) {
      return testing::AssertionFailure() << "torque " << k << ": " << there.torque[k] << " for " << host.torque[k];
    }
    exact = exact && host.force[k] == there.force[k];
  }
  beside += !exact;
  return testing::AssertionSuccess();
}

struct Longest {
  std::uint32_t tick = 0, search = 0, alone = 0;
  void include(const TickRecord& r) {
    tick = std::max(tick, r.tick);
    search = std::max(search, r.search);
    alone = std::max(alone, r.alone);
  }
};

// Instructions of the longest tick that was given a search, for a motion that wanders, one that stabs, and one that leaps
// and tilts every tick. tests/measured/property.md has what is measured.
constexpr std::uint32_t kMostInstructions = 20000;

TEST(CortexM7, GivesTheForcesOfTheHostInSoManyInstructions) {
  const std::vector<TickRecord> board = run_board();
  std::size_t next = 0;
  int seen[5] = {}, beside = 0;
  for (const char* name : {PALPATE_M7_FILES}) {
    SCOPED_TRACE(name);
    const std::vector<std::byte> bytes = read_bytes(std::filesystem::path(PALPATE_GOLDENS) / name);
    const runtime::OpenResult opened = runtime::View::open(bytes.data(), bytes.size());
    ASSERT_TRUE(opened) << opened.error;
    const std::size_t first = next;
    float force = 0;
    Longest longest;
    std::uint32_t stabbing = 0, leaping = 0;
    int stabs = 0, leaps = 0;
    std::uint64_t all = 0, lean = 0;
    std::vector<std::uint32_t> touching;
    const auto uncounted = [](const auto& work) { return work(), 0u; };
    const auto none = [](const runtime::View&, std::uint32_t) -> ProgramTick { return nullptr; };
    tick_all(opened.view, uncounted, none, [&](const TickRecord& host, Hand hand) {
      ASSERT_LT(next, board.size());
      const TickRecord& there = board[next++];
      ASSERT_TRUE(the_same(host, there, beside)) << "hand " << static_cast<int>(hand) << ", tick " << next - first;
      const auto state = static_cast<State>(there.state);
      const bool touches = state == State::stick || state == State::slide;
      if (hand == Hand::stabbing) {
        stabbing = std::max(stabbing, there.tick);
        stabs += touches;
        return;
      }
      if (hand == Hand::leaping) {
        leaping = std::max(leaping, there.tick);
        leaps += touches;
        return;
      }
      ++seen[there.state];
      for (const float part : host.force) force = std::max(force, std::abs(part));
      longest.include(there);
      all += there.tick;
      lean += there.lean;
      if (!touches) return;
      touching.push_back(there.tick);
    });
    ASSERT_GT(next, first);
    EXPECT_GT(force, 0.1f);
    EXPECT_GT(stabs, 250);
    EXPECT_GT(leaps, 250);
    EXPECT_GT(lean, 0u);
    EXPECT_LT(lean, all) << "a program without the features that the file does not have is faster";
    std::nth_element(touching.begin(), touching.begin() + touching.size() / 2, touching.end());
    std::printf(
        "%-18s %5u instructions a touching tick, at most %6u, stabbing %6u, leaping %6u; a search %6u; both in one "
        "%6u; "
        "lean %.3f of it\n",
        name, touching[touching.size() / 2], longest.tick, stabbing, leaping, longest.search, longest.alone,
        static_cast<double>(lean) / static_cast<double>(all));
  }
  EXPECT_EQ(next, board.size());
  EXPECT_LE(beside, next / 1000);  // 27 of 69 000
  std::printf("%d of %zu ticks beside the host's last bit of a float\n", beside, next);
  EXPECT_GT(seen[static_cast<int>(State::stick)], 1000);
  EXPECT_GT(seen[static_cast<int>(State::slide)], 1000);
  EXPECT_GT(seen[static_cast<int>(State::free)], 1000);
  EXPECT_GT(seen[static_cast<int>(State::released)], 10);
}

// Long ticks are rare: of a tool with spins one in thousands.
TEST(CortexM7, TakesNoLongerInAnyOfManyTicks) {
  std::istringstream board(output(PALPATE_BOARD_LONGEST));
  std::uint32_t longest = 0;
  for (const char* name : {PALPATE_M7_FILES}) {
    const std::vector<std::byte> bytes = read_bytes(std::filesystem::path(PALPATE_GOLDENS) / name);
    const runtime::OpenResult opened = runtime::View::open(bytes.data(), bytes.size());
    ASSERT_TRUE(opened) << opened.error;
    for (std::uint32_t run = 0; run < 3 * opened.view.meta->tool_count; ++run) {
      std::uint32_t most = 0;
      ASSERT_TRUE(board >> most);
      EXPECT_LE(most, kMostInstructions) << name << ", " << opened.view.tools[run / 3].name << ", hand " << run % 3;
      longest = std::max(longest, most);
    }
  }
  std::printf("the longest tick takes %u instructions\n", longest);
}

#else

TEST(CortexM7, IsEmulated) {
  GTEST_SKIP() << "needs gcc-arm-none-eabi, libstdc++-arm-none-eabi-newlib and qemu-system-arm when configured";
}

#endif

}  // namespace
}  // namespace palpate::test
