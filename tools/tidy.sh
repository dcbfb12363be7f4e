#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Runs clang-tidy (.clang-tidy) on the lines of C++ files that differ from the merge base with BASE (default main).
# Usage: tools/tidy.sh [--seconds N] [BASE]
#   --seconds N: starts no file after N seconds (default 600), and names those that are left out
# A changed header is read through the source file of the same name. Changes of comments alone are passed over.
# Exit codes: 0 no finding, 1 usage, 5 findings, 77 skipped (no clang-tidy, or no BASE).
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"
seconds=600
if [ "${1:-}" = --seconds ]; then
  [ $# -ge 2 ] || { echo "tidy.sh: --seconds needs a number" >&2; exit 1; }
  seconds=$2
  shift 2
fi
[ $# -le 1 ] || { echo "usage: tidy.sh [--seconds N] [BASE]" >&2; exit 1; }
tidy=$(command -v clang-tidy-14 || command -v clang-tidy) || { echo "skipped: no clang-tidy"; exit 77; }
base=$(git merge-base "${1:-main}" HEAD 2>/dev/null) || { echo "skipped: no merge base with ${1:-main}"; exit 77; }

# Code without comments: the preprocessor removes them.
code() { "${CXX:-c++}" -fpreprocessed -dD -E -P -x c++ - 2>/dev/null; }

# Per changed file: its changed lines as clang-tidy's filter, and the source file that reads them.
filter='' sources=()
while IFS= read -r file; do
  if [ "$(git show "$base:$file" 2>/dev/null | code)" = "$(code < "$file")" ]; then continue; fi
  ranges=$(git diff -U0 "$base" -- "$file" |
    sed -nE 's/^@@ [^+]*\+([0-9]+)(,([0-9]+))? @@.*/\1 \3/p' |
    awk '{n = NF > 1 ? $2 : 1; if (n > 0) printf "%s[%d,%d]", (k++ ? "," : ""), $1, $1 + n - 1}')
  [ -n "$ranges" ] || continue
  filter="$filter${filter:+,}{\"name\":\"$file\",\"lines\":[$ranges]}"
  source=${file%.*}.cpp
  [ ! -f "$source" ] || [[ " ${sources[*]} " == *" $source "* ]] || sources+=("$source")
done < <(git diff --name-only --diff-filter=d "$base" -- 'runtime/*pp' 'formats/*pp' 'precompute/*pp' 'tools/*pp' 'datasets-synthetic/*pp')
if [ ${#sources[@]} -eq 0 ]; then
  echo "no source file differs from $base in more than comments"
  exit 0
fi

SECONDS=0
for source in "${sources[@]}"; do
  grep -qF "$root/$source\"" build/tidy/compile_commands.json 2>/dev/null && continue
  cmake --preset tidy > /dev/null
  break
done
status=0 done=0 out=()
for source in "${sources[@]}"; do
  if [ $SECONDS -ge "$seconds" ] || ! grep -qF "$root/$source\"" build/tidy/compile_commands.json; then
    out+=("$source")
    continue
  fi
  code=0
  text=$(timeout "$((seconds - SECONDS))" "$tidy" --quiet -p build/tidy "--line-filter=[$filter]" "$source" 2>&1) || code=$?
  # Findings are in files of the project. Headers of the system that clang refuses (ITK's) hide a file from it.
  if grep -qE "^$root/[^:]+:[0-9]+:[0-9]+: (warning|error): " <<< "$text"; then
    grep -vE '^[0-9]+ warnings?|^Suppressed |^Use -|^warning: ' <<< "$text"
    status=5
  elif [ $code -ne 0 ]; then
    out+=("$source")
    continue
  fi
  done=$((done + 1))
done
echo "$done of ${#sources[@]} changed source files read in $SECONDS s"
[ ${#out[@]} -eq 0 ] || echo "left out (no time, not in the build, or not readable by clang): ${out[*]}"
exit $status
