// SPDX-License-Identifier: MIT
// Several contacts on one body, each in the dents of the others.
#pragma once

#include "palpate/shared/compliance.hpp"
#include "palpate/shared/contact_slope.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace palpate::runtime {

/// Constants of the balance of several contacts.
struct JointConstants {
  /// Most ticks of each contact in one tick; two suffice nearly always.
  static constexpr int kLooks = 8;
  /// Largest residual times a contact's slope over the largest force. A hand notices 7 %.
  static constexpr double kForceTolerance = 1e-3;
  /// Largest residual over a contact's size, for small forces.
  static constexpr double kPositionTolerance = 1e-5;
  /// Least pivot of I + K^1/2 C K^1/2: nearer to 0 two contacts would push each other out. It is reached when they lie
  /// two thirds of a contact radius apart.
  static constexpr double kLeastPivot = 0.1;
  /// Bisections of the share of C that keeps that pivot.
  static constexpr int kBisections = 6;
  /// Largest change of a displacement in one tick over a contact's size.
  static constexpr double kMostShift = 0.5;
};

/// Finds the displacements s of the surface at the contacts, by the forces of the others, in balance with these forces:
///
///     h_k s_k = sum over j of C(c_k, c_j) f_j(P_j + s_j) / h'(d_j)
///
///     C  the file's compliance (m/N)      P  poses of the tools      d  depths of the contacts (m)
///     f_j(x)  force of contact j alone with its tool at x (N)
///     h'  stretch of a depth (Compliance)      h_k  its mean between d_k and the tool's depth d_k + s_k . n_k
///
/// The body has the force of a tool with the other sign, so the dent of one adds to the way out of the other. The hand
/// has (f_k . n_k) h'(d_k + s_k . n_k) / h'(d_k) along the normal, the derivative of the energy. The equation is solved
/// by Newton's method with the slopes K of f / h', from a prediction by the tools' motions: each look ticks all
/// contacts from one state. C rests within a tick.
///
/// Energy. With f for f / h', with the trapezoid the work of the hands is what the contacts take and the change of
/// (1/2) f . C f, and (1/2) f . dC f where a contact slides. The last is negative where two contacts part. An account
/// holds what it was when they came nearer, and the work against the drag of the dents
///
///     g_k = d/dc_k sum over j of f_k . C(c_k, c_j) f_j
///
/// on a frictionless tool (the modes' part of it along the normals alone), or in a file with friction the work of the
/// slip. C changes by the share that the account covers.
template <int Count, std::uint32_t kFeatures>
class JointContacts {
  static constexpr std::size_t kCount = static_cast<std::size_t>(Count);
  static constexpr std::size_t kSize = 3 * kCount;

public:
  using Contacts = std::array<BasicContact<kFeatures>, kCount>;

  /// `view`: a file with layout::feature_compliance, which must outlive this.
  explicit JointContacts(const View& view)
      : view_(&view), compliance_(view), friction_(layout::has_friction(*view.meta)) {
    grip_.fill(1);
  }

  void reset() { *this = JointContacts(*view_); }

  /// One tick of all contacts. `tick_at(k, pose)`: the tick of contact k at a pose; `frame_of(at)`: the body's frame
  /// near a point of its surface.
  template <class TickAt, class FrameOf>
  std::array<Tick, kCount> tick(Contacts& contacts, const std::array<Pose, kCount>& tools, const TickAt& tick_at,
                                const FrameOf& frame_of) {
    begin(contacts, tools, frame_of);
    std::array<Tick, kCount> ticks;
    const auto look = [&] {
      ++looks_;
      const std::array<Vec3, kCount> force = force_;
      for (std::size_t k = 0; k < kCount; ++k) {
        Pose pose = tools[k];
        pose.translation = pose.translation + frame_of(at_[k]).rotate(shift_[k]);
        ticks[k] = tick_at(k, pose);
        const ContactState& state = contacts[k].state();
        const bool touches = ticks[k].touches();
        depth_[k] = touches ? state.indentation : 0;
        const double stretch = compliance_.stretch(depth_[k]), applied = touches ? length(state.applied.force) : 0;
        force_[k] = touches ? (1 / stretch) * state.applied.force : Vec3{};
        if (looks_ > 1) {
          slope_[k].n = state.place.normal;
          slope_[k].learn_grip(stretch * (shift_[k] - looked_[k]), force_[k] - force[k], grip_[k]);
        }
        slope_[k] = ContactSlope(contacts[k], grip_[k]).over_stretched(applied, stretch, compliance_.bend());
        looked_[k] = shift_[k];
      }
    };
    if (!coupled_) {
      look();
      meet(contacts, ticks);
    } else {
      const auto before = memories(contacts);
      for (;;) {
        look();
        if (forget_faults(ticks)) return reset(), ticks;
        meet(contacts, ticks);
        balanced_ = improve(contacts);
        if (balanced_ || looks_ == JointConstants::kLooks) break;
        restore(contacts, before);
      }
    }
    end(contacts, tools, frame_of, ticks);
    return ticks;
  }

  [[nodiscard]] int looks() const { return looks_; }         ///< ticks of each contact in the last tick
  [[nodiscard]] bool balanced() const { return balanced_; }  ///< the last tick found its balance
  [[nodiscard]] double share() const { return share_; }      ///< of C that was used, 1 where it was definite
  [[nodiscard]] const Vec3& shift(int k) const { return shift_[static_cast<std::size_t>(k)]; }  ///< m, body frame
  /// J that sliding contacts have put into the dents and not got back.
  [[nodiscard]] double account() const { return account_; }

private:
  [[nodiscard]] static std::size_t pair(std::size_t k, std::size_t j) { return k * kCount + j; }

  /// Takes up where contacts are now, and predicts the displacements of this tick.
  template <class FrameOf>
  void begin(const Contacts& contacts, const std::array<Pose, kCount>& tools, const FrameOf& frame_of) {
    looks_ = 0;
    balanced_ = true;
    int pressing = 0;
    for (std::size_t k = 0; k < kCount; ++k) pressing += contacts[k].state().touching;
    coupled_ = pressing > 0;
    if (!coupled_) {
      for (std::size_t k = 0; k < kCount; ++k) forget(k);
      account_ = 0;
      return;
    }
    std::array<Vec3, kCount> moved{};
    for (std::size_t k = 0; k < kCount; ++k) {
      if (!tools[k].valid()) {
        forget(k);
        continue;
      }
      const ContactState& state = contacts[k].state();
      // A tool that has left the body walks on over the surface, so that it comes back to the dented one.
      if (state.touching) {
        place(k, state.place.body_point);
        moved[k] = frame_of(at_[k]).unrotate(tools[k].apply(point_[k]) - last_[k].apply(point_[k]));
        continue;
      }
      grip_[k] = 1;
      if (known_[k]) {
        place(k, local_closest_point(*view_, at_[k], frame_of(at_[k]).unapply(tools[k].apply(point_[k]))));
      }
    }
    update();
    // The forces after the tools' motions, to first order.
    std::array<Vec3, kCount> force = force_;
    for (std::size_t k = 0; k < kCount; ++k) {
      force[k] = force[k] - slope_[k].times(compliance_.stretch(depth_[k]) * moved[k]);
    }
    step(contacts, residuals(force));
  }

  /// Leaves contact k out until it touches again.
  void forget(std::size_t k) {
    shift_[k] = force_[k] = drag_[k] = {};
    depth_[k] = 0;
    slope_[k] = {};
    grip_[k] = 1;
    known_[k] = false;
  }

  /// Forgets the contacts whose tick is a fault; true where all are, which a fault of the body makes.
  bool forget_faults(const std::array<Tick, kCount>& ticks) {
    std::size_t faults = 0;
    for (std::size_t k = 0; k < kCount; ++k) {
      if (ticks[k].state != State::fault) continue;
      forget(k);
      ++faults;
    }
    return faults == kCount;
  }

  void place(std::size_t k, const Location& here) {
    const bool rests = known_[k] && !(length(here.point - here_[k]) > 0);
    at_[k] = here.at;
    here_[k] = here.point;
    if (!rests) compliance_.locate(here.at, part_[k], friction_ ? nullptr : &slant_[k]);
    moved_[k] = !rests;
    known_[k] = true;
  }

  /// C at the places of now, as far as the account covers the change.
  void update() {
    bool any = false;
    for (std::size_t k = 0; k < kCount; ++k) any = any || (known_[k] && moved_[k]);
    if (!any) return;
    Matrix3 now[kCount * kCount];
    double change = 0;
    const auto each_moved = [this](const auto& act) {
      for (std::size_t k = 0; k < kCount; ++k) {
        for (std::size_t j = 0; j < k; ++j) {
          if (known_[k] && known_[j] && (moved_[k] || moved_[j])) act(k, j);
        }
      }
    };
    each_moved([&](std::size_t k, std::size_t j) {
      now[pair(k, j)] = between(k, j);
      change += dot(force_[k], now[pair(k, j)] * force_[j]) - dot(force_[k], used_[pair(k, j)] * force_[j]);
    });
    const double covered = change < 0 && account_ < -change ? account_ / -change : 1;
    each_moved([&](std::size_t k, std::size_t j) {
      Matrix3 c = used_[pair(k, j)];
      for (int r = 0; r < 3; ++r) c.row[r] = c.row[r] + covered * (now[pair(k, j)].row[r] - c.row[r]);
      use(k, j, c);
    });
    account_ = larger(0, account_ + covered * change);
  }

  /// A contact that began in this tick joins the others.
  void meet(const Contacts& contacts, const std::array<Tick, kCount>& ticks) {
    for (std::size_t k = 0; k < kCount; ++k) {
      if (!ticks[k].touches() || known_[k]) continue;
      point_[k] = contacts[k].state().applied.point;
      place(k, contacts[k].state().place.body_point);
      for (std::size_t j = 0; j < kCount; ++j) {
        if (j == k || !known_[j]) continue;
        const std::size_t later = k > j ? k : j, earlier = k > j ? j : k;
        use(later, earlier, between(later, earlier));
      }
    }
  }

  /// C between the places of tools j < k; keeps what their drags need of it.
  [[nodiscard]] Matrix3 between(std::size_t k, std::size_t j) {
    const Matrix3 half_space = compliance_.of_half_space(part_[j], part_[k]);
    if (!friction_) {
      half_space_[pair(k, j)] = half_space;
      tilt_[pair(k, j)] = compliance_.tilt(slant_[j], slant_[k]);
      tilt_[pair(j, k)] = compliance_.tilt(slant_[k], slant_[j]);
    }
    return compliance_.with_modes(half_space, part_[j], part_[k]);
  }
  void use(std::size_t k, std::size_t j, const Matrix3& c) {
    used_[pair(k, j)] = c;
    used_[pair(j, k)] = transposed(c);
  }

  /// m, by which the displacements over the stretched depths are short of those by the forces (N).
  [[nodiscard]] std::array<Vec3, kCount> residuals(const std::array<Vec3, kCount>& force) const {
    std::array<Vec3, kCount> residual{};
    for (std::size_t k = 0; k < kCount; ++k) {
      if (!known_[k]) continue;
      const double(&n)[3] = part_[k].place.normal;
      const double lift = dot(shift_[k], slope_[k].normal > 0 ? slope_[k].n : Vec3{n[0], n[1], n[2]});
      residual[k] = -compliance_.stretch(depth_[k] + 0.5 * lift) * shift_[k];
      for (std::size_t j = 0; j < kCount; ++j) {
        if (j != k && known_[j]) residual[k] = residual[k] + share_ * (used_[pair(k, j)] * force[j]);
      }
    }
    return residual;
  }

  /// True where the displacements are in balance with the forces; else improves them.
  bool improve(const Contacts& contacts) {
    const std::array<Vec3, kCount> residual = residuals(force_);
    double most = 0;
    for (const Vec3& f : force_) most = larger(most, length(f));
    bool good = true;
    for (std::size_t k = 0; k < kCount; ++k) {
      const double stiffness = larger(slope_[k].normal, slope_[k].across), off = length(residual[k]);
      good = good && (off * stiffness * stiffness <= JointConstants::kForceTolerance * most ||
                      off <= JointConstants::kPositionTolerance * contacts[k].size(contacts[k].state().indentation));
    }
    if (!good) step(contacts, residual);
    return good;
  }

  /// s += (I + C K)^-1 residual, with K = R R^T of all contacts: s += residual - C R y, (I + R^T C R) y = R^T residual.
  void step(const Contacts& contacts, const std::array<Vec3, kCount>& residual) {
    Vec3 column[kSize];     // sqrt(N/m), columns of R
    std::size_t of[kSize];  // the contact of each
    std::size_t size = 0;
    for (std::size_t k = 0; k < kCount; ++k) {
      for (int i = 0; i < slope_[k].columns(); ++i) {
        of[size] = k;
        column[size++] = slope_[k].column(i);
      }
    }
    double coupling[kSize][kSize];  // R^T C R; its part above the diagonal
    for (std::size_t b = 0; b < size; ++b) {
      Vec3 moved;
      for (std::size_t a = 0; a < b; ++a) {
        if (a == 0 || of[a] != of[a - 1]) moved = used_[pair(of[a], of[b])] * column[b];
        coupling[a][b] = of[a] == of[b] ? 0 : dot(column[a], moved);
      }
    }
    Factor factor;
    share_ = 1;
    if (!factor.make(coupling, size, share_)) {
      double low = 0, high = 1;
      for (int i = 0; i < JointConstants::kBisections; ++i) {
        const double middle = 0.5 * (low + high);
        (factor.make(coupling, size, middle) ? low : high) = middle;
      }
      share_ = low;
      factor.make(coupling, size, share_);
    }
    double y[kSize];
    for (std::size_t a = 0; a < size; ++a) y[a] = dot(column[a], residual[of[a]]);
    factor.solve(size, y);
    std::array<Vec3, kCount> change{};  // N, R y
    for (std::size_t a = 0; a < size; ++a) change[of[a]] = change[of[a]] + y[a] * column[a];
    for (std::size_t k = 0; k < kCount; ++k) {
      Vec3 ds = residual[k];
      for (std::size_t j = 0; j < kCount; ++j) {
        if (j != k && known_[k]) ds = ds - share_ * (used_[pair(k, j)] * change[j]);
      }
      const double reach = JointConstants::kMostShift * contacts[k].size(view_->meta->depth_scale), way = length(ds);
      shift_[k] = shift_[k] + ((way > reach ? reach / way : 1) / compliance_.stretch(depth_[k])) * ds;
    }
  }

  /// Factors of I + share coupling = L D L^T, of which `row` holds D L^T.
  struct Factor {
    double row[kSize][kSize];
    double inverse[kSize];  ///< of D

    /// False where a pivot is below kLeastPivot.
    bool make(const double (&coupling)[kSize][kSize], std::size_t size, double share) {
      for (std::size_t i = 0; i < size; ++i) {
        row[i][i] = 1;
        for (std::size_t j = i + 1; j < size; ++j) row[i][j] = share * coupling[i][j];
      }
      for (std::size_t k = 0; k < size; ++k) {
        if (!(row[k][k] >= JointConstants::kLeastPivot)) return false;
        inverse[k] = 1 / row[k][k];
        for (std::size_t i = k + 1; i < size; ++i) {
          const double factor = inverse[k] * row[k][i];
          for (std::size_t j = i; j < size; ++j) row[i][j] -= factor * row[k][j];
        }
      }
      return true;
    }
    void solve(std::size_t size, double (&y)[kSize]) const {
      for (std::size_t k = 0; k < size; ++k) {
        y[k] *= inverse[k];
        for (std::size_t i = k + 1; i < size; ++i) y[i] -= row[k][i] * y[k];
      }
      for (std::size_t k = size; k-- > 0;) {
        double sum = 0;
        for (std::size_t i = k + 1; i < size; ++i) sum += row[k][i] * y[i];
        y[k] -= inverse[k] * sum;
      }
    }
  };

  /// Adds the drag of the dents, books the work of the slip, and keeps the tools' poses.
  template <class FrameOf>
  void end(const Contacts& contacts, const std::array<Pose, kCount>& tools, const FrameOf& frame_of,
           std::array<Tick, kCount>& ticks) {
    const std::array<Vec3, kCount> drag = friction_ || !coupled_ ? std::array<Vec3, kCount>{} : drags(contacts);
    for (std::size_t k = 0; k < kCount; ++k) {
      Tick& tick = ticks[k];
      last_[k] = tools[k];
      if (!tick.touches()) {
        drag_[k] = {};
        continue;
      }
      const ContactState& state = contacts[k].state();
      const auto frame = frame_of(at_[k]);
      tick.tool_point = tick.tool_point - frame.rotate(shift_[k]);
      const Vec3 slid = known_[k] ? state.place.body_point.point - here_[k] : Vec3{};
      const Vec3 before = friction_ ? tangential(state.applied.force, state.place.normal) : drag_[k];
      drag_[k] = drag[k];
      const Vec3 after = friction_ ? before : drag_[k];
      if (coupled_) account_ += friction_ ? larger(0, -dot(after, slid)) : -0.5 * dot(before + after, slid);
      const Vec3& n = state.place.normal;
      const double more = compliance_.bend() * dot(shift_[k], n) / compliance_.stretch(depth_[k]);
      const Vec3 force = frame.rotate(drag_[k] + (more * dot(state.applied.force, n)) * n);
      tick.force = tick.force + force;
      tick.torque = tick.torque + cross(tick.tool_point - tools[k].translation, force);
      point_[k] = state.applied.point;
    }
    if (account_ < 0) account_ = 0;
  }

  /// g: what 1 / rho of the half-space gives, and the tilt by the modes.
  [[nodiscard]] std::array<Vec3, kCount> drags(const Contacts& contacts) const {
    std::array<Vec3, kCount> sum{};
    const double rounding = view_->compliance->rounding;
    for (std::size_t k = 0; k < kCount; ++k) {
      for (std::size_t j = 0; j < k; ++j) {
        if (!known_[k] || !known_[j]) continue;
        const Vec3 apart = here_[k] - here_[j];
        const double q = dot(force_[k], half_space_[pair(k, j)] * force_[j]);
        const Vec3 pull = (q / (dot(apart, apart) + rounding * rounding)) * apart;
        const Vec3 &n = contacts[k].state().place.normal, &m = contacts[j].state().place.normal;
        const double both = dot(force_[k], n) * dot(force_[j], m);
        sum[k] = sum[k] + share_ * tangential(both * tilt_[pair(k, j)] - pull, n);
        sum[j] = sum[j] + share_ * tangential(both * tilt_[pair(j, k)] + pull, m);
      }
    }
    return sum;
  }

  const View* view_;
  Compliance compliance_;
  bool friction_ = false;
  std::array<CompliancePoint, kCount> part_;
  std::array<ComplianceTilt, kCount> slant_;
  std::array<Matrix3, kCount * kCount> used_{};  ///< m/N, C of pairs
  std::array<Matrix3, kCount * kCount> half_space_{};  ///< m/N, the half-space's part of C at the places of now
  std::array<Vec3, kCount * kCount> tilt_{};           ///< 1/N, of the first of a pair by the second
  std::array<BodyPoint, kCount> at_;
  std::array<Vec3, kCount> here_{};   ///< m, points of at_
  std::array<Vec3, kCount> point_{};  ///< m, of the tool's frame, where the force last acted
  std::array<bool, kCount> known_{}, moved_{};
  std::array<double, kCount> depth_{};  ///< m, d
  std::array<Vec3, kCount> shift_{};    ///< m, s
  std::array<Vec3, kCount> looked_{};  ///< m, s of the last look
  std::array<double, kCount> grip_{};  ///< share of the tangential stiffness, learnt
  std::array<Vec3, kCount> force_{};   ///< N, f / h'
  std::array<Vec3, kCount> drag_{};    ///< N
  std::array<ContactSlope, kCount> slope_;
  std::array<Pose, kCount> last_;
  double share_ = 1, account_ = 0;
  int looks_ = 0;
  bool coupled_ = false, balanced_ = true;
};

}  // namespace palpate::runtime
