// SPDX-License-Identifier: GPL-3.0-or-later
// Serves a page to this machine alone.
#pragma once

#include <functional>
#include <string>

namespace palpate::report {

struct PageServerOptions {
  int port = 8050;                      ///< of 127.0.0.1, [0, 65535]; 0 takes a free one
  std::string page;                     ///< HTML, at /
  std::function<std::string()> run;     ///< JSON, at /run; called by any thread; an exception becomes an answer of 500
  std::function<void(int port)> ready;  ///< called once it listens
  std::function<bool()> stop;           ///< polled ten times a second
};

/// Serves until `stop`. Throws Error(io) where the port is taken.
void serve_page(const PageServerOptions& options);

}  // namespace palpate::report
