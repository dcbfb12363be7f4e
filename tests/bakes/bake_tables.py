#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of whole bakes, as rows of Markdown.

    bake_tables.py PALPATE FOLDER planned      five synthetic scenes: planned processor time against the time taken
    bake_tables.py PALPATE FOLDER paper        a plan of the size of the paper's, of which one hundredth is baked
    bake_tables.py PALPATE FOLDER automatic    automatic sampling of organs by five lines: expected and verified error

The environment's PALPATE_ORGANS names the folder with the organs' files. Times are of processors: children of this
program, user and system. Exit code 1 where a plan is off by more than 30 %, or a verified error is beyond the tolerance or
1.5 times the expected one.
"""
import json
import os
import resource
import shutil
import subprocess
import sys
from pathlib import Path

WITHIN = 0.3
BEYOND = 1.5
SCENES = {
    "slab": "slab --spacing 0.012",
    "liver with a tumour": "liver --seed 5 --inclusion --tumour --scale 0.5 --spacing 0.009",
    "kidney with pyramids": "kidney --seed 2 --scale 0.7 --spacing 0.012",
    "filled bladder": "bladder --pressure 500 --friction 0 --spacing 0.012",
    "ball": "ball --spacing 0.02",
}
ORGANS = {"left ovary": ("VH_F_Ovary_L.glb", 0.003), "left kidney": ("VH_M_Kidney_L.glb", 0.005),
          "female liver": ("VH_F_Liver.glb", 0.006)}
FIVE_LINES = """[body]
surface = "{surface}"
[[tool]]
radius = {radius}
[contact]
friction = 0.3
[response]
tolerance = 0.05
"""
PAPER = """[body]
surface = "{surface}"
[[tool]]
shape = "capsule"
radius = 0.006
length = 0.03
[contact]
friction = 0.3
[sampling]
spacing = 0.0075
"""


def run(*command, allowed=(0,)):
    """Its standard output, and the seconds of a processor that it took."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, text=True)
    if done.returncode not in allowed:
        sys.exit(f"{' '.join(done.args)}: exit code {done.returncode}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return done.stdout, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def planned(palpate, scene):
    """Pairs, seconds of a processor for all of them, and the size of the response file."""
    plan = json.loads(run(palpate, "plan", scene, "--json", "--quiet")[0])
    return plan["pairs_planned"], plan["costs"]["processor_seconds"], plan["costs"]["file_bytes"]


def plans(palpate, folder, _):
    print("| scene | pairs | planned, s | taken, s | taken / planned |\n| --- | --- | --- | --- | --- |")
    missed = []
    for name, options in SCENES.items():
        place = folder / name.replace(" ", "_").replace(",", "")
        run(palpate, "synth", *options.split(), "--out", place, "--quiet")
        pairs, plan, _ = planned(palpate, place / "scene.toml")
        _, taken = run(palpate, "bake", place / "scene.toml", "--quiet")
        print(f"| {name} | {pairs} | {plan:.0f} | {taken:.0f} | {taken / plan:.2f} |", flush=True)
        if abs(taken / plan - 1) > WITHIN:
            missed.append(name)
    return missed


def paper_scale(palpate, folder, organs):
    scene = folder / "paper.toml"
    scene.write_text(PAPER.format(surface=organs / "VH_F_Liver.glb"))
    pairs, plan, size = planned(palpate, scene)
    _, taken = run(palpate, "bake", scene, "--shard", "1/100", "--quiet")
    print("| pairs | planned, h | file, MB | one hundredth, h | extrapolated, h |\n| --- | --- | --- | --- | --- |")
    print(f"| {pairs} | {plan / 3600:.1f} | {size / 1e6:.1f} | {taken / 3600:.3f} | {taken / 36:.1f} |")
    return ["paper"] if abs(100 * taken / plan - 1) > WITHIN else []


def automatic(palpate, folder, organs):
    print("| organ | sites | in full | processor, min | expected, % | verified, % | file, kB |\n" + 7 * "| --- " + "|")
    missed = []
    for name, (surface, radius) in ORGANS.items():
        scene = folder / (name.replace(" ", "_") + ".toml")
        scene.write_text(FIVE_LINES.format(surface=organs / surface, radius=radius))
        _, taken = run(palpate, "build", scene, "--quiet", allowed=(0, 5))  # 5: a file that says what it misses
        report = scene.with_suffix(".verify.json")
        run(palpate, "verify", scene, "--count", "60", "--report", report, "--quiet")
        verified = json.loads(report.read_text())
        file = scene.with_suffix(".palp")
        made = json.loads(run(palpate, "inspect", file, "--json")[0])
        sites, full = made["sites"], made["provenance"]["pairs"]["full"]
        p95, expected = verified["error"]["p95"], verified["expected_p95"]
        print(f"| {name} | {sites} | {full} | {taken / 60:.0f} | {100 * expected:.1f} | {100 * p95:.1f} | "
              f"{file.stat().st_size / 1e3:.0f} |", flush=True)
        if p95 > verified["tolerance"] or p95 > BEYOND * expected:
            missed.append(name)
    return missed


def main():
    palpate, folder, part = sys.argv[1], Path(sys.argv[2]), sys.argv[3]
    organs = Path(os.environ.get("PALPATE_ORGANS", ""))
    folder = folder / part
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    if part != "planned" and not (organs / "VH_F_Liver.glb").is_file():
        print("skipped: PALPATE_ORGANS names no folder with the organs' files")
        return
    missed = {"planned": plans, "paper": paper_scale, "automatic": automatic}[part](palpate, folder, organs)
    if missed:
        sys.exit("missed: " + ", ".join(missed))


main()
