// SPDX-License-Identifier: GPL-3.0-or-later
// The page as the build bundled it.
#pragma once

#include <string_view>

namespace palpate::report {

struct PageTemplate {
  std::string_view html;     ///< with the marks @@TITLE@@ and <!--@@DATA@@-->
  std::string_view missing;  ///< what the build lacked; empty: nothing, and `html` is there
};

PageTemplate page_template();

}  // namespace palpate::report
