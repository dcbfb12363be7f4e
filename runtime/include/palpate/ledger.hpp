// SPDX-License-Identifier: MIT
// What a contact owes and pays: its account, kept as its parts move.
#pragma once

#include "palpate/energy.hpp"
#include "palpate/parts.hpp"
#include "palpate/strain.hpp"

#include <cmath>

namespace palpate::runtime {

/// Keeps the account (EnergyAccount) of a contact's parts, and, of a separable file with friction, that of the hand's
/// sideways work (StrainTally). Losses are of depth.
template <std::uint32_t kFeatures>
class BasicLedger {
  static constexpr bool kFriction = (kFeatures & layout::feature_friction) != 0;
  using Parts = BasicParts<kFeatures>;

public:
  explicit BasicLedger(const View& view) {
    if constexpr (kFriction) {
      rubs_ = view.has(layout::feature_friction);
      tallies_ = rubs_ && !view.coupled;
    }
  }

  void begin() {
    account_.reset();
    if constexpr (kFriction) tally_.reset();
  }

  /// There is friction.
  [[nodiscard]] bool rubs() const {
    if constexpr (kFriction) return rubs_;
    return false;
  }
  [[nodiscard]] double owed() const { return account_.owed(); }  ///< J
  [[nodiscard]] double lost() const { return account_.lost(); }  ///< J

  /// The tool's motion took the deflection there; it is not deepened yet.
  PALPATE_TICK_INLINE void move(const Deflection& d) {
    if constexpr (kFriction) {
      if (tallies()) tally_.move(d.sideways);
    }
  }
  /// After that, with the sideways force `pull` (N) of all and `core` of the core: owes what the hand got sideways in
  /// this tick and had not given. True where depth was lost for it.
  PALPATE_TICK_INLINE bool tell(Parts& parts, const Vec3& pull, const Vec3& core, Deflection& d, DepthTerms& terms) {
    if constexpr (kFriction) {
      if (!tallies()) return false;
      const double most = parts.most_strain(terms, d, pull, core);
      const double more = tally_.add(d.sideways, pull, parts.lean(terms, d), most);
      if (more > 0) return owe(parts, more, d, terms);
    }
    return false;
  }
  /// A slide is over, and all was told.
  void keep(const Parts& parts, const Vec3& pull, const Deflection& d, const DepthTerms& terms) {
    if constexpr (kFriction) {
      if (tallies()) tally_.keep(d.sideways, pull, parts.lean(terms, d), strain(parts, pull, d, terms));
    }
  }

  /// The hand did not give `more` (J) of what is stored. True where depth was lost for it.
  [[gnu::noinline]] bool owe(Parts& parts, double more, Deflection& d, DepthTerms& terms) {
    // A push of some power of the depth stores at least a fifth of this. By rounding alone nothing is owed: whether
    // anything is makes a difference that is felt.
    const double pushed = terms.normal_force * d.depth;
    if (!(more > 1e-12 * pushed)) return false;
    account_.owe(more);
    if (!(account_.owed() > 0.1 * pushed)) return false;
    const double now = parts.stored(terms, d), due = account_.too_much(now, more);
    if (due > 0) account_.held_back(now - lose(parts, now, due, d, terms));
    return due > 0;
  }

  /// What a lift loses of what is owed. False where no depth is left.
  [[gnu::noinline]] bool pay(Parts& parts, Deflection& d, DepthTerms& terms) {
    const double held = parts.stored(terms, d), due = account_.due(held),
                 left = due > 0 ? lose(parts, held, due, d, terms) : held;
    account_.paid(held - left, left);
    return d.depth > 0;
  }

  /// Has `slip` take of what is stored, where the tool is: it is no lift.
  template <class Slip>
  PALPATE_TICK_INLINE Vec3 rub(const Parts& parts, const Deflection& d, const DepthTerms& terms, const Slip& slip) {
    const bool owes = account_.owed() > 0;
    const double held = owes ? parts.stored(terms, d) : 0;
    const Vec3 pull = slip();
    if (owes) account_.replaced(held, parts.stored(terms, d), true, 0);
    return pull;
  }

  /// N of core and rim, of which `core` is known, where what the rim loses is told to nobody else. A coupled rim that
  /// slips in a fast motion was never stretched as far as it is without: that pays nothing.
  PALPATE_TICK_INLINE Vec3 rub_rim(Parts& parts, const Vec3& core, const Deflection& d, const DepthTerms& terms) {
    if (tallies()) {
      return rub(parts, d, terms, [&] { return parts.with_rim(core, d, terms); });
    }
    const Vec3 before = parts.rim_deflection(d), pull = parts.with_rim(core, d, terms);
    if (!(account_.owed() > 0)) return pull;
    const Vec3 slipped = before - parts.rim_deflection(d);
    if (dot(slipped, slipped) > 0) {
      account_.rubbed(parts.stored(terms, d.sideways, before), parts.stored(terms, d),
                      std::fmax(0, -dot(pull - parts.core_share() * core, slipped)));
    }
    return pull;
  }

  /// J that is stored before c or p goes elsewhere; replaced() is to follow.
  [[nodiscard]] double leave(const Parts& parts, const DepthTerms& terms, const Deflection& d) {
    if constexpr (kFriction) {
      if (tallies()) tally_.shift(-d.sideways, -parts.lean(terms, d));
    }
    return parts.stored(terms, d);
  }
  /// For the tool at q, which stood still; sets what is there now. True where depth was lost.
  PALPATE_TICK_INLINE bool replaced(Parts& parts, double left, const Vec3& q, Deflection& d, DepthTerms& terms) {
    parts.stand(q, d, terms);
    if constexpr (kFriction) {
      if (tallies()) tally_.shift(d.sideways, parts.lean(terms, d));
    }
    return replaced(parts, left, 0, d, terms);
  }

  /// N across n(c) before c slides, of what stretches the parts by `pull`, the core by `core`, and slips `to`. What a
  /// coupled law would answer beyond what friction holds, and store, was never there: it slipped on the way.
  [[nodiscard]] Vec3 bears(const Parts& parts, const Vec3& pull, const Vec3& core, const Slipped& to) const {
    return tallies() ? pull : parts.instead(pull, core, to.force);
  }
  /// Before c slides: J stored, at most by sideways deflections, and done by the body on the tool at its motion's end;
  /// the sideways force (N, bears()) and the way (m) of the slip.
  struct Slide {
    double held, strained, done;
    Vec3 pull, slipped;
  };
  /// After a motion by `way` (m).
  [[nodiscard]] PALPATE_TICK_INLINE Slide slides(const Parts& parts, const Slipped& to, const Vec3& pull,
                                                 const Vec3& way, const Deflection& d, const DepthTerms& terms) const {
    const double done = work(parts, terms, pull, way);
    if (!rubs() || tallies()) return {parts.stored(terms, d), strain(parts, pull, d, terms), done, pull, {}};
    return {parts.stored(terms, to.deflection, parts.rim_deflection(d)), 0, done, pull,
            parts.core_share() * (d.sideways - to.deflection)};
  }
  /// After it. Friction took of what the sideways deflections hold (of a coupled law as much as by the forces at the
  /// slip's end), and with the force that is left at the motion's end the hand gave less in it, too. True where depth
  /// was lost.
  PALPATE_TICK_INLINE bool slid(Parts& parts, const Slide& before, const Vec3& pull, const Vec3& way, Deflection& d,
                                DepthTerms& terms) {
    const double done = work(parts, terms, pull, way);
    double rubbed = before.done - done;
    if constexpr (kFriction) {
      rubbed += before.strained > 0 ? tally_.rub(strain(parts, pull, d, terms) / before.strained)
                                    : std::fmax(0, -0.5 * dot(before.pull + pull, before.slipped));
    }
    account_.told(before.held);
    if (!replaced(parts, before.held, rubbed, d, terms)) return false;
    // What the loss left of the force the hand gave less by, too.
    account_.owe(std::fmax(0, work(parts, terms, pull, way) - done));
    return true;
  }

  /// Newtons are `ratio` (above 0) times as large from now on.
  void rescale(double ratio) {
    account_.rescale(ratio);
    if constexpr (kFriction) tally_.rescale(ratio);
  }
  void rotate(const Pose& by) {
    if constexpr (kFriction) tally_.rotate(by);
  }

private:
  /// The sideways forces are no gradient, and what they hold is not in stored().
  [[nodiscard]] bool tallies() const {
    if constexpr (kFriction) return tallies_;
    return false;
  }
  [[nodiscard]] double strain(const Parts& parts, const Vec3& pull, const Deflection& d,
                              const DepthTerms& terms) const {
    return tallies() ? parts.most_strain(terms, d, pull, parts.has_rim() ? parts.core_force(d, terms) : pull) : 0;
  }
  /// J, of a force at one end of a way (m), by the rule of trapezoids.
  [[nodiscard]] double work(const Parts& parts, const DepthTerms& terms, const Vec3& pull, const Vec3& way) const {
    return 0.5 * dot(terms.normal_force * parts.field().normal() + pull, way);
  }

  /// `held` (J) was stored before, and `rubbed` (J) is what friction took and is not counted in that. True where depth
  /// was lost.
  PALPATE_TICK_INLINE bool replaced(Parts& parts, double held, double rubbed, Deflection& d, DepthTerms& terms) {
    const double now = parts.stored(terms, d), due = account_.replaced(held, now, rubs(), rubbed);
    if (due > 0) account_.held_back(now - lose(parts, now, due, d, terms));
    return due > 0;
  }

  /// Gives up about `due` (J) of the `held` (J) that is stored, by as much depth; returns what is left. Each time by
  /// what the present force would take, which falls with the depth: hardly too much, where the core is not stretched
  /// beyond what friction holds.
  double lose(Parts& parts, double held, double due, Deflection& d, DepthTerms& terms) {
    constexpr int kMostTimes = 3;
    constexpr double kNear = 0.1;  // of what is due, that may stay
    const double leant = tallies() ? parts.lean(terms, d) : 0, least = held - due;
    for (int k = 0; k < kMostTimes && d.depth > 0 && held - least > kNear * due; ++k) {
      const double way = std::fmin(d.depth, (held - least) / terms.normal_force);
      parts.rest().subtract_of(d, way);
      parts.field().set_depth(d.depth, terms);
      held = parts.stored(terms, d);
    }
    parts.set_depth(d.depth);
    if constexpr (kFriction) {
      if (tallies()) tally_.shift({}, parts.lean(terms, d) - leant);
    }
    return held;
  }

  EnergyAccount account_;
  detail::If<kFriction, bool> rubs_ = {}, tallies_ = {};
  detail::If<kFriction, StrainTally> tally_;
};

}  // namespace palpate::runtime
