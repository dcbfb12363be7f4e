// SPDX-License-Identifier: MIT
// The constraints of a mechanism, and the rows that they have.
#pragma once

#include "palpate/mechanism/handles.hpp"
#include "palpate/mechanism/rows.hpp"

#include <array>
#include <cmath>
#include <cstddef>

namespace palpate::runtime {

/// Constraints of at most `MostRows` rows.
template <int MostRows>
class ConstraintSet {
public:
  /// Adds `count` constraints. Returns false, and adds none, where they have no room.
  bool add(const Constraint* more, std::size_t count) {
    int rows = row_count_;
    for (std::size_t i = 0; i < count; ++i) {
      for (int k = 0; k < 3; ++k) rows += more[i].has_row(k);
    }
    if (count > constraint_.size() - count_ || rows > MostRows) return false;
    for (std::size_t i = 0; i < count; ++i) constraint_[count_++] = more[i];
    row_count_ = rows;
    return true;
  }
  void clear() { count_ = 0, row_count_ = 0; }

  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] const Constraint& operator[](std::size_t i) const { return constraint_[i]; }

  /// Index of the row of direction k of a constraint that has one.
  [[nodiscard]] int row(std::size_t i, int k) const { return index_[i][k]; }

  /// Adds its rows, bilateral ones first.
  template <int Most>
  void add_rows(Rows<Most>& rows) {
    for (const bool bilateral : {true, false}) {
      for (std::size_t i = 0; i < count_; ++i) {
        for (int k = 0; k < 3; ++k) {
          const RowKind kind = constraint_[i].kind[k];
          if (kind != RowKind::none && (kind == RowKind::bilateral) == bilateral) add_row(rows, i, k);
          if (kind == RowKind::contact) break;
        }
      }
    }
  }

  /// Gaps (m) and forces (N) of its rows now. Constraints that were added since the last call begin.
  template <int Count>
  void load(const HandleSet<Count>& handles, double* gaps, double* forces) {
    for (std::size_t i = 0; i < count_; ++i) {
      Constraint& c = constraint_[i];
      const Vec3 apart = handles.position(c.a) - handles.position(c.b);
      double gap[3];
      for (int k = 0; k < 3; ++k) gap[k] = c.has_row(k) ? dot(handles.direction(c, k), apart) + c.offset[k] : 0;
      if (!c.begun) begin(c, gap);
      for (int k = 0; k < 3; ++k) {
        if (!c.has_row(k)) continue;
        forces[index_[i][k]] = c.force[k];
        gaps[index_[i][k]] = gap[k] + (k == 0 ? c.late : 0);
      }
    }
  }

  /// Keeps the forces (N) of its rows.
  void store(const double* forces) {
    for (std::size_t i = 0; i < count_; ++i) {
      for (int k = 0; k < 3; ++k) {
        if (constraint_[i].has_row(k)) constraint_[i].force[k] = forces[index_[i][k]];
      }
    }
  }
  void drop_forces() {
    for (std::size_t i = 0; i < count_; ++i) {
      for (double& f : constraint_[i].force) f = 0;
    }
  }

  /// Friction rows at their limit slip by the gaps of the last solve, and late rows that open have their gap.
  template <int Most>
  void slip(const Rows<Most>& rows) {
    for (std::size_t i = 0; i < count_; ++i) slip(rows, i);
  }

private:
  template <int Most>
  void add_row(Rows<Most>& rows, std::size_t i, int k) {
    const Constraint& c = constraint_[i];
    int& index = index_[i][k];
    switch (c.kind[k]) {
      case RowKind::bilateral:
        index = rows.add_bilateral();
        break;
      case RowKind::unilateral:
        index = rows.add_limited(0, HUGE_VAL);
        break;
      case RowKind::friction:
        index = rows.add_limited(-c.limit, c.limit);
        break;
      case RowKind::contact:
        for (int j = 0, first = rows.add_contact(c.limit); j < 3; ++j) index_[i][j] = first + j;
        break;
      case RowKind::none:
        break;
    }
  }

  static void begin(Constraint& c, double (&gap)[3]) {
    c.begun = true;
    const bool opens = c.kind[0] == RowKind::unilateral || c.kind[0] == RowKind::contact;
    if (opens) c.late = larger(0, -gap[0]);
    for (int k = 0; k < 3; ++k) {
      const bool slips = c.kind[k] == RowKind::friction || (c.kind[0] == RowKind::contact && k > 0);
      if (!slips) continue;
      c.offset[k] -= gap[k];
      gap[k] = 0;
    }
  }

  template <int Most>
  void slip(const Rows<Most>& rows, std::size_t i) {
    Constraint& c = constraint_[i];
    constexpr double kAtLimit = 1 - 1e-9;
    for (int k = 0; k < 3; ++k) {
      if (c.kind[k] == RowKind::friction && std::fabs(c.force[k]) >= kAtLimit * c.limit) {
        c.offset[k] -= rows.gap(index_[i][k]);
      }
    }
    if (c.late > 0 && !(c.force[0] > 0)) c.late = larger(0, c.late - rows.gap(index_[i][0]));
    if (c.kind[0] != RowKind::contact) return;
    const double limit = c.limit * c.force[0];
    if (c.force[1] * c.force[1] + c.force[2] * c.force[2] < kAtLimit * kAtLimit * limit * limit) return;
    for (int k = 1; k < 3; ++k) c.offset[k] -= rows.gap(index_[i][k]);
  }

  std::array<Constraint, static_cast<std::size_t>(MostRows)> constraint_;
  std::size_t count_ = 0;
  int row_count_ = 0;
  int index_[static_cast<std::size_t>(MostRows)][3] = {};
};

}  // namespace palpate::runtime
