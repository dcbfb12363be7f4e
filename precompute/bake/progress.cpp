// SPDX-License-Identifier: GPL-3.0-or-later
// The text of a bake's progress and where it goes.
#include "precompute/bake/progress.hpp"

#include <unistd.h>

#include <cmath>

namespace palpate::bake {

std::string duration_text(double seconds) {
  const auto s = static_cast<long>(std::ceil(seconds));
  if (s < 60) return std::to_string(s) + " s";
  if (s < 3600) return std::to_string(s / 60) + " min " + std::to_string(s % 60) + " s";
  return std::to_string(s / 3600) + " h " + std::to_string(s % 3600 / 60) + " min";
}

std::string progress_text(const BakeProgress& p) {
  char share[32];
  std::snprintf(share, sizeof share, "%.1f",
                p.total > 0 ? 100.0 * static_cast<double>(p.done) / static_cast<double>(p.total) : 100.0);
  std::string text = "bake " + std::to_string(p.done) + "/" + std::to_string(p.total) + " pairs (" + share + " %), " +
                     std::to_string(p.refused) + " refused";
  if (p.per_hour > 0) text += ", " + std::to_string(std::lround(p.per_hour)) + " pairs/h";
  if (p.seconds_left >= 0 && p.done < p.total) text += ", " + duration_text(p.seconds_left) + " left";
  return text;
}

ProgressPrinter::ProgressPrinter(std::FILE* stream, double quiet_interval)
    : stream_(stream), quiet_interval_(quiet_interval), terminal_(::isatty(::fileno(stream)) == 1) {}

void ProgressPrinter::operator()(const BakeProgress& progress) {
  std::string text = progress_text(progress);
  if (terminal_) {
    const std::size_t width = text.size();
    if (width < width_) text.append(width_ - width, ' ');
    width_ = width;
    std::fprintf(stream_, "\r%s", text.c_str());
  } else {
    const bool last = progress.done == progress.total;
    if (!last && printed_ >= 0 && progress.seconds - printed_ < quiet_interval_) return;
    printed_ = progress.seconds;
    std::fprintf(stream_, "%s\n", text.c_str());
  }
  std::fflush(stream_);
}

void ProgressPrinter::finish() {
  if (terminal_ && width_ > 0) std::fputc('\n', stream_);
}

}  // namespace palpate::bake
