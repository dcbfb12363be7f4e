// SPDX-License-Identifier: MIT
// Core and rim of a contact: what they push and hold, and how slips, deepening and lifts move their anchors.
#pragma once

#include "palpate/inner.hpp"
#include "palpate/rest.hpp"
#include "palpate/rim.hpp"
#include "palpate/slip.hpp"

#include <cmath>

namespace palpate::runtime {

/// Where a contact lies (BasicRest) and its parts there (BasicRim), of which one is all where the file has no rim. Of a
/// tick's deflection and the terms of its depth.
template <std::uint32_t kFeatures>
class BasicParts {
  static constexpr bool kFriction = (kFeatures & layout::feature_friction) != 0;

public:
  static constexpr int kMostSlips = 8;  ///< of one part in a tick

  BasicParts(const View& view, std::uint32_t tool) : view_(&view), rest_(view, tool), rim_(view) {}

  /// Begins as BasicRest does.
  void begin(const ToolTouch& touch, const FirstTouch& first, const Pose& pose) {
    rest_.begin(touch, first, pose);
    rim_.leave({}, {});
    let_go();
  }

  [[nodiscard]] BasicRest<kFeatures>& rest() { return rest_; }
  [[nodiscard]] const BasicRest<kFeatures>& rest() const { return rest_; }
  [[nodiscard]] const BasicField<kFeatures>& field() const { return rest_.field(); }
  [[nodiscard]] bool has_rim() const { return rim_.present(); }
  /// m, in the last tick.
  [[nodiscard]] double depth() const { return depth_; }
  void set_depth(double depth) { depth_ = depth; }
  /// The tick ends there.
  void end(const Deflection& d, const DepthTerms& terms) {
    depth_ = d.depth;
    field().remember(terms);
  }

  /// N of the core across n(c), its part of the straight push included.
  [[nodiscard]] PALPATE_TICK_INLINE Vec3 core(const Deflection& d, const DepthTerms& terms) const {
    return straight_of_core(terms) + field().sideways(terms, d.sideways);
  }
  /// The same out of line, for ticks that slide.
  [[nodiscard, gnu::noinline]] Vec3 core_force(const Deflection& d, const DepthTerms& terms) const {
    return core(d, terms);
  }
  /// N of core and rim, of which `core` is known. The rim gives way first.
  [[nodiscard, gnu::noinline]] Vec3 with_rim(const Vec3& core, const Deflection& d, const DepthTerms& terms) {
    const Slips rim = slips(Part::rim, terms);
    Vec3 e = d.sideways, pull = core - (rim_.core_limit() - rim_.limit()) * terms.straight;
    if (rim_.apart()) {
      e = rim_deflection(d);
      pull = rim.straight + field().sideways(terms, e, Part::rim);
    }
    if (length(pull - rim.centre) > rim.limit) {
      const Vec3 before = e;
      // Once, but after a leap: where the force across its line is more than friction holds, it goes on that way.
      for (int turn = 0; turn < kMostSlips && length(pull - rim.centre) > rim.limit; ++turn) {
        const Slipped to = slip(field(), terms, rim, e, pull);
        e = to.holds ? to.deflection : d.sideways;
        pull = to.holds ? to.force : rim.straight + field().sideways(terms, e, Part::rim);
      }
      rim_.leave(d.sideways, e);
      note_slip(Part::rim, before, e);
    }
    return rim_.mean(core, pull);
  }

  /// N of the core's sideways force that friction bears.
  [[nodiscard]] PALPATE_TICK_INLINE Vec3 friction(const Vec3& core, const DepthTerms& terms) const {
    return core - centre(terms);
  }
  /// N that it holds.
  [[nodiscard]] double limit(const DepthTerms& terms) const { return rim_.core_limit() * terms.limit; }

  /// The core's of a contact that slides: it comes to rest at its limit, or so near above that it is taken for that.
  [[nodiscard]] Vec3 at_limit(const Vec3& core, const DepthTerms& terms) const {
    return within_limit(core, centre(terms), limit(terms));
  }

  /// m, sideways, of the rim.
  [[nodiscard]] Vec3 rim_deflection(const Deflection& d) const { return rim_.deflection(d.sideways, field().normal()); }

  /// From now on the rim's, where the core's is that of d.
  void leave_rim(const Deflection& d, const Vec3& deflection) { rim_.leave(d.sideways, deflection); }

  /// Moves the core's anchor so that this much of its sideways deflection is left; the rim's stays where it is.
  void leave_core(Deflection& d, const Vec3& kept) {
    const Vec3 rim = rim_deflection(d);
    rest_.leave(d, kept);
    leave_rim(d, rim);
  }

  /// A part of the contact slipped, from one deflection (m) to another.
  void note_slip(Part part, const Vec3& from, const Vec3& to) {
    if (!rest_.relief().present()) return;
    const bool rim = part == Part::rim;
    rest_.relief().slip((rim ? rim_.share() : core_share()) * length(from - to),
                        length(to) / (rim ? rim_.limit() : rim_.core_limit()));
  }

  /// The core's sideways deflection at which friction holds, where its `pull` (N) is more than it does.
  [[nodiscard]] Slipped slipped(const Deflection& d, const DepthTerms& terms, const Vec3& pull, bool at_once,
                                bool nearly = false) const {
    Slips what = slips(Part::core, terms);
    what.at_once = at_once;
    what.nearly = nearly;
    return slip(field(), terms, what, d.sideways, pull);
  }

  /// Adds what the sideways deflections do to the normal force; `across` is the whole sideways force (N).
  void couple(DepthTerms& terms, const Deflection& d, const Vec3& across) const {
    if (!rim_.present()) return field().couple(terms, d.sideways, across);
    field().couple(terms, {d.sideways, rim_deflection(d)}, {1 - rim_.share(), rim_.share()},
                   {rim_.core_limit(), rim_.limit()});
  }

  /// J in the present field.
  [[nodiscard]] double stored(const Deflection& d) const { return stored(field().energy_terms(d.depth), d); }
  [[nodiscard]] PALPATE_TICK_INLINE double stored(const DepthTerms& terms, const Deflection& d) const {
    return stored(terms, d.sideways, rim_.present() ? rim_deflection(d) : Vec3{});
  }
  /// The same of the deflections (m, sideways) of core and rim.
  [[nodiscard]] PALPATE_TICK_INLINE double stored(const DepthTerms& terms, const Vec3& of_core,
                                                  const Vec3& of_rim) const {
    const double core = field().stored(terms, of_core, rim_.core_limit());
    return rim_.present() ? rim_.mean(core, field().stored(terms, of_rim, rim_.limit())) : core;
  }
  /// Of the whole, that is the core.
  [[nodiscard]] double core_share() const { return 1 - rim_.share(); }
  /// N of the parts, which push with `pull`, when the core pushes with `force` instead of `core`.
  [[nodiscard]] Vec3 instead(const Vec3& pull, const Vec3& core, const Vec3& force) const {
    return pull + core_share() * (force - core);
  }

  /// The anchor rule: sideways motion has been added to the effective deflection; going deeper moves its anchor, and
  /// lifting what was pushed down after a lift moves it back.
  void deepen(const Vec3& way, Deflection& d, const DepthTerms& terms) {
    if constexpr (kFriction) {
      // A hand that trembles is slow.
      if (inner_.core.known() && !rest_.slow(dot(way, way))) let_go();
      if (d.depth > depth_ || !(depth_ > 0)) {
        if (inner_.lifts) turn(d);
        deeper(d, terms);
      } else if (d.depth < depth_) {
        inner_.lifts = true;
        if (inner_.core.known()) lift(d, terms);
      }
    }
    depth_ = d.depth;
  }
  /// What slides bears no more than its limit anywhere.
  void let_go() {
    if constexpr (kFriction) {
      inner_.lifts = false;
      inner_.core.forget();
      inner_.rim.forget();
    }
  }

  /// Deflection of the tool at q, and its terms.
  void stand(const Vec3& q, Deflection& d, DepthTerms& terms) const {
    d = rest_.deflection(q);
    field().set_depth(d.depth, terms);
  }

  /// J that the straight push's sideways force holds, as in stored() of a separable file.
  [[nodiscard]] double lean(const DepthTerms& terms, const Deflection& d) const {
    const double core = -rim_.core_limit() * dot(terms.straight, d.sideways);
    return rim_.present() ? rim_.mean(core, -rim_.limit() * dot(terms.straight, rim_deflection(d))) : core;
  }

  /// J that the sideways deflections hold at most; `pull` (N) is what they and the straight push do, the core's `core`.
  [[nodiscard]] PALPATE_TICK_INLINE double most_strain(const DepthTerms& terms, const Deflection& d, const Vec3& pull,
                                                       const Vec3& core) const {
    const auto most = [&](double lean, const Vec3& force, const Vec3& deflection) {
      return std::fabs(dot(lean * terms.straight - force, deflection));
    };
    if (!rim_.present()) return most(1, pull, d.sideways);
    const double share = rim_.share();
    const Vec3 rim = (1 / share) * (pull - (1 - share) * core);
    return rim_.mean(most(rim_.core_limit(), core, d.sideways), most(rim_.limit(), rim, rim_deflection(d)));
  }

  /// BasicRest::rebase().
  void rebase(const Pose& by) { rest_.rebase(by); }

private:
  [[nodiscard]] Vec3 centre(const DepthTerms& terms) const { return rim_.core_limit() * friction_centre(terms); }
  [[nodiscard]] Vec3 straight_of_core(const DepthTerms& terms) const {
    return rim_.present() ? rim_.core_limit() * terms.straight : terms.straight;
  }

  /// What holds as much of the contact's friction limit bears as much of a straight push.
  [[nodiscard]] Slips slips(Part part, const DepthTerms& terms) const {
    const double limit = part == Part::rim ? rim_.limit() : rim_.core_limit();
    return {part,
            limit * terms.straight,
            limit * friction_centre(terms),
            limit * terms.limit,
            view_->meta->sideways_scale,
            part == Part::rim,
            rest_.spins(),
            false};
  }

  PALPATE_TICK_INLINE void deeper(Deflection& d, const DepthTerms& terms) {
    if (!rim_.present()) {
      const Vec3 kept = field().deepened(depth_, terms, d.sideways);
      if (inner_.core.known()) inner_.core.deepened(field(), depth_, d.sideways, terms, kept, 1);
      return rest_.leave(d, kept);
    }
    const Vec3 before[2] = {d.sideways, rim_deflection(d)};
    const double lean[2] = {rim_.core_limit(), rim_.limit()};
    Vec3 kept[2] = {before[0], before[1]};
    field().deepen(depth_, terms, kept, lean);
    if (inner_.core.known()) inner_.core.deepened(field(), depth_, before[0], terms, kept[0], lean[0]);
    if (inner_.rim.known()) inner_.rim.deepened(field(), depth_, before[1], terms, kept[1], lean[1]);
    rim_.leave(kept[0], kept[1]);
    rest_.leave(d, kept[0]);
  }
  [[gnu::noinline]] void lift(Deflection& d, const DepthTerms& terms) {
    const Vec3 core = inner_.core.lifted(field(), depth_, terms, d.sideways, rim_.core_limit());
    if (rim_.present()) {
      rim_.leave(core, inner_.rim.lifted(field(), depth_, terms, rim_deflection(d), rim_.limit()));
    }
    rest_.leave(d, core);
  }
  /// A lift ends. What is hardly deflected bears nothing that could be lost.
  void turn(const Deflection& d) {
    const double least = 1e-5 * rest_.size();
    if (!(dot(d.sideways, d.sideways) > least * least)) return let_go();
    inner_.lifts = false;
    inner_.core.turn();
    inner_.rim.turn();
  }

  struct Inner {
    InnerPart core, rim;
    bool lifts = false;  ///< the last depth was less than that before
  };

  const View* view_;
  double depth_ = 0;  ///< m
  detail::If<kFriction, Inner> inner_;
  BasicRest<kFeatures> rest_;
  BasicRim<kFeatures> rim_;
};

}  // namespace palpate::runtime
