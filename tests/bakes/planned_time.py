#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Planned processor time of five synthetic bakes against the time they take, as rows of Markdown.

    planned_time.py PALPATE FOLDER

Times are of processors: children of this program, user and system. Exit code 1 where a plan is off by more than 30 %.
"""
import json
import resource
import shutil
import subprocess
import sys
from pathlib import Path

WITHIN = 0.3
SCENES = {
    "slab": "slab --spacing 0.012",
    "liver with a tumour": "liver --seed 5 --inclusion --tumour --scale 0.5 --spacing 0.009",
    "kidney with pyramids": "kidney --seed 2 --scale 0.7 --spacing 0.012",
    "filled bladder": "bladder --pressure 500 --friction 0 --spacing 0.012",
    "ball": "ball --spacing 0.02",
}


def run(*command):
    """Its standard output, and the seconds of a processor that it took."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([str(c) for c in command], check=True, stdout=subprocess.PIPE, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return done.stdout, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main():
    palpate, folder = sys.argv[1], Path(sys.argv[2])
    shutil.rmtree(folder, ignore_errors=True)
    print("| scene | pairs | planned, s | taken, s | taken / planned |\n| --- | --- | --- | --- | --- |")
    missed = []
    for name, options in SCENES.items():
        place = folder / name.replace(" ", "_")
        run(palpate, "synth", *options.split(), "--out", place, "--quiet")
        plan = json.loads(run(palpate, "plan", place / "scene.toml", "--json", "--quiet")[0])
        _, taken = run(palpate, "bake", place / "scene.toml", "--quiet")
        planned = plan["costs"]["processor_seconds"]
        print(f"| {name} | {plan['pairs_planned']} | {planned:.0f} | {taken:.0f} | {taken / planned:.2f} |", flush=True)
        if abs(taken / planned - 1) > WITHIN:
            missed.append(name)
    if missed:
        sys.exit("missed: " + ", ".join(missed))


main()
