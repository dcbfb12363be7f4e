// SPDX-License-Identifier: GPL-3.0-or-later
// Line plots as SVG: panels above each other with one horizontal axis; distributions.
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

/// How values are distributed: against a share from 0 to 100 %, the value that this share of a series does not exceed.
/// `label`: of the values, with their unit. Series need no common length; an empty one is left out.
std::string distribution_svg(const std::string& title, const std::string& label, const std::vector<PlotSeries>& series);

}  // namespace palpate::cli
