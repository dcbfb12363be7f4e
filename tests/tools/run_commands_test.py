# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs commands of the documents that take less than a second, as they are written there, one after the other.

Usage: run_commands_test.py SOURCE FOLDER PALPATE
"""
import pathlib
import shlex
import shutil
import subprocess
import sys

source, folder, palpate = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3]
# Document, command, a part of its output or a file that it writes.
commands = [
    ("tools/README.md", "palpate synth liver --out demo --seed 1", pathlib.Path("demo/scene.toml")),
    ("formats/README.md", "palpate scene --reference", "[sampling]"),
    ("formats/README.md", "palpate scene --tissues", "liver"),
    ("formats/README.md", "palpate scene --from liver.ply --out scene.toml", pathlib.Path("scene.toml")),
    ("formats/README.md", "palpate scene scene.toml", "scene.toml: good"),
    ("tools/README.md", "palpate drive --list", "sim"),
    ("SECURITY.md", "palpate --version", "palpate "),
]
shutil.rmtree(folder, ignore_errors=True)
folder.mkdir(parents=True)
for document, command, expected in commands:
    if command not in (source / document).read_text(encoding="utf-8"):
        raise SystemExit(f"{document} has no '{command}'")
    if command.startswith("palpate scene --from liver.ply"):
        shutil.copy(folder / "demo/liver.ply", folder / "liver.ply")
    run = subprocess.run([palpate] + shlex.split(command)[1:], cwd=folder, capture_output=True, text=True)
    if run.returncode != 0:
        raise SystemExit(f"{document}: '{command}' ends with {run.returncode}\n{run.stdout}{run.stderr}")
    there = (folder / expected).exists() if isinstance(expected, pathlib.Path) else expected in run.stdout
    if not there:
        raise SystemExit(f"{document}: '{command}' gives no '{expected}'\n{run.stdout}{run.stderr}")
print(f"{len(commands)} commands run")
