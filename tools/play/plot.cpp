// SPDX-License-Identifier: GPL-3.0-or-later
// The SVG writer of line_plot_svg.
#include "tools/play/plot.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace palpate::cli {
namespace {

constexpr double kWidth = 960, kLeft = 80, kRight = 130, kTop = 44, kPanel = 230, kGap = 26, kBottom = 52;
// Colours that red-green colour-blind readers can distinguish too.
constexpr const char* kColours[] = {"#0072b2", "#d55e00", "#009e73", "#222222", "#cc79a7"};

std::string number(double value, const char* format = "%.2f") {
  char text[40];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '&') {
      result += "&amp;";
    } else if (c == '<') {
      result += "&lt;";
    } else if (c == '>') {
      result += "&gt;";
    } else {
      result += static_cast<unsigned char>(c) < 32 ? ' ' : c;
    }
  }
  return result;
}

struct Axis {
  double low, high;  ///< of the data's range, widened to whole steps
  double step;       ///< between ticks: 1, 2 or 5 times a power of ten
  double from, to;   ///< in pixels
  [[nodiscard]] double at(double value) const { return from + (value - low) / (high - low) * (to - from); }
  /// Multiples of the step within the range. Counted, since a step may be too small to change a large number.
  [[nodiscard]] std::vector<double> ticks() const {
    constexpr int kMost = 50;
    std::vector<double> values;
    const double first = std::ceil(low / step - 1e-9);
    for (int k = 0; k < kMost && (first + k) * step <= high + step * 1e-9; ++k) values.push_back((first + k) * step);
    return values;
  }
  [[nodiscard]] std::string tick_text(double value) const {
    if (std::abs(value) >= 1e15) return number(value, "%.6g");
    const int digits = std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 9);
    char text[40];
    std::snprintf(text, sizeof text, "%.*f", digits, std::abs(value) < step / 1e3 ? 0.0 : value);
    return text;
  }
};

Axis make_axis(double low, double high, double from, double to, int ticks, bool whole) {
  if (!(high > low)) {  // one value, or none
    const double middle = std::isfinite(low) ? low : 0;
    low = middle - 0.5 * std::max(1e-3, std::abs(middle));
    high = middle + 0.5 * std::max(1e-3, std::abs(middle));
  }
  const double rough = (high - low) / ticks, power = std::pow(10, std::floor(std::log10(rough)));
  const double step = power * (rough / power <= 1 ? 1 : rough / power <= 2 ? 2 : rough / power <= 5 ? 5 : 10);
  if (whole) {
    low = step * std::floor(low / step + 1e-9);
    high = step * std::ceil(high / step - 1e-9);
  }
  return {low, high, step, from, to};
}

// Points of a line: all, or per pixel column the smallest and the largest in their order.
std::string points_of(const std::vector<double>& x, const std::vector<double>& y, const Axis& ax, const Axis& ay) {
  std::string text;
  const auto put = [&](std::size_t i) { text += number(ax.at(x[i])) + "," + number(ay.at(y[i])) + " "; };
  for (std::size_t i = 0; i < x.size();) {
    std::size_t end = i, low = x.size(), high = x.size();
    for (; end < x.size() && (end == i || ax.at(x[end]) < std::floor(ax.at(x[i])) + 1); ++end) {
      if (!std::isfinite(y[end])) continue;
      if (low == x.size() || y[end] < y[low]) low = end;
      if (high == x.size() || y[end] > y[high]) high = end;
    }
    if (low < x.size()) put(std::min(low, high));
    if (low != high) put(std::max(low, high));
    i = end;
  }
  return text;
}

std::string line(double x1, double y1, double x2, double y2, const char* colour) {
  return "<line x1=\"" + number(x1) + "\" y1=\"" + number(y1) + "\" x2=\"" + number(x2) + "\" y2=\"" + number(y2) +
         "\" stroke=\"" + colour + "\"/>\n";
}

std::string label(double x, double y, const std::string& anchor, const std::string& text, const char* more = "") {
  return "<text x=\"" + number(x) + "\" y=\"" + number(y) + "\" text-anchor=\"" + anchor + "\"" + more + ">" +
         escaped(text) + "</text>\n";
}

std::string draw_panel(const PlotPanel& panel, const std::vector<double>& x, const Axis& ax, double top, bool last) {
  double low = 0, high = 0;  // zero is always in sight: a force is read against it
  for (const PlotSeries& series : panel.series) {
    for (const double v : series.values) {
      if (!std::isfinite(v)) continue;
      low = std::min(low, v);
      high = std::max(high, v);
    }
  }
  const Axis ay = make_axis(low, high, top + kPanel, top, 5, true);
  std::string svg;
  for (const double v : ay.ticks()) {
    svg += line(ax.from, ay.at(v), ax.to, ay.at(v), std::abs(v) < ay.step / 1e3 ? "#888888" : "#dddddd");
    svg += label(ax.from - 8, ay.at(v) + 4, "end", ay.tick_text(v));
  }
  for (const double v : ax.ticks()) {
    svg += line(ax.at(v), top, ax.at(v), top + kPanel, "#dddddd");
    if (last) svg += label(ax.at(v), top + kPanel + 18, "middle", ax.tick_text(v));
  }
  svg += "<rect x=\"" + number(ax.from) + "\" y=\"" + number(top) + "\" width=\"" + number(ax.to - ax.from) +
         "\" height=\"" + number(kPanel) + "\" fill=\"none\" stroke=\"#444444\"/>\n";
  const double middle = top + kPanel / 2;
  const std::string turn = " transform=\"rotate(-90 20 " + number(middle) + ")\"";
  svg += label(20, middle, "middle", panel.label, turn.c_str());
  for (std::size_t k = 0; k < panel.series.size(); ++k) {
    const char* colour = kColours[k % std::size(kColours)];
    svg += "<polyline fill=\"none\" stroke=\"" + std::string(colour) + "\" stroke-width=\"1.4\" points=\"" +
           points_of(x, panel.series[k].values, ax, ay) + "\"/>\n";
    const double y = top + 14 + 20 * static_cast<double>(k);
    svg += "<line x1=\"" + number(ax.to + 12) + "\" y1=\"" + number(y) + "\" x2=\"" + number(ax.to + 34) + "\" y2=\"" +
           number(y) + "\" stroke=\"" + colour + "\" stroke-width=\"2.5\"/>\n";
    svg += label(ax.to + 40, y + 4, "start", panel.series[k].name);
  }
  return svg;
}

}  // namespace

PlotPanel finger_panel(const std::string& label) {
  return {label, {{"thumb", {}}, {"index", {}}, {"middle", {}}, {"ring", {}}, {"little", {}}}};
}

std::string line_plot_svg(const std::string& title, const std::string& x_label, const std::vector<double>& x,
                          const std::vector<PlotPanel>& panels) {
  const double height = kTop + static_cast<double>(panels.size()) * (kPanel + kGap) - kGap + kBottom;
  const Axis ax = make_axis(x.front(), x.back(), kLeft, kWidth - kRight, 10, false);
  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + number(kWidth, "%.0f") + "\" height=\"" +
                    number(height, "%.0f") + "\" viewBox=\"0 0 " + number(kWidth, "%.0f") + " " +
                    number(height, "%.0f") + "\" font-family=\"sans-serif\" font-size=\"13\">\n";
  svg += "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
  svg += label(kLeft, 26, "start", title, " font-size=\"16\"");
  for (std::size_t k = 0; k < panels.size(); ++k) {
    svg += draw_panel(panels[k], x, ax, kTop + static_cast<double>(k) * (kPanel + kGap), k + 1 == panels.size());
  }
  svg += label((ax.from + ax.to) / 2, height - 12, "middle", x_label);
  return svg + "</svg>\n";
}

std::string distribution_svg(const std::string& title, const std::string& label,
                             const std::vector<PlotSeries>& series) {
  constexpr int kSteps = 400;
  std::vector<double> shares;
  for (int k = 0; k <= kSteps; ++k) shares.push_back(100.0 * k / kSteps);
  PlotPanel panel{label, {}};
  for (const PlotSeries& one : series) {
    if (one.values.empty()) continue;
    std::vector<double> sorted = one.values;
    std::sort(sorted.begin(), sorted.end());
    panel.series.push_back({one.name + " (" + std::to_string(sorted.size()) + ")", {}});
    for (int k = 0; k <= kSteps; ++k) {
      const std::size_t count =
          (sorted.size() * std::size_t(k) + kSteps - 1) / kSteps;  // this share of all, rounded up
      panel.series.back().values.push_back(sorted[count > 0 ? count - 1 : 0]);
    }
  }
  return line_plot_svg(title, "share of all (%)", shares, {panel});
}

}  // namespace palpate::cli
