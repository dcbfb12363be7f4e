#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs everything that is too slow for tools/test.sh: the tests labelled "long" (organ bakes, full comparisons) in the
# release build, then the quick tests under the address and undefined-behaviour sanitizers. Arguments go to ctest.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

palpate_install
palpate_install clang clang-14 libclang-rt-14-dev valgrind \
  gcc-arm-none-eabi libstdc++-arm-none-eabi-newlib qemu-system-arm ||
  echo "palpate: what needs clang, valgrind, or a Cortex-M7's compiler and emulator is skipped" >&2
status=0

palpate_build release
ctest --test-dir "$palpate_root/build/release" --output-on-failure --timeout 7200 -L long "$@" || status=$?

palpate_build sanitize
# OpenBLAS and CGAL keep what they allocate until the end: only errors in use are looked for.
ASAN_OPTIONS=detect_leaks=0 UBSAN_OPTIONS=print_stacktrace=1:halt_on_error=1 \
  ctest --test-dir "$palpate_root/build/sanitize" --output-on-failure -j "$(palpate_jobs)" --timeout 3600 -LE long "$@" ||
  status=$?
exit "$status"
