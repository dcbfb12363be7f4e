// SPDX-License-Identifier: MIT
// The part of a contact that slips before all of it does.
#pragma once

#include "palpate/field.hpp"

namespace palpate::runtime {

/// A contact that is drawn sideways slips from its rim inwards, long before it slides as a whole (Cattaneo 1938;
/// Mindlin 1949). Here it is two that lie on the same point and share its field, a rim and a core: the force is their
/// mean, weighted with their shares; each has its own sideways deflection and friction limit, the core the higher one,
/// so that both limits together are that of the contact, and bears as much of the sideways force of a straight push.
/// Each for itself is a contact that sticks until it slips, and two that are passive are passive together. What follows
/// from it: less resistance before full slip, which comes later; at reversals twice the way (Masing's rule); no drift
/// at rest (Iwan 1966). The deflection of the core is that of BasicRest, with which c goes; of the rim's this keeps by
/// how much it leads. Without layout::feature_rim all is core: no code, no memory.
template <std::uint32_t kFeatures>
class BasicRim {
  static constexpr bool kRim = (kFeatures & layout::feature_rim) != 0;

public:
  explicit BasicRim(const View& view) {
    if constexpr (kRim) {
      const double share = static_cast<double>(view.meta->rim_share), limit = static_cast<double>(view.meta->rim_limit);
      if (share > 0) state_ = {share, limit, (1 - share * limit) / (1 - share), {}};
    }
  }

  /// The contacts of the file have one.
  [[nodiscard]] bool present() const { return share() > 0; }

  [[nodiscard]] double share() const {
    if constexpr (kRim) return state_.share;
    return 0;
  }
  /// What rim and core hold for their share, in friction limits of the contact.
  [[nodiscard]] double limit() const {
    if constexpr (kRim) return state_.limit;
    return 1;
  }
  [[nodiscard]] double core_limit() const {
    if constexpr (kRim) return state_.core_limit;
    return 1;
  }

  /// Sideways deflection (m) of the rim, across the unit n, for that of the core.
  [[nodiscard]] Vec3 deflection(const Vec3& core, const Vec3& n) const {
    if constexpr (kRim) return tangential(core + state_.lead, n);
    return core;
  }
  /// The rim is deflected otherwise than the core.
  [[nodiscard]] bool apart() const {
    if constexpr (kRim) return !(state_.lead.x == 0 && state_.lead.y == 0 && state_.lead.z == 0);
    return false;
  }
  /// Both, from now on.
  void leave([[maybe_unused]] const Vec3& core, [[maybe_unused]] const Vec3& rim) {
    if constexpr (kRim) state_.lead = rim - core;
  }

  template <class Value>
  [[nodiscard]] Value mean(const Value& core, const Value& rim) const {
    return (1 - share()) * core + share() * rim;
  }

private:
  struct State {
    double share = 0, limit = 1, core_limit = 1;
    Vec3 lead;  ///< m, by which the rim is deflected more than the core
  };
  detail::If<kRim, State> state_;
};

}  // namespace palpate::runtime
