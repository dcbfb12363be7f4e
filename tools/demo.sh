#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# From nothing to a page: installs what is missing, builds the command line, makes a small synthetic liver, bakes and
# verifies it, plays a probing motion on it, and reports.   tools/demo.sh [FOLDER]     (default: build/demo)
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

folder=${1:-$palpate_root/build/demo}
palpate_install
palpate_install_page
palpate_build release palpate palpate-tetgen
palpate=$palpate_root/build/release/bin/palpate

# A small liver as stiff as a cirrhotic one, sampled until the scene's tolerance of 5 % holds: five minutes on two cores.
"$palpate" synth liver --out "$folder" --seed 1 --scale 0.6 --young 25000 --tool-radius 0.006 --depth 0.004 --spacing 0
printf '\n[response]\nsurface_tolerance = 0.0001\n' >> "$folder/scene.toml"
"$palpate" build "$folder/scene.toml"
"$palpate" verify "$folder/scene.toml" --count 20 --report "$folder/verify.json"
"$palpate" play "$folder/scene.palp" "$folder/motion.csv" --out "$folder/forces.csv" --plot "$folder/forces.svg"
"$palpate" report "$folder/scene.toml" --verify "$folder/verify.json" --run "$folder/motion.csv"

cat <<END

Response file:  $folder/scene.palp      (palpate inspect lists what it holds)
Verification:   $folder/verify.json
Forces:         $folder/forces.csv
Plot:           $folder/forces.svg
Report:         $folder/scene.report.html      (made of scene.report.json; open it in a browser and press on the organ)
END
