// SPDX-License-Identifier: GPL-3.0-or-later
// Ticks where any system call is death: silent_ticks FILE.palp [call], which makes one on purpose.
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstddef>
#include <cstdio>

#include "palpate/format/mapped_file.hpp"
#include "tests/runtime/every_tick.hpp"

namespace {

/// From here on the kernel kills this process for every system call but the one that ends it.
bool forbid_system_calls() {
  sock_filter program[] = {BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
                           BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_exit_group, 0, 1),
                           BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
                           BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_KILL_PROCESS)};
  const sock_fprog filter{sizeof program / sizeof program[0], program};
  return ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter) == 0;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace palpate;
  if (argc < 2) return std::fprintf(stderr, "usage: silent_ticks FILE.palp [call]\n"), 1;
  const runtime::MappedFile file(argv[1]);
  if (!file.ok()) return std::fprintf(stderr, "%s: %s\n", argv[1], file.error()), 4;
  const auto nothing = [] {};
  const auto call = [] { ::syscall(SYS_getppid); };
  if (!forbid_system_calls()) return std::perror("silent_ticks: seccomp"), 77;
  const test::EveryTick sum = test::every_tick(file.data(), file.size(), 10000, argc > 2 ? +call : +nothing);
  // The exit code is all that it may still say.
  ::_exit(sum.error != nullptr ? 2 : !sum.finite ? 3 : sum.touching < 10000 ? 5 : sum.bonded > 0 ? 10 : 0);
}
