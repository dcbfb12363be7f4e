// SPDX-License-Identifier: MIT
// Which responses were asked for last: those of another place are brought together, before they are read.
#pragma once

#include "palpate/surface.hpp"
#include "palpate/view.hpp"

namespace palpate::runtime {

/// The responses of a contact are far apart in a large file: their memory comes at once, while something else is done.
/// Nothing of it where memory has no such delays.
template <bool kDelays>
class Brought {
public:
  /// Of those at three sites and the vertices of a tool. True where they are those of the last time, at the same point
  /// of the tool: they are there.
  bool again(const View& view, const std::uint32_t (&sites)[3], const ToolCorners& corners) {
    bool same = view.responses == responses_ && corners == corners_;
    for (int k = 0; k < 3; ++k) same = same && sites[k] == sites_[k];
    if (same) return true;
    responses_ = view.responses;
    corners_ = corners;
    // The frames first: nine responses are more than a processor asks for at once, and would have them wait.
    for (int k = 0; k < 3; ++k) detail::touch(&view.sites[sites[k]], sizeof(layout::Site));
    for (int k = 0; k < 3; ++k) {
      sites_[k] = sites[k];
      for (int l = 0; l < corners.count; ++l) {
        view.fetch(layout::response_index(*view.meta, sites[k], corners.vertex[l]));
      }
    }
    return false;
  }

private:
  const unsigned char* responses_ = nullptr;
  std::uint32_t sites_[3] = {};
  ToolCorners corners_;
};

template <>
class Brought<false> {
public:
  bool again(const View& /*view*/, const std::uint32_t (&/*sites*/)[3], const ToolCorners& /*corners*/) {
    return false;
  }
};

}  // namespace palpate::runtime
