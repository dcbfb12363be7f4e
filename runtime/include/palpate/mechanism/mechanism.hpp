// SPDX-License-Identifier: MIT
// Tools held by springs, joined to each other, to the ground and to bodies by constraints.
#pragma once

#include "palpate/body/rigid_motion.hpp"
#include "palpate/math/rotation.hpp"
#include "palpate/mechanism/constraint.hpp"
#include "palpate/mechanism/rows.hpp"
#include "palpate/shared/contact_slope.hpp"

#include <array>
#include <cmath>
#include <cstddef>

namespace palpate::runtime {

/// The spring between the hand's device and a tool without mass.
struct HandleSpring {
  double stiffness = 500;  ///< N/m, (0, 1e9]: upper bound of the stiffness that the hand feels
  double rotation = 1;     ///< N m/rad, [1e-3, 1e9]; 1e-3 for a device without torque: below, a contact spins the tool
  Vec3 grip;               ///< m, of the tool's frame, where the hand holds it

  /// Returns null, or the member that is out of range.
  [[nodiscard]] const char* validate() const {
    if (!(stiffness > 0 && stiffness <= 1e9)) return "stiffness of a handle is outside (0, 1e9] N/m";
    if (!(rotation >= 1e-3 && rotation <= 1e9)) {
      return "rotational stiffness of a handle is outside [1e-3, 1e9] N m/rad";
    }
    if (!finite(grip)) return "grip of a handle is not finite";
    return nullptr;
  }
};

struct MechanismOptions {
  int sweeps = 8;  ///< [1, 64] of each solve
  int every = 1;   ///< [1, 1000] ticks from one assembly of W and J to the next; gaps are those of every tick

  /// Returns null, or the option that is out of range.
  [[nodiscard]] const char* validate() const {
    if (!(sweeps >= 1 && sweeps <= 64)) return "sweeps of a mechanism are outside [1, 64]";
    if (!(every >= 1 && every <= 1000)) return "ticks between assemblies of a mechanism are outside [1, 1000]";
    return nullptr;
  }
};

/// Force and torque of a handle's spring on the hand.
struct HandleForce {
  Vec3 force;    ///< N
  Vec3 torque;   ///< N m, about the grip
  Pose tool;     ///< tool to world
  Tick contact;  ///< of the tool alone, where the mechanism has contacts
};

/// Constants of a mechanism.
struct MechanismConstants {
  /// Most ticks of each contact in one tick.
  static constexpr int kLooks = 8;
  /// Largest difference of a contact's force and its rows' over the largest force. A hand notices 7 %.
  static constexpr double kForceTolerance = 1e-3;
  /// Least slope of a contact over the stiffness of its handle: a contact that begins has none.
  static constexpr double kLeastSlope = 1e-6;
  /// Largest difference over the stiffness of the handle and a contact's size, for small forces.
  static constexpr double kPositionTolerance = 1e-5;
};

/// Rigid tools without mass, each on the spring of its handle, with constraints and with contacts against one baked
/// body. In every tick tools, springs, constraints and contacts are in balance:
///
///     J^T f = K u                    K  springs (N/m, N m/rad)       u  way from the device to the tool (m, rad)
///     gap = g(u) + C f               C  compliance of the bodies      f  forces of the rows (N)
///
/// with the law of each row (rows.hpp). The rows of a contact (n and two across it) have the force of its own tick; D
/// is the inverse of its slope. Newton's method gives one linear problem a look,
///
///     gap = r + W (f - f_now),       W = J K^-1 J^T + C + D,         r  gap now; for a contact D (f_now - F(u))
///
/// so that the gaps of a settled mechanism do not depend on W, which may be some ticks old. A mechanism without
/// contacts takes one look, which is exact for small motions; the next tick's r holds the gap that a large rotation
/// leaves. The tools have no mass and the springs are linear: a mechanism without friction stores the work of the
/// hands, and friction rows dissipate.
///
/// Not for several threads at once. `MostRows`: rows of all constraints, three more for each contact. No tick
/// allocates.
template <int Handles, int MostRows, std::uint32_t kFeatures = layout::feature_all>
class Mechanism {
  static constexpr std::size_t kHandles = static_cast<std::size_t>(Handles);
  static constexpr std::size_t kRows = static_cast<std::size_t>(MostRows);

public:
  using Contacts = std::array<BasicContact<kFeatures>, kHandles>;

  explicit Mechanism(const std::array<HandleSpring, kHandles>& springs, const MechanismOptions& options = {})
      : options_(options) {
    fault_ = options.validate();
    for (std::size_t h = 0; h < kHandles; ++h) {
      handle_[h].spring = springs[h];
      if (fault_ == nullptr) fault_ = springs[h].validate();
    }
  }

  /// Null, or why every tick is without force: an option out of range.
  [[nodiscard]] const char* validate() const { return fault_; }

  /// Adds a constraint, with the forces that it carries, and returns its index; -1 where it has no room or a wrong
  /// member. It acts from the next tick on.
  int add(const Constraint& constraint) {
    int rows = 0;
    for (const RowKind kind : constraint.kind) rows += kind == RowKind::contact ? 3 : kind != RowKind::none;
    const bool known = constraint.a.handle < Handles && constraint.b.handle < Handles;
    if (count_ == kRows || row_count_ + rows > MostRows || !known) return -1;
    constraint_[count_] = constraint;
    row_count_ += rows;
    changed_ = true;
    return static_cast<int>(count_++);
  }
  template <std::size_t N>
  bool add(const std::array<Constraint, N>& joint) {
    bool all = true;
    for (const Constraint& c : joint) all = add(c) >= 0 && all;
    return all;
  }
  /// Removes all constraints. The tools stay.
  void clear() {
    count_ = 0;
    row_count_ = 0;
    changed_ = true;
  }
  [[nodiscard]] int count() const { return static_cast<int>(count_); }
  [[nodiscard]] const Constraint& constraint(int i) const { return constraint_[static_cast<std::size_t>(i)]; }

  /// One tick without contacts. `devices`: poses of the hands' tools, in the world.
  std::array<HandleForce, kHandles> tick(const std::array<Pose, kHandles>& devices) {
    begin(devices);
    for (ContactRows& c : contact_) {
      changed_ = changed_ || c.touching;
      c = {};
    }
    solve();
    looks_ = 1;
    balanced_ = true;
    return forces();
  }

  /// One tick in which tool h has contacts[h] against `body`.
  std::array<HandleForce, kHandles> tick(const std::array<Pose, kHandles>& devices, Contacts& contacts,
                                         const CompliantBody& body) {
    begin(devices);
    const Contacts before = contacts;
    std::array<Tick, kHandles> ticks;
    for (looks_ = 1;; ++looks_) {
      solve();
      if (looks_ > 1) contacts = before;
      balanced_ = look(contacts, body, ticks);
      if (balanced_ || looks_ == MechanismConstants::kLooks) break;
    }
    auto result = forces();
    for (std::size_t h = 0; h < kHandles; ++h) result[h].contact = ticks[h];
    return result;
  }

  [[nodiscard]] const RowsOutcome& outcome() const { return outcome_; }  ///< of the last solve
  [[nodiscard]] int looks() const { return looks_; }                     ///< ticks of each contact in the last tick
  [[nodiscard]] bool balanced() const { return balanced_; }              ///< the contacts found their balance
  /// Why the rows of the last tick could not be solved, or null. The tools are at their devices then.
  [[nodiscard]] const char* cause() const { return cause_; }

private:
  struct Handle {
    HandleSpring spring;
    Pose device, tool;
    Vec3 shift, turn;    ///< m and rad (rotation vector): way from device to tool, of the grip
    Vec3 force, torque;  ///< N and N m about the grip, of the rows on the tool
    Vec3 grip() const { return tool.apply(spring.grip); }
    void place() {
      tool = rotation_pose(turn) * device;
      tool.translation = device.apply(spring.grip) + shift - tool.rotate(spring.grip);
    }
  };
  /// Rows of a contact: its state at the last look.
  struct ContactRows {
    bool touching = false;
    Vec3 point;            ///< m, of the tool's frame, where the force acts
    Vec3 place;            ///< m, world: this point less the surface's displacement
    Vec3 force;            ///< N, world, on the tool
    Vec3 direction[3];     ///< n and two across it, world
    Vec3 row;              ///< N, forces of the rows
    double compliance[3];  ///< m/N, D
    double grip = 1;       ///< share of the tangential stiffness, learnt
    ContactSlope slope;
    const CompliantBody* body = nullptr;
    CompliancePoint at;  ///< c
  };
  /// J of one row at its assembly: way of its gap per motion of the (up to two) handles.
  struct Lever {
    int handle[2] = {-1, -1};
    Vec3 force[2], torque[2];
  };

  void begin(const std::array<Pose, kHandles>& devices) {
    bool valid = fault_ == nullptr;
    for (const Pose& pose : devices) valid = valid && pose.valid();
    usable_ = valid;
    cause_ = fault_;
    if (!valid && fault_ == nullptr) cause_ = "a pose is not finite, not a rotation within 1e-3, or beyond 1e6 m";
    for (std::size_t h = 0; valid && h < kHandles; ++h) {
      handle_[h].device = devices[h];
      handle_[h].place();
    }
    if (++since_ >= options_.every) changed_ = true;
  }

  // --- rows ---

  [[nodiscard]] Vec3 position(const Side& side) const {
    return side.handle >= 0 ? handle_[static_cast<std::size_t>(side.handle)].tool.apply(side.point) : side.point;
  }
  [[nodiscard]] Vec3 direction(const Constraint& c, int k) const {
    if (c.frame == DirectionFrame::line) return unit(position(c.b) - position(c.a), c.direction[k]);
    const bool turns = c.frame == DirectionFrame::tool && c.a.handle >= 0;
    return turns ? handle_[static_cast<std::size_t>(c.a.handle)].tool.rotate(c.direction[k]) : c.direction[k];
  }

  /// Calls see(constraint, k, kind) for the rows in their order: bilateral rows first.
  template <class See>
  void for_rows(const See& see) {
    for (const bool bilateral : {true, false}) {
      for (std::size_t i = 0; i < count_; ++i) {
        for (int k = 0; k < 3; ++k) {
          const RowKind kind = constraint_[i].kind[k];
          if (kind != RowKind::none && (kind == RowKind::bilateral) == bilateral) see(i, k, kind);
          if (kind == RowKind::contact) break;
        }
      }
    }
  }

  void number() {
    rows_.clear();
    for (std::size_t h = 0; h < kHandles; ++h) {
      contact_row_[h] = contact_[h].touching ? rows_.add_bilateral() : -1;
      for (int k = 1; contact_[h].touching && k < 3; ++k) rows_.add_bilateral();
    }
    contact_rows_ = rows_.size();
    for_rows([&](std::size_t i, int k, RowKind kind) {
      const double limit = constraint_[i].limit;
      if (kind == RowKind::bilateral) index_[i][k] = rows_.add_bilateral();
      if (kind == RowKind::unilateral) index_[i][k] = rows_.add_limited(0, HUGE_VAL);
      if (kind == RowKind::friction) index_[i][k] = rows_.add_limited(-limit, limit);
      if (kind == RowKind::contact) {
        for (int j = 0, first = rows_.add_contact(limit); j < 3; ++j) index_[i][j] = first + j;
      }
    });
  }

  void set_levers() {
    for (std::size_t h = 0; h < kHandles; ++h) {
      if (contact_row_[h] < 0) continue;
      const Vec3 at = handle_[h].tool.apply(contact_[h].point);
      for (int k = 0; k < 3; ++k) {
        lever_[contact_row_[h] + k] = lever(static_cast<int>(h), -1, at, contact_[h].direction[k]);
      }
    }
    for (std::size_t i = 0; i < count_; ++i) {
      const Constraint& c = constraint_[i];
      const Vec3 at = position(c.b);
      for (int k = 0; k < 3; ++k) {
        if (has_row(c, k)) lever_[index_[i][k]] = lever(c.a.handle, c.b.handle, at, direction(c, k));
      }
    }
  }
  [[nodiscard]] static bool has_row(const Constraint& c, int k) {
    return c.kind[k] != RowKind::none || c.kind[0] == RowKind::contact;
  }

  [[nodiscard]] Lever lever(int a, int b, const Vec3& at, const Vec3& along) const {
    Lever l;
    const int sides[2] = {a, b};
    for (int s = 0; s < 2; ++s) {
      if (sides[s] < 0) continue;
      l.handle[s] = sides[s];
      l.force[s] = (s == 0 ? 1.0 : -1.0) * along;
      l.torque[s] = cross(at - handle_[static_cast<std::size_t>(sides[s])].grip(), l.force[s]);
    }
    return l;
  }

  /// The part of W between two rows that the springs of their handles give.
  [[nodiscard]] double through_handles(const Lever& a, const Lever& b) const {
    double sum = 0;
    for (int s = 0; s < 2; ++s) {
      for (int t = 0; t < 2; ++t) {
        if (a.handle[s] < 0 || a.handle[s] != b.handle[t]) continue;
        const HandleSpring& spring = handle_[static_cast<std::size_t>(a.handle[s])].spring;
        sum += dot(a.force[s], b.force[t]) / spring.stiffness + dot(a.torque[s], b.torque[t]) / spring.rotation;
      }
    }
    return sum;
  }

  /// m (world) by a unit force along `along` on `from`, at the same body's place `to`.
  [[nodiscard]] static Vec3 moved(const Side& from, const CompliancePoint& to, const Vec3& along) {
    if (from.place != &to) return from.body->displacement(*from.place, to, along);
    return from.body->pose.rotate(from.body->compliance.within(to, from.radius) * from.body->pose.unrotate(along));
  }

  void assemble() {
    number();
    set_levers();
    for (int i = 0; i < rows_.size(); ++i) {
      for (int j = 0; j <= i; ++j) rows_.add_compliance(i, j, through_handles(lever_[i], lever_[j]));
    }
    for (std::size_t h = 0; h < kHandles; ++h) {
      if (contact_row_[h] < 0) continue;
      for (int k = 0; k < 3; ++k) {
        rows_.add_compliance(contact_row_[h] + k, contact_row_[h] + k, contact_[h].compliance[k]);
      }
    }
    add_bodies();
    cause_ = rows_.prepare();
    since_ = 0;
    changed_ = false;
  }

  /// The compliance of the bodies between all rows, and how far each row moves the surface at each contact.
  void add_bodies() {
    for (std::size_t i = 0; i < count_; ++i) {
      for (std::size_t j = 0; j <= i; ++j) add_bodies(i, j);
    }
    for (std::size_t h = 0; h < kHandles; ++h) {
      for (Vec3& way : surface_[h]) way = {};
      if (contact_row_[h] < 0) continue;
      const ContactRows& to = contact_[h];
      for (std::size_t m = 0; m < kHandles; ++m) {  // the body has the force of a tool with the other sign
        if (m == h || contact_row_[m] < 0) continue;
        for (int k = 0; k < 3; ++k) {
          const Vec3& along = contact_[m].direction[k];
          surface_[h][contact_row_[m] + k] = -to.body->displacement(contact_[m].at, to.at, along);
        }
      }
      for (std::size_t i = 0; i < count_; ++i) {
        const Constraint& c = constraint_[i];
        for (const Side* side : {&c.a, &c.b}) {
          if (side->body != to.body) continue;
          for (int k = 0; k < 3; ++k) {
            if (!has_row(c, k)) continue;
            Vec3& way = surface_[h][index_[i][k]];
            way = way + (side == &c.a ? 1.0 : -1.0) * moved(*side, to.at, direction(c, k));
          }
        }
      }
      for (int j = 0; j < rows_.size(); ++j) {
        if (j >= contact_row_[h] && j < contact_rows_) continue;  // each pair of two contacts once
        for (int k = 0; k < 3; ++k) {
          rows_.add_compliance(contact_row_[h] + k, j, -dot(to.direction[k], surface_[h][j]));
        }
      }
    }
  }

  void add_bodies(std::size_t i, std::size_t j) {
    const Constraint &to = constraint_[i], &from = constraint_[j];
    for (const Side* t : {&to.a, &to.b}) {
      for (const Side* f : {&from.a, &from.b}) {
        if (t->body == nullptr || t->body != f->body) continue;
        const double sign = (t == &to.a) == (f == &from.a) ? 1 : -1;
        for (int l = 0; l < 3; ++l) {
          if (!has_row(from, l)) continue;
          const Vec3 way = sign * moved(*f, *t->place, direction(from, l));
          for (int k = 0; k < 3; ++k) {
            if (!has_row(to, k) || (i == j && l > k)) continue;
            rows_.add_compliance(index_[i][k], index_[j][l], dot(direction(to, k), way));
          }
        }
      }
    }
  }

  // --- one look ---

  /// Newton's step: forces of all rows, then the tools.
  void solve() {
    if (!usable_) return release();
    if (changed_) assemble();
    if (cause_ != nullptr) return release();
    const int size = rows_.size();
    load();
    for (int i = 0; i < size; ++i) {
      for (int s = 0; s < 2; ++s) {
        if (lever_[i].handle[s] < 0) continue;
        const Handle& h = handle_[static_cast<std::size_t>(lever_[i].handle[s])];
        free_[i] -= dot(lever_[i].force[s], h.shift) + dot(lever_[i].torque[s], h.turn);
      }
    }
    outcome_ = rows_.solve(free_, row_force_, options_.sweeps);
    if (!outcome_.finite) {
      cause_ = "forces of the rows are not finite";
      return release();
    }
    store();
    move();
  }

  /// Forces now, and gaps less the way that C and D have from them.
  void load() {
    for (std::size_t h = 0; h < kHandles; ++h) {
      if (contact_row_[h] < 0) continue;
      const ContactRows& c = contact_[h];
      const Vec3 displaced = handle_[h].tool.apply(c.point) - c.place;
      for (int k = 0; k < 3; ++k) {
        const double own = k == 0 ? c.row.x : k == 1 ? c.row.y : c.row.z;
        row_force_[contact_row_[h] + k] = own;
        free_[contact_row_[h] + k] = dot(c.direction[k], displaced) - c.compliance[k] * dot(c.direction[k], c.force);
      }
    }
    for (std::size_t i = 0; i < count_; ++i) {
      Constraint& c = constraint_[i];
      const Vec3 apart = position(c.a) - position(c.b);
      double gap[3];
      for (int k = 0; k < 3; ++k) gap[k] = has_row(c, k) ? dot(direction(c, k), apart) + c.offset[k] : 0;
      if (!c.begun) begin_rows(c, gap);
      for (int k = 0; k < 3; ++k) {
        if (!has_row(c, k)) continue;
        row_force_[index_[i][k]] = c.force[k];
        free_[index_[i][k]] = gap[k] + (k == 0 ? c.late : 0);
      }
    }
  }

  static void begin_rows(Constraint& c, double (&gap)[3]) {
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

  void store() {
    for (std::size_t h = 0; h < kHandles; ++h) {
      const int first = contact_row_[h];
      if (first >= 0) contact_[h].row = {row_force_[first], row_force_[first + 1], row_force_[first + 2]};
    }
    for (std::size_t i = 0; i < count_; ++i) {
      for (int k = 0; k < 3; ++k) {
        if (has_row(constraint_[i], k)) constraint_[i].force[k] = row_force_[index_[i][k]];
      }
    }
  }

  /// Puts the tools where springs and rows are in balance.
  void move() {
    for (Handle& h : handle_) h.force = h.torque = {};
    for (int i = 0; i < rows_.size(); ++i) {
      for (int s = 0; s < 2; ++s) {
        if (lever_[i].handle[s] < 0) continue;
        Handle& h = handle_[static_cast<std::size_t>(lever_[i].handle[s])];
        h.force = h.force + row_force_[i] * lever_[i].force[s];
        h.torque = h.torque + row_force_[i] * lever_[i].torque[s];
      }
    }
    for (Handle& h : handle_) {
      h.shift = (1 / h.spring.stiffness) * h.force;
      h.turn = (1 / h.spring.rotation) * h.torque;
      h.place();
    }
  }

  /// No forces: the tools are at their devices.
  void release() {
    outcome_ = {HUGE_VAL, false};
    for (Handle& h : handle_) {
      h.force = h.torque = h.shift = h.turn = {};
      if (usable_) h.place();
    }
    for (ContactRows& c : contact_) c = {};
    for (std::size_t i = 0; i < count_; ++i) {
      for (double& f : constraint_[i].force) f = 0;
    }
    changed_ = true;
  }

  /// Ticks the contacts where the tools are. True where their forces are those of their rows.
  bool look(Contacts& contacts, const CompliantBody& body, std::array<Tick, kHandles>& ticks) {
    bool good = true;
    double most = 0;
    for (std::size_t h = 0; h < kHandles; ++h) {
      ContactRows& c = contact_[h];
      Vec3 surface;
      for (int i = 0; c.touching && i < rows_.size(); ++i) surface = surface + row_force_[i] * surface_[h][i];
      Pose pose = handle_[h].tool;
      pose.translation = pose.translation - surface;
      ticks[h] = contacts[h].tick(pose, RigidMotion{body.view, body.pose});
      const ContactState& state = contacts[h].state();
      const bool touches = ticks[h].touches();
      const Vec3 force = touches ? body.pose.rotate(state.applied.force) : Vec3{};
      const Vec3 place = pose.apply(c.point);
      if (c.touching && touches && looks_ > 1) {
        c.slope.learn_grip(body.pose.unrotate(place - c.place), body.pose.unrotate(force - c.force), c.grip);
      }
      Vec3 rows;
      for (int k = 0; c.touching && k < 3; ++k) {
        rows = rows + (k == 0 ? c.row.x : k == 1 ? c.row.y : c.row.z) * c.direction[k];
      }
      most = larger(most, larger(length(force), length(rows)));
      const double size = contacts[h].size(body.view->meta->depth_scale);
      error_[h] = length(force - rows) - MechanismConstants::kPositionTolerance * size * handle_[h].spring.stiffness;
      changed_ = changed_ || touches || c.touching;
      if (!touches) {
        c = {};
        continue;
      }
      c.touching = true;
      c.body = &body;
      c.point = state.applied.point;
      c.place = pose.apply(c.point);
      c.force = force;
      c.slope = ContactSlope(contacts[h], c.grip);
      body.compliance.locate(state.place.body_point.at, c.at);
      c.direction[0] = body.pose.rotate(state.place.normal);
      c.direction[1] = any_orthogonal(c.direction[0]);
      c.direction[2] = cross(c.direction[0], c.direction[1]);
      c.row = {dot(c.direction[0], rows), dot(c.direction[1], rows), dot(c.direction[2], rows)};
      const double least = MechanismConstants::kLeastSlope * handle_[h].spring.stiffness;
      const double across = larger(least, c.slope.across * c.slope.across);
      c.compliance[0] = 1 / larger(least, c.slope.normal * c.slope.normal);
      c.compliance[1] = c.compliance[2] = 1 / across;
    }
    for (const double error : error_) good = good && error <= MechanismConstants::kForceTolerance * most;
    return good;
  }

  /// The forces on the hands. Friction rows at their limit slip, and late rows that open have their gap.
  std::array<HandleForce, kHandles> forces() {
    for (std::size_t i = 0; cause_ == nullptr && i < count_; ++i) slip(i);
    std::array<HandleForce, kHandles> result;
    for (std::size_t h = 0; h < kHandles; ++h) result[h] = {handle_[h].force, handle_[h].torque, handle_[h].tool, {}};
    return result;
  }
  void slip(std::size_t i) {
    Constraint& c = constraint_[i];
    constexpr double kAtLimit = 1 - 1e-9;
    for (int k = 0; k < 3; ++k) {
      if (c.kind[k] == RowKind::friction && std::fabs(c.force[k]) >= kAtLimit * c.limit) {
        c.offset[k] -= rows_.gap(index_[i][k]);
      }
    }
    if (c.late > 0 && !(c.force[0] > 0)) c.late = larger(0, c.late - rows_.gap(index_[i][0]));
    if (c.kind[0] != RowKind::contact) return;
    const double limit = c.limit * c.force[0];
    if (c.force[1] * c.force[1] + c.force[2] * c.force[2] < kAtLimit * kAtLimit * limit * limit) return;
    for (int k = 1; k < 3; ++k) c.offset[k] -= rows_.gap(index_[i][k]);
  }

  MechanismOptions options_;
  const char* fault_ = nullptr;
  std::array<Handle, kHandles> handle_;
  std::array<ContactRows, kHandles> contact_;
  std::array<Constraint, kRows> constraint_;
  std::size_t count_ = 0;
  int row_count_ = 0;
  // Rows of the last assembly.
  Rows<MostRows + 3 * Handles> rows_;
  Lever lever_[kRows + 3 * kHandles];
  int index_[kRows][3] = {};
  int contact_row_[kHandles] = {}, contact_rows_ = 0;
  Vec3 surface_[kHandles][kRows + 3 * kHandles];  ///< m/N, world: way of the surface at a contact
  bool changed_ = true, usable_ = false;
  int since_ = 0;
  // The last tick.
  double free_[kRows + 3 * kHandles] = {}, row_force_[kRows + 3 * kHandles] = {};
  double error_[kHandles] = {};  ///< N, of the contacts' forces beyond the tolerance of a position
  RowsOutcome outcome_;
  const char* cause_ = nullptr;
  int looks_ = 0;
  bool balanced_ = true;
};

}  // namespace palpate::runtime
