# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks the folders of the tree: none has more than 25 source files, `formats` includes nothing above it, and no two
folders include each other, by one step or several.

Usage: layout_test.py SOURCE
"""
import collections
import pathlib
import re
import subprocess
import sys

MOST = 25
source = pathlib.Path(sys.argv[1])
listed = subprocess.run(["git", "-C", source, "ls-files", "-z"], capture_output=True, text=True)
if listed.returncode != 0:
    print("skipped: no git")
    sys.exit()
files = {name for name in listed.stdout.split("\0") if name and (source / name).exists()}
faults = []

count = collections.Counter()
for name in files:
    path = pathlib.PurePosixPath(name)
    if path.suffix in {".cpp", ".hpp", ".cmake", ".py", ".mjs", ".js", ".sh", ".ld"} or path.name == "CMakeLists.txt":
        count[str(path.parent)] += 1
faults += [f"{folder} has {many} source files, at most {MOST} are allowed" for folder, many in count.items() if many > MOST]

# An umbrella header and the settings under all headers share the folder of the runtime: both stand apart.
APART = {"runtime/include/palpate"}
edges = collections.defaultdict(dict)
for name in sorted(files):
    if not name.endswith((".cpp", ".hpp")) or name.startswith("tests/"):
        continue
    folder = str(pathlib.PurePosixPath(name).parent)
    for included in re.findall(r'^#include "([^"]+)"', (source / name).read_text(encoding="utf-8"), re.M):
        places = (included, "runtime/" + included, "runtime/include/" + included, "formats/include/" + included)
        found = next((place for place in places if place in files), None)
        if found is None:
            continue
        if name.startswith("formats/") and not found.startswith("formats/"):
            faults.append(f"{name} includes {found}, which is above formats")
        other = str(pathlib.PurePosixPath(found).parent)
        if other != folder and not {folder, other} & APART:
            edges[folder].setdefault(other, f"{name} includes {found}")
if len(edges) < 10:
    faults.append(f"{len(edges)} folders include another: the includes are not found")


def way(begin, end):
    """The includes that lead from one folder to another; none where no way does."""
    before, queue = {begin: None}, [begin]
    for at in queue:
        for to in edges.get(at, {}):
            if to not in before:
                before[to] = at
                queue.append(to)
    if end not in before:
        return []
    steps = []
    while before[end] is not None:
        steps.insert(0, edges[before[end]][end])
        end = before[end]
    return steps


reported = set()
for folder in sorted(edges):
    for other, first in edges[folder].items():
        back = way(other, folder)
        if back and frozenset([first, *back]) not in reported:
            reported.add(frozenset([first, *back]))
            faults.append("a circle of folders: " + "; ".join([first, *back]))
print("\n".join(faults) or f"{len(count)} folders, the largest with {max(count.values())} source files")
sys.exit(bool(faults))
