// SPDX-License-Identifier: GPL-3.0-or-later
// Figures 2 and 4 of Mahvash and Hayward (2004), solved, and what the paper says of them as figures with limits.
#pragma once

#include "formats/scene/scene.hpp"

#include <string>
#include <vector>

namespace palpate::verify {

/// Force (N) at places (m, ascending from 0) of one push.
struct PaperCurve {
  std::string name;
  std::vector<double> at, force;
};

struct PaperPanel {
  std::string title;
  std::vector<PaperCurve> curves;
};

/// One sentence of the paper, and the figure that decides it.
struct PaperStatement {
  std::string text;
  double figure = 0.0, limit = 0.0;
  bool at_most = true;  ///< else at least
  [[nodiscard]] bool holds() const { return at_most ? figure <= limit : figure >= limit; }
};

struct PaperFigure {
  std::string title, abscissa;  ///< abscissa without its unit
  std::vector<PaperPanel> panels;
  std::vector<PaperStatement> statements;
};

/// The normal indentations of three tools (a large sphere, a small one, a flat punch, in this order) at the origin of
/// one sample, loosely and firmly supported. Throws Error(numerical) where a contact is refused, Error(bad_input) where
/// the scenes have other tools than three.
PaperFigure solve_figure_2(const Scene& loose, const Scene& firm, unsigned threads);

/// Tangential pushes along x at the origin of a homogeneous sample and of one with an inclusion at +x, and the force at
/// one end point from several first contact points on the homogeneous one. Throws Error(numerical) likewise.
PaperFigure solve_figure_4(const Scene& homogeneous, const Scene& inclusion, unsigned threads);

/// Statements of figure 2 on panels loose, firm with the curves large sphere, small sphere, flat punch.
std::vector<PaperStatement> figure_2_statements(const std::vector<PaperPanel>& panels);

/// Statements of figure 4 on panels homogeneous, inclusion (curves to the right, to the left) and end point (curves
/// normal, tangential over the distance of the first contact point).
std::vector<PaperStatement> figure_4_statements(const std::vector<PaperPanel>& panels);

/// Force at a place, linear between points; not a number beyond them.
double force_at(const PaperCurve& curve, double at);

}  // namespace palpate::verify
