// SPDX-License-Identifier: MIT
// Coupled laws of a patch's sites at one point of a tool, kept while c slides from one blend to the next.
#pragma once

#include "palpate/coupled.hpp"
#include "palpate/surface.hpp"

namespace palpate::runtime {

/// Calls add(coefficients, those of the friction limit, N of one, that of mu) for a response of a coupled file.
template <class Add>
inline void with_law(const View& view, std::uint64_t index, const coupled::Places& places, const Add& add) {
  const unsigned char* law = view.coupled_law(index);
  const std::uint32_t bits = view.meta->coef_bits;
  const auto* limits = reinterpret_cast<const std::int16_t*>(law + layout::coupled_limit_offset(places, bits));
  const auto unit = static_cast<double>(view.coupled_unit(index));
  if (bits == 16) return add(reinterpret_cast<const std::int16_t*>(law + sizeof(float)), limits, unit);
  std::int32_t room[coupled::kMostCoefs];
  coupled::unpack(law + sizeof(float), bits, places.limit, room);
  add(room, limits, unit);
}

/// What the three sites of a patch answer, each interpolated to a point of a tool and in its own frame: that is most of
/// the work of a blend, and does not change while c slides within the patch; of the next patch two are known already.
/// Fixed size, no allocation. kRelief: with reliefs (relief.hpp).
template <bool kRelief>
class SiteLaws {
public:
  struct SiteLaw {
    coupled::Rows rows;
    double covered, limit;  ///< share of the tool's weights on responses taken from neighbours; m, depth limit
    detail::If<kRelief, double> relief;
  };

  /// Whether look() is to be used for these sites at this point of a tool: they are asked for again, or no more than
  /// one of them is new. Else blending all responses at once is less work, and nothing changes.
  bool choose(const View& view, const std::uint32_t (&sites)[3], const ToolCorners& corners, bool again) {
    const bool same = view.responses == responses_ && corners == corners_;
    int slots[3] = {kSites, kSites, kSites}, known = 0;
    bool taken[3] = {};
    for (int k = 0; same && k < kSites; ++k) {
      for (int slot = 0; slot < kSites; ++slot) {
        if (site_[slot] != sites[k]) continue;
        slots[k] = slot;
        taken[slot] = true;
        ++known;
      }
    }
    if (!again && known < 2) return false;
    if (!same) {
      responses_ = view.responses;
      corners_ = corners;
      for (std::uint32_t& site : site_) site = kNone;
    }
    for (int k = 0; k < kSites; ++k) {
      int slot = slots[k] < kSites ? slots[k] : 0;
      while (slots[k] == kSites && taken[slot]) ++slot;
      taken[slot] = true;
      slot_[k] = slot;
    }
    return true;
  }

  /// That of site k of the three.
  const SiteLaw& look(const View& view, const std::uint32_t (&sites)[3], int k) {
    const int slot = slot_[k];
    if (site_[slot] != sites[k]) {
      site_[slot] = sites[k];
      gather(view, sites[k], law_[slot]);
    }
    return law_[slot];
  }

private:
  static constexpr int kSites = 3;
  static constexpr std::uint32_t kNone = 0xffffffff;  // no site: there are at most layout::kMaxCount

  [[gnu::noinline]] void gather(const View& view, std::uint32_t site, SiteLaw& to) const {
    coupled::Blend sum;
    sum.clear(layout::coupled_degrees(*view.meta));
    to.covered = to.limit = 0;
    if constexpr (kRelief) to.relief = 0;
    for (int l = 0; l < corners_.count; ++l) {
      const std::uint64_t index = layout::response_index(*view.meta, site, corners_.vertex[l]);
      const layout::ResponseHead& head = view.response_head(index);
      const double weight = corners_.weight[l];
      to.limit += weight * static_cast<double>(head.depth_limit);
      if ((head.flags & layout::response_covered) != 0) to.covered += weight;
      if constexpr (kRelief) {
        if (view.head_size > sizeof(layout::ResponseHead)) to.relief += weight * view.relief(index);
      }
      with_law(view, index, sum.places(), [&](const auto* coefs, const auto* limits, double unit) {
        sum.add(coefs, limits, unit, layout::kLimitUnit, weight);
      });
    }
    to.rows.set(sum.degrees(), sum.coefs());
  }

  const unsigned char* responses_ = nullptr;  ///< of the file whose laws these are
  ToolCorners corners_;
  std::uint32_t site_[kSites] = {kNone, kNone, kNone};  ///< of each slot
  int slot_[kSites] = {0, 1, 2};                        ///< of the patch's three sites
  SiteLaw law_[kSites];
};

}  // namespace palpate::runtime
