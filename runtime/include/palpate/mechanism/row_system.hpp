// SPDX-License-Identifier: MIT
// The rows of all constraints and contacts of a mechanism: their assembly and one step of Newton's method.
#pragma once

#include "palpate/mechanism/constraint_set.hpp"
#include "palpate/mechanism/contact_rows.hpp"

#include <array>
#include <cstddef>

namespace palpate::runtime {

/// W = J K^-1 J^T + C + D of the rows, with contacts first, and their gaps and forces now.
template <int Handles, int MostRows>
class RowSystem {
  static constexpr std::size_t kHandles = static_cast<std::size_t>(Handles);
  static constexpr int kMost = MostRows + 3 * Handles;
  static constexpr auto kRows = static_cast<std::size_t>(kMost);

public:
  using Constraints = ConstraintSet<MostRows>;
  using Contacts = std::array<ContactRows, kHandles>;

  /// Returns null, or why the rows cannot be solved.
  const char* assemble(const HandleSet<Handles>& handles, Constraints& constraints, const Contacts& contacts) {
    number(constraints, contacts);
    set_levers(handles, constraints, contacts);
    for (int i = 0; i < rows_.size(); ++i) {
      for (int j = 0; j <= i; ++j) rows_.add_compliance(i, j, handles.compliance(lever_[i], lever_[j]));
    }
    for (std::size_t h = 0; h < kHandles; ++h) {
      if (first_[h] < 0) continue;
      for (int k = 0; k < 3; ++k) rows_.add_compliance(first_[h] + k, first_[h] + k, contacts[h].compliance[k]);
    }
    for (std::size_t i = 0; i < constraints.size(); ++i) {
      for (std::size_t j = 0; j <= i; ++j) add_bodies(handles, constraints, i, j);
    }
    for (std::size_t h = 0; h < kHandles; ++h) add_surface(handles, constraints, contacts, h);
    return rows_.prepare();
  }

  /// One step from the gaps and forces of constraints and contacts: the forces of all rows, kept by these, and the
  /// handles in balance with them. Nothing is kept of a solve that is not finite.
  RowsOutcome solve(HandleSet<Handles>& handles, Constraints& constraints, Contacts& contacts, int sweeps) {
    load(handles, contacts);
    constraints.load(handles, free_, force_);
    for (int i = 0; i < rows_.size(); ++i) free_[i] = handles.at_devices(lever_[i], free_[i]);
    const RowsOutcome outcome = rows_.solve(free_, force_, sweeps);
    if (!outcome.finite) return outcome;
    for (std::size_t h = 0; h < kHandles; ++h) {
      for (int k = 0; first_[h] >= 0 && k < 3; ++k) contacts[h].row[k] = force_[first_[h] + k];
    }
    constraints.store(force_);
    handles.balance(lever_, force_, rows_.size());
    return outcome;
  }

  /// m, world: displacement of the surface under contact h by the rows of all others.
  [[nodiscard]] Vec3 surface(std::size_t h) const {
    Vec3 sum;
    for (int i = 0; i < rows_.size(); ++i) sum = sum + force_[i] * surface_[h][static_cast<std::size_t>(i)];
    return sum;
  }

  [[nodiscard]] const Rows<kMost>& rows() const { return rows_; }

private:
  void number(Constraints& constraints, const Contacts& contacts) {
    rows_.clear();
    for (std::size_t h = 0; h < kHandles; ++h) {
      first_[h] = contacts[h].touching ? rows_.add_bilateral() : -1;
      for (int k = 1; contacts[h].touching && k < 3; ++k) rows_.add_bilateral();
    }
    contact_rows_ = rows_.size();
    constraints.add_rows(rows_);
  }

  void set_levers(const HandleSet<Handles>& handles, const Constraints& constraints, const Contacts& contacts) {
    for (std::size_t h = 0; h < kHandles; ++h) {
      if (first_[h] < 0) continue;
      const Vec3 at = handles[h].tool.apply(contacts[h].point);
      for (int k = 0; k < 3; ++k) {
        lever_[first_[h] + k] = handles.lever(static_cast<int>(h), -1, at, contacts[h].direction[k]);
      }
    }
    for (std::size_t i = 0; i < constraints.size(); ++i) {
      const Constraint& c = constraints[i];
      const Vec3 at = handles.position(c.b);
      for (int k = 0; k < 3; ++k) {
        if (!c.has_row(k)) continue;
        lever_[constraints.row(i, k)] = handles.lever(c.a.handle, c.b.handle, at, handles.direction(c, k));
      }
    }
  }

  /// m (world) by a unit force along `along` on `from`, at the same body's place `to`.
  [[nodiscard]] static Vec3 moved(const Side& from, const CompliancePoint& to, const Vec3& along) {
    if (from.place != &to) return from.body->displacement(*from.place, to, along);
    return from.body->pose.rotate(from.body->compliance.within(to, from.radius) * from.body->pose.unrotate(along));
  }

  /// C between two constraints.
  void add_bodies(const HandleSet<Handles>& handles, const Constraints& constraints, std::size_t i, std::size_t j) {
    const Constraint &to = constraints[i], &from = constraints[j];
    for (const Side* t : {&to.a, &to.b}) {
      for (const Side* f : {&from.a, &from.b}) {
        if (t->body == nullptr || t->body != f->body) continue;
        const double sign = (t == &to.a) == (f == &from.a) ? 1 : -1;
        for (int l = 0; l < 3; ++l) {
          if (!from.has_row(l)) continue;
          const Vec3 way = sign * moved(*f, *t->place, handles.direction(from, l));
          for (int k = 0; k < 3; ++k) {
            if (!to.has_row(k) || (i == j && l > k)) continue;
            rows_.add_compliance(constraints.row(i, k), constraints.row(j, l), dot(handles.direction(to, k), way));
          }
        }
      }
    }
  }

  /// C between contact h and all other rows, and how far each of these moves the surface under it.
  void add_surface(const HandleSet<Handles>& handles, const Constraints& constraints, const Contacts& contacts,
                   std::size_t h) {
    std::array<Vec3, kRows>& surface = surface_[h];
    surface.fill({});
    if (first_[h] < 0) return;
    const ContactRows& to = contacts[h];
    for (std::size_t m = 0; m < kHandles; ++m) {  // the body has the force of a tool with the other sign
      if (m == h || first_[m] < 0) continue;
      for (int k = 0; k < 3; ++k) {
        surface[static_cast<std::size_t>(first_[m] + k)] =
            -to.body->displacement(contacts[m].at, to.at, contacts[m].direction[k]);
      }
    }
    for (std::size_t i = 0; i < constraints.size(); ++i) {
      const Constraint& c = constraints[i];
      for (const Side* side : {&c.a, &c.b}) {
        if (side->body != to.body) continue;
        for (int k = 0; k < 3; ++k) {
          if (!c.has_row(k)) continue;
          Vec3& way = surface[static_cast<std::size_t>(constraints.row(i, k))];
          way = way + (side == &c.a ? 1.0 : -1.0) * moved(*side, to.at, handles.direction(c, k));
        }
      }
    }
    for (int j = 0; j < rows_.size(); ++j) {
      if (j >= first_[h] && j < contact_rows_) continue;  // each pair of two contacts once
      const Vec3& way = surface[static_cast<std::size_t>(j)];
      for (int k = 0; k < 3; ++k) rows_.add_compliance(first_[h] + k, j, -dot(to.direction[k], way));
    }
  }

  /// Forces of the contacts' rows now, and gaps less the way that D has from them.
  void load(const HandleSet<Handles>& handles, const Contacts& contacts) {
    for (std::size_t h = 0; h < kHandles; ++h) {
      if (first_[h] < 0) continue;
      const ContactRows& c = contacts[h];
      const Vec3 displaced = handles[h].tool.apply(c.point) - c.place;
      for (int k = 0; k < 3; ++k) {
        force_[first_[h] + k] = c.row[k];
        free_[first_[h] + k] = dot(c.direction[k], displaced) - c.compliance[k] * dot(c.direction[k], c.force);
      }
    }
  }

  Rows<kMost> rows_;
  Lever lever_[kRows];
  int first_[kHandles] = {};                                 ///< of each contact's rows, or -1
  int contact_rows_ = 0;                                     ///< of all contacts
  std::array<std::array<Vec3, kRows>, kHandles> surface_{};  ///< m/N, world: way of the surface at a contact
  double free_[kRows] = {}, force_[kRows] = {};
};

}  // namespace palpate::runtime
