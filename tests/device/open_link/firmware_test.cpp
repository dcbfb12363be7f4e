// SPDX-License-Identifier: GPL-3.0-or-later
// The open link's example firmware as a Cortex-M7 runs it: QEMU's board on one end of a wire, the host on the other.
// QEMU takes up to 0.1 ms for a byte of its serial port, so that the host's clock goes slower than the board's.
#include "device/open_link/open_link_protocol.hpp"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <functional>

namespace palpate::device {
namespace {

// QEMU with the firmware; its serial port is a socket of ours.
class Board {
public:
  Board() {
    int ends[2];
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) return;
    child_ = fork();
    if (child_ == 0) {
      dup2(ends[1], 0);
      dup2(ends[1], 1);
      execlp("qemu-system-arm", "qemu-system-arm", "-M", "mps2-an500", "-display", "none", "-monitor", "none",
             "-serial", "stdio", "-kernel", PALPATE_FIRMWARE, static_cast<char*>(nullptr));
      _exit(127);
    }
    close(ends[1]);
    wire_ = ends[0];
    fcntl(wire_, F_SETFL, O_NONBLOCK);
  }
  ~Board() {
    if (child_ > 0) {
      kill(child_, SIGKILL);
      waitpid(child_, nullptr, 0);
    }
    close(wire_);
  }
  Board(const Board&) = delete;
  Board& operator=(const Board&) = delete;

  [[nodiscard]] int wire() const { return wire_; }

private:
  pid_t child_ = -1;
  int wire_ = -1;
};

// The host, with a clock of its own and a transport over the board's socket.
class Host {
public:
  Host(const Board& board, Protocol& protocol) : board_(board), protocol_(protocol) {}

  void begin() { protocol_.start(time_); }

  /// Until `enough`, or for so many seconds of the board; whether it was enough.
  bool run(const Vec3& force, double seconds, const std::function<bool()>& enough) {
    constexpr double kSlower = 10;
    const double begun = now(), time = time_;
    for (double ask_at = time; now() < begun + seconds;) {
      time_ = time + (now() - begun) / kSlower;
      std::uint8_t bytes[64];
      const ssize_t count = read(board_.wire(), bytes, sizeof bytes);
      if (count == 0) return false;  // QEMU is gone
      if (count > 0) protocol_.received(time_, bytes, static_cast<std::size_t>(count));
      if (enough()) return true;
      if (time_ >= ask_at) {
        const Request request = protocol_.next(time_, {time_, force, {}});
        ask_at = request.kind == Request::Kind::none ? request.until : time_ + 0.001;
        if (request.kind == Request::Kind::write) {
          const bool left = write(board_.wire(), request.bytes, request.size) == request.size;
          protocol_.ended(time_, left ? Outcome::done : Outcome::timed_out);
        }
      }
      pollfd wire{board_.wire(), POLLIN, 0};
      poll(&wire, 1, 1);
    }
    return false;
  }

  /// For so many seconds by either clock.
  void sleep(double seconds) {
    usleep(static_cast<useconds_t>(1e6 * seconds));
    time_ += seconds;
  }

private:
  const Board& board_;
  Protocol& protocol_;
  double time_ = 0;  // s
};

TEST(Firmware, RunsOnACortexM7) {
  if (!std::filesystem::exists(PALPATE_FIRMWARE)) GTEST_SKIP() << "no arm-none-eabi-g++ (Debian's gcc-arm-none-eabi)";
  if (std::system("qemu-system-arm --version > /dev/null 2>&1") != 0) {
    GTEST_SKIP() << "no qemu-system-arm (Debian's package of that name)";
  }
  Board board;
  OpenLinkProtocol protocol;
  Host host(board, protocol);
  // A busy machine may hold either side up for longer than a fault needs: the link is then opened anew.
  bool held = false;
  for (int trial = 0; trial < 10 && !held; ++trial) {
    host.begin();
    const bool ready = host.run({}, 10, [&] { return protocol.sample().phase == Phase::ready; });
    if (!ready) continue;
    EXPECT_STREQ(protocol.capabilities().name, "MPS2 example");
    // 2 N against a spring of 50 N/m: 40 mm.
    const Vec3 rest{0.04, 0, 0};
    held = host.run({2, 0, 0}, 5, [&] { return length(protocol.sample().pose.translation - rest) < 0.001; });
  }
  ASSERT_TRUE(held) << name(protocol.sample().fault);

  // Nobody talks for 0.3 s: its watchdog lets go, the handle goes home, and the host hears why.
  host.sleep(0.3);
  EXPECT_TRUE(host.run({2, 0, 0}, 2, [&] { return protocol.sample().phase == Phase::stopped; }));
  EXPECT_EQ(protocol.sample().fault, Fault::host_late) << name(protocol.sample().fault);
  EXPECT_EQ(protocol.sample().phase, Phase::stopped);
}

}  // namespace
}  // namespace palpate::device
