// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/drive/drive_view.hpp"

#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <thread>

namespace palpate::cli {
namespace {

using device::Histogram;
using device::LoopReport;
using device::Mode;

[[gnu::format(printf, 1, 2)]] std::string text(const char* format, ...) {
  char line[400];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  return line;
}

std::string milliseconds(const char* name, const Histogram& h) {
  if (h.count() == 0) return text("%-12s none\n", name);
  return text("%-12s mean %7.3f  median %7.3f  99 %% %7.3f  99.9 %% %7.3f  most %7.3f ms\n", name, 1e3 * h.mean(),
              1e3 * h.quantile(0.5), 1e3 * h.quantile(0.99), 1e3 * h.quantile(0.999), 1e3 * h.most());
}

// For signal handlers, which have no access to objects.
termios terminal_before = {};
std::atomic<bool> is_changed{false};
static_assert(std::atomic<bool>::is_always_lock_free);

std::string bar(double share) {
  constexpr int kWidth = 30;
  const int full = static_cast<int>(std::lround(kWidth * std::clamp(share, 0.0, 1.0)));
  return std::string(static_cast<std::size_t>(full), '#') + std::string(static_cast<std::size_t>(kWidth - full), '.');
}

/// From the thumb on.
std::string pulls(const device::Pulls& pull) {
  return text("%.3f %.3f %.3f %.3f %.3f N", pull[0], pull[1], pull[2], pull[3], pull[4]);
}

}  // namespace

Keys::Keys() {
  // In the background it is somebody else's: who touches it there is suspended, and sends no zero.
  const pid_t front = ::tcgetpgrp(STDIN_FILENO);
  const bool ours = front < 0 || front == ::getpgrp();
  terminal_ = ours && ::tcgetattr(STDIN_FILENO, &terminal_before) == 0;
  if (!terminal_) return;
  is_changed = true;
  termios raw = terminal_before;
  raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);  // Ctrl-C stays a signal
  ::tcsetattr(STDIN_FILENO, TCSANOW, &raw);
}

Keys::~Keys() { restore_terminal(); }

void Keys::restore_terminal() {
  if (!is_changed.exchange(false)) return;
  // Also from the background, where the terminal would suspend the program instead.
  sigset_t output, before;
  sigemptyset(&output);
  sigaddset(&output, SIGTTOU);
  ::pthread_sigmask(SIG_BLOCK, &output, &before);
  ::tcsetattr(STDIN_FILENO, TCSANOW, &terminal_before);
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

int Keys::wait(int milliseconds) const {
  if (!terminal_) {
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
    return 0;
  }
  pollfd input{STDIN_FILENO, POLLIN, 0};
  unsigned char key = 0;
  if (::poll(&input, 1, milliseconds) != 1) return 0;
  return ::read(STDIN_FILENO, &key, 1) == 1 ? key : 0;
}

std::string standing(const device::TickOutput& out) {
  std::string words = device::name(out.mode);
  if (out.cause != device::Cause::none) words += std::string(": ") + device::name(out.cause);
  if (out.fault != device::Fault::none) words += std::string(" (") + device::name(out.fault) + ")";
  return words;
}

std::string drive_screen(const DriveTitle& title, const LoopReport& r, std::uint64_t dropped) {
  const runtime::Vec3 at = 1e3 * r.seen.sample.pose.translation, f = r.out.command.force;
  const std::string share = bar(r.out.command.strength() / title.limit);
  std::string screen =
      text("%.60s, tool '%.30s', on %.40s\n", title.file.c_str(), title.tool.c_str(), title.device.c_str());
  screen += text("%8.1f s   %s\n", r.elapsed, standing(r.out).c_str());
  screen += text("%-9s %8.2f %8.2f %8.2f mm      depth %6.2f mm\n", title.glove ? "wrist" : "position", at.x, at.y,
                 at.z, 1e3 * r.out.answer.depth);
  if (title.glove) {
    screen += text("pulls     %s   [%s] %.3g N\n", pulls(r.out.command.pull).c_str(), share.c_str(), title.limit);
  } else {
    screen += text("force     %8.3f %8.3f %8.3f N       |F| %8.3f N   [%s] %.3g N\n", f.x, f.y, f.z, length(f),
                   share.c_str(), title.limit);
  }
  screen += text("rate      %8.1f Hz   period %.3f ms (99 %%: %.3f, most %.3f)\n", r.rate(), 1e3 * r.period.mean(),
                 1e3 * r.period.quantile(0.99), 1e3 * r.period.most());
  screen += text("sample    %8.3f ms old (99 %%: %.3f, most %.3f)\n", 1e3 * r.age.mean(), 1e3 * r.age.quantile(0.99),
                 1e3 * r.age.most());
  screen += text("deadlines missed %llu   suspensions %llu   ticks not recorded %llu\n",
                 static_cast<unsigned long long>(r.missed), static_cast<unsigned long long>(r.suspensions),
                 static_cast<unsigned long long>(dropped));
  return screen + "space: EMERGENCY STOP   q, Ctrl-C: stop   s: statistics\n";
}

std::string drive_line(const DriveTitle& title, const LoopReport& r) {
  const runtime::Vec3 at = 1e3 * r.seen.sample.pose.translation, f = r.out.command.force;
  const std::string given =
      title.glove ? "pulls " + pulls(r.out.command.pull)
                  : text("position %.2f %.2f %.2f mm  force %.3f %.3f %.3f N", at.x, at.y, at.z, f.x, f.y, f.z);
  return text("%7.1f s  %s  %.1f Hz  missed %llu  %s\n", r.elapsed, given.c_str(), r.rate(),
              static_cast<unsigned long long>(r.missed), standing(r.out).c_str());
}

std::string drive_statistics(const LoopReport& r, std::uint64_t dropped) {
  std::string lines =
      text("%llu ticks in %.2f s: %.2f Hz; %llu deadlines missed; %s\n", static_cast<unsigned long long>(r.ticks),
           r.elapsed, r.rate(), static_cast<unsigned long long>(r.missed), standing(r.out).c_str());
  lines += milliseconds("period", r.period) + milliseconds("late", r.late) + milliseconds("sample age", r.age);
  lines += text("peak force %.4g N; the force was suspended %llu time%s; %llu tick%s with a stale sample, %llu late\n",
                r.peak_force, static_cast<unsigned long long>(r.suspensions), r.suspensions == 1 ? "" : "s",
                static_cast<unsigned long long>(r.stale_ticks), r.stale_ticks == 1 ? "" : "s",
                static_cast<unsigned long long>(r.late_ticks));
  if (dropped > 0) lines += text("%llu ticks are not in the recording\n", static_cast<unsigned long long>(dropped));
  return lines;
}

DriveView::DriveView(const DriveTitle& title) : title_(title), terminal_(::isatty(STDERR_FILENO) == 1) {}

void DriveView::show(const LoopReport& report, std::uint64_t dropped) {
  if (!terminal_) {
    if (report.elapsed < next_ || report.ticks == 0) return;
    next_ = std::floor(report.elapsed) + 1;
    std::fputs(drive_line(title_, report).c_str(), stderr);
    return;
  }
  const std::string screen = drive_screen(title_, report, dropped);
  std::string drawn = lines_ > 0 ? "\x1b[" + std::to_string(lines_) + "A" : "";  // up to where the last one began
  for (const char c : screen) drawn += c == '\n' ? std::string("\x1b[K\n") : std::string(1, c);
  lines_ = static_cast<int>(std::count(screen.begin(), screen.end(), '\n'));
  std::fputs(drawn.c_str(), stderr);
}

}  // namespace palpate::cli
