#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Instructions of each row that `palpate bench` times, the mean of its calls, counted by callgrind (Debian's valgrind):
# tools/instructions.sh build/release/bin/palpate FILE.palp [--tool NAME] [--contacts N]
set -euo pipefail
if [ $# -lt 2 ]; then
  sed -n '3,4s/^# //p' "$0" >&2
  exit 1
fi
command -v valgrind > /dev/null || { echo "instructions.sh: valgrind is not installed" >&2; exit 1; }
palpate=$1
shift
counts=$(mktemp)
trap 'rm -f "$counts"' EXIT
# The program starts itself anew once, to have its libraries read these, which it cannot under valgrind.
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 PALPATE_BLAS_CHOSEN=PALPATE_BLAS_CHOSEN
valgrind -q --tool=callgrind --callgrind-out-file="$counts" \
  "$palpate" bench --quiet "$@" --seconds 0.001 --ticks 1000 > /dev/null
# The file lists of each call the function (by name at first, then by number alone), its count, and its total cost.
awk '
  /^c?fn=/ {
    number = $0
    sub(/^[^(]*\(/, "", number)
    sub(/\).*/, "", number)
    if (/measured</ && match($0, /::row::[a-z]+,/)) row[number] = substr($0, RSTART + 7, RLENGTH - 8)
    if (/^cfn/) callee = number
  }
  /^calls=/ {
    calls = substr($1, 7)
    getline
    if (callee in row) {
      times[row[callee]] += calls
      cost[row[callee]] += $2
    }
  }
  END {
    rows = split("press field slide free locate blend anew random five plain network", order, " ")
    for (k = 1; k <= rows; ++k) {
      if (!(order[k] in times)) {
        print "instructions.sh: no call of " order[k] " was seen; was the program stripped?" > "/dev/stderr"
        exit 1
      }
      printf "%-7s %8.0f instructions\n", order[k], cost[order[k]] / times[order[k]]
    }
  }' "$counts"
