// SPDX-License-Identifier: GPL-3.0-or-later
// Shared parts of the commands of the `palpate` executable: global options and how a command is added.
//
// To add the command `foo`:
//  1. write tools/cmd_foo.cpp, which defines `void palpate::cli::add_foo(CLI::App&, Globals&)`;
//  2. add `palpate_command(foo NEEDS palpate_<library>...)` to tools/CMakeLists.txt. command.cpp picks it up.
//
//     void add_foo(CLI::App& app, Globals& globals) {
//       struct Options { std::string scene; double limit = 1.0; };
//       auto options = std::make_shared<Options>();          // must outlive parsing
//       Command command(app, "foo", "Does foo");
//       command.option("scene", options->scene, "Scene file").required();
//       command.option("--limit", options->limit, "Largest foo (m)").check(number_in(1e-6, 1.0));
//       command.runs([options, &globals] { run_foo(*options, globals); });
//     }
//
// Rules: check numbers (command.hpp); take files as plain strings (a missing file is exit code 4, not wrong usage);
// throw palpate::Error, main turns it into the message and the exit code; never call exit(). Results go to standard
// output by output.hpp, progress and messages to standard error. Work that lasts and can be saved polls interrupted()
// under an InterruptPolling (interrupt.hpp), saves what it has and throws Interrupted; anything else is ended by a
// signal at once.
#pragma once

namespace CLI {
class App;
}

namespace palpate::cli {

/// Options that every command understands; they may stand before or after the command's name.
struct Globals {
  bool json = false;   ///< --json: the result as one JSON document on standard output
  bool quiet = false;  ///< --quiet: no progress and no notes on standard error (errors stay)
  int threads = 1;     ///< --threads: worker threads, at least 1; default: one a processor
};

#define PALPATE_COMMAND(name) void add_##name(CLI::App& app, Globals& globals);
#include "command_list.inc"
#undef PALPATE_COMMAND

}  // namespace palpate::cli
