#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs what is missing, builds everything and runs every quick test. Arguments go to ctest:
#   tools/test.sh -R scene
# Tests on real organs run when PALPATE_ORGANS names the folder of their files, and report themselves skipped otherwise.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

palpate_install
palpate_install slurmctld slurmd slurm-client munge faketime ||
  echo "palpate: the test on a Slurm cluster, and that with a clock set back, are skipped" >&2
palpate_install_page
# The page is tested in it.
palpate_install chromium || echo "palpate: the page of palpate report is not tested" >&2
palpate_build release
# One more than there are processors, for some tests wait for a device or a deadline.
exec ctest --test-dir "$palpate_root/build/release" --output-on-failure -j "$(($(palpate_jobs) + 1))" --timeout 600 -LE long "$@"
