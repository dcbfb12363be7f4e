// SPDX-License-Identifier: GPL-3.0-or-later
// Line plots as SVG: panels above each other with one horizontal axis.
#pragma once

#include <string>
#include <vector>

namespace palpate::cli {

struct PlotSeries {
  std::string name;
  std::vector<double> values;  ///< one an abscissa
};

struct PlotPanel {
  std::string label;  ///< of the vertical axis, with its unit
  std::vector<PlotSeries> series;
};

/// With an empty series for each finger, the thumb's first.
PlotPanel finger_panel(const std::string& label);

/// A whole SVG document. `x` ascending, at least one value; values that are not finite are left out of the line.
/// Long series are thinned to the smallest and largest value a pixel, so that no peak is lost.
std::string line_plot_svg(const std::string& title, const std::string& x_label, const std::vector<double>& x,
                          const std::vector<PlotPanel>& panels);

}  // namespace palpate::cli
