// SPDX-License-Identifier: MIT
// Rows: constraints of bodies that share compliance, solved by projected Gauss-Seidel.
#pragma once

#include "palpate/math/vec3.hpp"

#include <cmath>
#include <cstddef>

namespace palpate::runtime {

/// Constants of the solver of rows.
struct RowsConstants {
  /// Least share of a row's compliance that the bilateral rows before it leave. A row below it repeats these rows and
  /// has no force. Rounding reaches 1e-16 over this share of a force.
  static constexpr double kDependent = 1e-12;
  /// Change of the forces in a sweep over the forces, below which a sweep changes them by rounding alone.
  static constexpr double kRounding = 1e-12;
};

/// Outcome of one solve.
struct RowsOutcome {
  /// Estimated relative error of the forces: the change d of the last sweep times q / (1 - q), q the change over that
  /// of the sweep before (a geometric series), over the forces. Changes and forces count as sqrt(sum of W_ii f_i^2).
  /// Rows that conflict count with their gap. HUGE_VAL where the changes do not fall, and after a fault.
  double error = 0;
  bool finite = true;  ///< false: a free gap was not finite, and all forces are 0

  [[nodiscard]] bool converged(double tolerance = 0.01) const { return error <= tolerance; }
};

/// At most `Most` rows with forces f and gaps
///
///     gap = free + W f                 free  gaps without forces (m)        W  compliance, symmetric, positive (m/N)
///
/// and one law each:
///
///     bilateral    gap = 0
///     limited      low <= f <= high; gap > 0 only at f = low, gap < 0 only at f = high
///     contact      f_n >= 0, gap_n >= 0, f_n gap_n = 0; |f_t| <= mu f_n, and the slip gap_t opposes f_t at the limit
///
/// Bilateral rows are eliminated exactly in prepare(), by the symmetric sweep operator (Goodnight 1979). The others are
/// solved by a fixed number of sweeps of projected Gauss-Seidel from the given forces, so that the same input has the
/// same bits in every run. A solve takes (rows that are not bilateral) x rows x (sweeps + 1) multiply-adds. The memory
/// is fixed: 8 Most^2 bytes. Not for several threads at once.
template <int Most>
class Rows {
  static_assert(Most >= 1);
  static constexpr std::size_t kPad = 4;  ///< rows are multiples of this, so that every pass has whole vectors
  static constexpr std::size_t kStride = (static_cast<std::size_t>(Most) + kPad - 1) / kPad * kPad;

public:
  void clear() { *this = Rows(); }

  [[nodiscard]] int size() const { return size_; }

  /// Adds a row and returns its index; -1 where the memory is full, or where a bilateral row follows another kind.
  int add_bilateral() {
    if (size_ == Most || size_ != bilateral_) return -1;
    ++bilateral_;
    return add({-HUGE_VAL, HUGE_VAL, Kind::bilateral});
  }
  /// `low` <= 0 <= `high` (N). Unilateral: 0, HUGE_VAL.
  int add_limited(double low, double high) { return size_ == Most ? -1 : add({low, high, Kind::limited}); }
  /// Adds three rows: normal, and two across it. `friction`: mu, at least 0. Returns the index of the first.
  int add_contact(double friction) {
    if (size_ + 3 > Most) return -1;
    const int first = add({0, friction, Kind::contact});
    add({0, 0, Kind::tangential});
    add({0, 0, Kind::tangential});
    return first;
  }

  /// Adds `value` (m/N) to W between two rows, both ways round.
  void add_compliance(int i, int j, double value) {
    row(i)[j] += value;
    if (i != j) row(j)[i] += value;
  }

  /// Eliminates the bilateral rows, once after the compliance is complete. Returns null, or the cause why the rows
  /// cannot be solved. 2 bilateral rows^2 multiply-adds.
  const char* prepare() {
    for (int i = 0; i < size_; ++i) {
      for (int j = 0; j < size_; ++j) {
        if (!std::isfinite(row(i)[j])) return fault_ = "compliance between two rows is not finite";
      }
      diagonal_[i] = row(i)[i];
      if (!(diagonal_[i] > 0)) return fault_ = "compliance of a row is not above 0: neither side of it can move";
    }
    for (int b = 0; b < bilateral_; ++b) {
      law_[b].dependent = !(row(b)[b] > RowsConstants::kDependent * diagonal_[b]);
      if (!law_[b].dependent) eliminate(b);
    }
    for (int i = bilateral_; i < size_; ++i) {
      law_[i].dependent = !(row(i)[i] > RowsConstants::kDependent * diagonal_[i]);
    }
    return fault_ = nullptr;
  }

  /// Solves for the forces (N). `free` (m): size() gaps without forces. `force`: size() forces to start from, and the
  /// result. `sweeps`: at least 1; the estimate of the error needs 2.
  RowsOutcome solve(const double* free, double* force, int sweeps) {
    bool finite = fault_ == nullptr;
    for (int i = 0; i < size_; ++i) finite = finite && std::isfinite(free[i]) && std::isfinite(force[i]);
    if (!finite) {
      for (int i = 0; i < size_; ++i) force[i] = gap_[i] = 0;
      return {HUGE_VAL, false};
    }
    start(free, force);
    double before = HUGE_VAL, change = HUGE_VAL;
    for (int k = 0; k < sweeps; ++k) {
      before = change;
      change = sweep(force);
    }
    return finish(force, std::sqrt(before), std::sqrt(change));
  }

  /// m, of the last solve; 0 for a bilateral row.
  [[nodiscard]] double gap(int i) const { return gap_[i]; }
  /// True for a row that the bilateral rows leave no freedom. It has no force.
  [[nodiscard]] bool dependent(int i) const { return law_[i].dependent; }

private:
  enum class Kind : unsigned char { bilateral, limited, contact, tangential };
  struct Law {
    double low = 0, high = 0;  ///< N; high of a contact: coefficient of friction
    Kind kind = Kind::bilateral;
    bool dependent = false;
  };

  int add(const Law& law) {
    law_[size_] = law;
    return size_++;
  }

  double* row(int i) { return compliance_ + static_cast<std::size_t>(i) * kStride; }

  /// target += factor x row i, over all rows.
  void add_row(double* target, int i, double factor) {
    const double* const source = row(i);
    const std::size_t count = (static_cast<std::size_t>(size_) + kPad - 1) / kPad;
    for (std::size_t k = 0; k < count; ++k) {
      double sum[kPad];  // apart from `target`, so that the compiler needs no proof that it is not `source`
      for (std::size_t j = 0; j < kPad; ++j) sum[j] = target[kPad * k + j] + factor * source[kPad * k + j];
      for (std::size_t j = 0; j < kPad; ++j) target[kPad * k + j] = sum[j];
    }
  }

  /// Exchanges gap and force of row b: W becomes [[-W_bb^-1, W_bb^-1 W_bu], [., W_uu - W_ub W_bb^-1 W_bu]].
  void eliminate(int b) {
    const double pivot = 1 / row(b)[b];
    for (int i = 0; i < size_; ++i) {
      if (i == b || row(i)[b] == 0) continue;
      const double factor = pivot * row(i)[b];
      add_row(row(i), b, -factor);
      row(i)[b] = factor;
    }
    for (int i = 0; i < size_; ++i) row(b)[i] = row(i)[b];
    row(b)[b] = -pivot;
  }

  /// gap_ of an eliminated row accumulates its force with the other sign.
  [[nodiscard]] bool eliminated(int i) const { return i < bilateral_ && !law_[i].dependent; }

  void start(const double* free, double* force) {
    for (int i = 0; i < size_; ++i) gap_[i] = eliminated(i) ? 0 : free[i];
    for (int i = 0; i < size_; ++i) {
      if (eliminated(i)) {
        add_row(gap_, i, -free[i]);
      } else if (law_[i].dependent) {
        force[i] = 0;
      } else if (force[i] != 0) {
        add_row(gap_, i, force[i]);
      }
    }
  }

  /// Returns the sum of W_ii (change of f_i)^2.
  double sweep(double* force) {
    double sum = 0;
    const auto set = [&](int i, double value) {
      const double change = value - force[i];
      if (change == 0) return;
      force[i] = value;
      add_row(gap_, i, change);
      sum += diagonal_[i] * change * change;
    };
    for (int i = bilateral_; i < size_; ++i) {
      const Law& law = law_[i];
      if (law.kind == Kind::limited) {
        if (!law.dependent) set(i, clamped(force[i] - gap_[i] / row(i)[i], law.low, law.high));
        continue;
      }
      if (!law.dependent) set(i, larger(0, force[i] - gap_[i] / row(i)[i]));
      double across[2];
      tangential(i, force, across);
      set(i + 1, across[0]);
      set(i + 2, across[1]);
      i += 2;
    }
    return sum;
  }

  /// The forces across contact i that solve its own two rows. At the limit a step along the gap, because the slip
  /// opposes the force there whatever the rows' compliance.
  void tangential(int i, const double* force, double (&across)[2]) {
    across[0] = across[1] = 0;
    const double limit = law_[i].high * force[i];
    if (!(limit > 0) || law_[i + 1].dependent || law_[i + 2].dependent) return;
    const double a = row(i + 1)[i + 1], b = row(i + 1)[i + 2], c = row(i + 2)[i + 2], determinant = a * c - b * b;
    const double x = gap_[i + 1], y = gap_[i + 2];
    const double most = 0.5 * (a + c) + std::sqrt(0.25 * (a - c) * (a - c) + b * b);  // larger eigenvalue
    if (determinant > RowsConstants::kDependent * most * most) {
      across[0] = force[i + 1] - (c * x - b * y) / determinant;
      across[1] = force[i + 2] - (a * y - b * x) / determinant;
      if (across[0] * across[0] + across[1] * across[1] <= limit * limit) return;
    }
    across[0] = force[i + 1] - x / most;
    across[1] = force[i + 2] - y / most;
    const double size = std::sqrt(across[0] * across[0] + across[1] * across[1]);
    if (size > limit) {
      across[0] *= limit / size;
      across[1] *= limit / size;
    }
  }

  RowsOutcome finish(double* force, double before, double change) {
    double forces = 0, conflict = 0;
    for (int i = 0; i < size_; ++i) {
      if (eliminated(i)) {
        force[i] = -gap_[i];
        gap_[i] = 0;
      } else if (law_[i].dependent) {
        const bool open = law_[i].kind == Kind::tangential || (law_[i].kind != Kind::bilateral && gap_[i] >= 0);
        if (!open) conflict += gap_[i] * gap_[i] / diagonal_[i];
      }
      forces += diagonal_[i] * force[i] * force[i];
    }
    RowsOutcome outcome;
    outcome.finite = std::isfinite(forces + conflict);
    if (!outcome.finite) {
      for (int i = 0; i < size_; ++i) force[i] = gap_[i] = 0;
      return {HUGE_VAL, false};
    }
    const double size = std::sqrt(forces);
    if (change > RowsConstants::kRounding * size) {
      outcome.error = change < before && before < HUGE_VAL ? change * change / ((before - change) * size) : HUGE_VAL;
    }
    if (conflict > 0) outcome.error += size > 0 ? std::sqrt(conflict) / size : HUGE_VAL;
    return outcome;
  }

  double compliance_[static_cast<std::size_t>(Most) * kStride] = {};  ///< W; after prepare() swept
  double diagonal_[Most] = {};                                        ///< m/N, of W
  double gap_[kStride] = {};
  Law law_[Most] = {};
  int size_ = 0, bilateral_ = 0;
  const char* fault_ = "prepare() was not called";
};

}  // namespace palpate::runtime
