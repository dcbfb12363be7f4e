// SPDX-License-Identifier: GPL-3.0-or-later
// The direction of the nearest place on curves (CGAL AABB tree behind a narrow header). Safe to share between threads.
#pragma once

#include "formats/surface/curve_io.hpp"

#include <memory>

namespace palpate::geometry {

class CurveQuery {
public:
  /// At least one piece.
  explicit CurveQuery(const Curves& curves);
  ~CurveQuery();
  CurveQuery(const CurveQuery&) = delete;
  CurveQuery& operator=(const CurveQuery&) = delete;

  [[nodiscard]] const Curves& curves() const noexcept;
  /// Unit tangent at the nearest place on the curves (either of its two signs). Along a piece it turns from the tangent
  /// at one end to that at the other; where two pieces meet it is that of the circle through their ends.
  [[nodiscard]] Eigen::Vector3d tangent(const Eigen::Vector3d& point) const;

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::geometry
