#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Formats the lines of C++ files that differ from the merge base with BASE (default main), by .clang-format.
# Usage: tools/format.sh [--check] [BASE]
#   --check: changes no file; prints the differences.
# Exit codes: 0 done, 1 usage or no clang-format, 5 lines to format (--check).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
check=0
[ "${1:-}" != --check ] || { check=1; shift; }
[ $# -le 1 ] || { echo "usage: format.sh [--check] [BASE]" >&2; exit 1; }
format=$(command -v clang-format-14 || command -v clang-format) ||
  { echo "format.sh: no clang-format; on Debian 12: apt-get install clang-format-14" >&2; exit 1; }
base=$(git merge-base "${1:-main}" HEAD)
status=0
while IFS= read -r file; do
  ranges=$(git diff -U0 "$base" -- "$file" |
    sed -nE 's/^@@ [^+]*\+([0-9]+)(,([0-9]+))? @@.*/\1 \3/p' |
    awk '{n = NF > 1 ? $2 : 1; if (n > 0) printf "-lines=%d:%d ", $1, $1 + n - 1}')
  [ -n "$ranges" ] || continue
  if [ $check -eq 0 ]; then
    # shellcheck disable=SC2086
    "$format" -i $ranges "$file"
  else
    # shellcheck disable=SC2086
    "$format" $ranges "$file" | diff -u --label "$file" --label "$file formatted" "$file" - || status=5
  fi
done < <(git diff --name-only --diff-filter=d "$base" -- '*.hpp' '*.cpp')
exit $status
