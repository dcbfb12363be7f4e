// SPDX-License-Identifier: GPL-3.0-or-later
// The `palpate` executable: runs one command, turns errors into exit codes.
#include "formats/io/error.hpp"
#include "tools/cli/blas.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/interrupt.hpp"
#include "tools/cli/memory.hpp"

#include <csignal>
#include <cstdio>
#include <filesystem>
#include <new>
#include <string>

namespace {

using palpate::ExitCode;

int report(ExitCode code, const char* message) {
  std::fprintf(stderr, "palpate: error: %s\n", message);
  return static_cast<int>(code);
}

}  // namespace

int main(int argc, char** argv) {
  palpate::cli::use_right_blas_kernels(argv);
  palpate::cli::keep_freed_memory();
  // A file that outgrows its limit is an I/O error with a message, not a death by signal.
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    return palpate::cli::run_command_line(argc, argv);
  } catch (const palpate::Error& error) {
    return report(error.code(), error.what());
  } catch (const palpate::cli::Interrupted& interruption) {
    std::fprintf(stderr, "palpate: %s\n", interruption.what());
    return palpate::cli::interrupt_exit_code();
  } catch (const std::filesystem::filesystem_error& error) {
    return report(ExitCode::io, error.what());
  } catch (const std::bad_alloc&) {
    return report(ExitCode::io, "out of memory");
  } catch (const std::exception& error) {
    return report(ExitCode::numerical, (std::string("unexpected: ") + error.what()).c_str());
  }
}
