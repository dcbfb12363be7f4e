// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/view/page_server.hpp"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"
#include <httplib.h>
#pragma GCC diagnostic pop

#include <chrono>
#include <thread>

#include "formats/io/error.hpp"

namespace palpate::report {

void serve_page(const PageServerOptions& options) {
  constexpr const char* kHost = "127.0.0.1";
  httplib::Server server;
  server.Get("/", [&](const httplib::Request&, httplib::Response& answer) {
    answer.set_content(options.page, "text/html; charset=utf-8");
  });
  server.Get("/run", [&](const httplib::Request&, httplib::Response& answer) {
    try {
      answer.set_content(options.run(), "application/json");
    } catch (const std::exception& error) {
      answer.status = 500;
      answer.set_content(error.what(), "text/plain");
    }
  });
  const int port = options.port == 0 ? server.bind_to_any_port(kHost) : options.port;
  if (port < 0 || (options.port != 0 && !server.bind_to_port(kHost, port))) {
    throw Error(ExitCode::io, std::string(kHost) + ":" + std::to_string(options.port) +
                                  ": cannot listen there; is the port in use? --port 0 takes a free one");
  }
  std::thread listening([&] { server.listen_after_bind(); });
  options.ready(port);
  while (!options.stop()) std::this_thread::sleep_for(std::chrono::milliseconds(100));
  server.stop();
  listening.join();
}

}  // namespace palpate::report
