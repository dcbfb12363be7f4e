# SPDX-License-Identifier: GPL-3.0-or-later
"""Every command that a document shows as a line of its own runs in a test: here, on a small block in place of the
documents' organs, or in the test that the list below names. A command in neither list is a fault.

Usage: run_commands_test.py SOURCE FOLDER PALPATE BUILD
"""
import gzip
import os
import pathlib
import re
import shutil
import struct
import subprocess
import sys

source, folder, palpate = (pathlib.Path(argument) for argument in sys.argv[1:4])
listing = subprocess.run(["ctest", "--test-dir", sys.argv[4], "-N"], capture_output=True, text=True, check=True).stdout
tests = re.findall(r"^ +Test +#\d+: (.*)$", listing, re.M)
complete = "NOT_BUILT" not in listing  # the tests of a program are listed once it is built


# In this order: the command, a part of its output or a file that it writes, and copies that it reads (from, to), because
# the documents have several names for one scene.
RUN = [
    ("palpate --version", "palpate "),
    ("palpate synth liver --out demo --seed 1", pathlib.Path("demo/scene.toml")),
    ("palpate scene --reference", "[sampling]"),
    ("palpate scene --tissues", "liver"),
    ("palpate scene --from liver.ply --out scene.toml", pathlib.Path("scene.toml"), ("demo/liver.ply", "liver.ply")),
    ("palpate scene --from liver.nii.gz --out scene.toml", pathlib.Path("scene.toml"), ("ball.nii.gz", "liver.nii.gz")),
    ("palpate scene --from study.nii.gz --out study.toml", pathlib.Path("study.toml"), ("ball.nii.gz", "study.nii.gz")),
    ("palpate scene scene.toml", "scene.toml: good", ("block.toml", "scene.toml")),
    ("palpate mesh scene.toml", "triangles"),
    ("palpate plan scene.toml", pathlib.Path("scene.work/manifest.json")),
    ("for i in 1 2 3 4; do palpate bake scene.toml --shard $i/4 --threads 1 & done; wait", pathlib.Path("scene.work/shards")),
    ("palpate merge scene.toml && palpate fit scene.toml", pathlib.Path("scene.palp")),
    ("palpate build scene.toml", "pairs"),
    ("palpate build ball/scene.toml", pathlib.Path("ball/scene.palp"), ("block.toml", "ball/scene.toml")),
    ("palpate inspect scene.palp", "SITES"),
    ("palpate play scene.palp motion.csv --out forces.csv --plot trace.svg", pathlib.Path("trace.svg"),
     ("demo/motion.csv", "motion.csv")),
    ("palpate play ball/scene.palp ball/motion.csv --out forces.csv --plot forces.svg", pathlib.Path("forces.svg"),
     ("demo/motion.csv", "ball/motion.csv")),
    ("palpate export scene.palp --curves curves.csv --glb body.glb --vtu body.vtu", pathlib.Path("body.glb")),
    ("palpate export scene.toml --solved contact.vtu --contact 2", pathlib.Path("contact.vtu")),
    ("palpate export scene.palp --png organ.png", pathlib.Path("organ.png")),
    ("palpate export liver/scene.palp --png liver.png", pathlib.Path("liver.png"), ("scene.palp", "liver/scene.palp")),
    ("palpate scene --from liver.glb --out liver.toml", pathlib.Path("liver.toml"), ("body.glb", "liver.glb")),
    ("palpate compare with.palp without.palp", "sites", ("scene.palp", "with.palp"), ("scene.palp", "without.palp")),
    ("palpate bench scene.palp --open", "open"),
    ("palpate bench --models scene.toml", "quadratic potential"),
    ("palpate report scene.toml --compare other.palp", pathlib.Path("scene.report.html"), ("scene.palp", "other.palp")),
    ("palpate drive --list", "sim"),
    ("palpate drive scene.palp --device sim --seconds 20", pathlib.Path("scene.palprun")),
    ("palpate play scene.palprun", "ticks"),
    ("palpate verify scene.palp --device falcon", "falcon"),
    ("palpate verify scene.palp --device falcon --rate 1000 --scale 1", "falcon"),
]
# Parts of these commands that take long, and what runs in their place.
SHORTER = [
    ("--seconds 20", "--seconds 1"),
    ("palpate report scene.toml", "palpate report scene.toml --quick --contacts 2"),  # without: ReportBuild
]
# Commands that take longer or need more, and the test that runs them on inputs of its own.
ELSEWHERE = [
    (r"palpate build study\.toml", "StudyBuild"),
    (r"palpate verify (ball/)?scene\.toml( --count \d+| --report verify\.json)?", "Pipeline.SlabEndToEnd"),
    (r"palpate verify scene\.palp --samples report\.json --max-p95 0\.12", "Pipeline.SlabEndToEnd"),
    (r"palpate_add_force_test\(.*\)", "Pipeline.SlabEndToEnd"),
    (r"palpate report (liver/)?scene\.toml --verify verify\.json( --battery battery\.json)?", "ReportBuild"),
    (r"palpate report scene\.toml --verify verify\.json --beside coarse\.toml", "Report.numbers"),
    (r"palpate view .*", "Report.view"),
    (r"palpate verify --battery stiff.*", "Battery.Stiff"),
    (r"palpate verify --battery random .*", "Battery.Random"),
    (r"palpate drive scene\.palp --device sim-glove --seconds 10", "Drive.AGloveIsCalibratedDrivenAndReplayed"),
    (r"palpate bench scene\.palp", "Playback.BenchNamesTheMachineAndTimesEveryState"),
    (r"tools/instructions\.sh .*", "BenchInstructions"),
    (r"palpate submit scene\.toml --shards 64 .*", "Slurm.EightShards"),
    (r"palpate verify --closed-forms", "ClosedForms.Command"),
    (r"palpate verify --slide", "Slide.Block"),
    (r"palpate verify --two-tips", "TwoTips.Block"),
    (r"palpate verify --together 2 --layout line", "Together.Block"),
    (r"palpate verify --together 2 --layout pinch", "Together.Pinch"),
    (r"palpate verify --together 5 --layout ring", "Together.Ring"),
    (r"palpate verify --together 2 --layout random", "Together.Random"),
    (r"palpate verify --shape", "Shape.Block"),
    (r"palpate bench --rows", "Rows.Bench"),
    (r"palpate verify block\.toml --strokes", "Strokes.block"),
    (r"palpate verify --compare ccx .*", "Compare.Ccx"),
    (r"palpate mesh NAME\.toml", "GoodSurface.IsReported"),
    (r"build/release/bin/stability_battery .*", "stability_battery.some"),
    (r"build/release/bin/write_goldens tests/goldens", "Goldens"),
    (r"cmake -D SOURCE=\. -D NAME=device .*", "Fuzz.Device"),
    (r"arm-none-eabi-g\+\+ .*", "Device.FirmwareForCortexM7"),
]
# Commands that build or run the tests themselves: a file of continuous integration calls them.
BUILD = [
    (r"tools/test\.sh.*", ".ci/run"),
    (r"(cmake --preset|cmake --build|ctest --(preset|test-dir)) .*", ".github/workflows/ci.yml"),
]
# No test runs these; the list only shrinks.
BY_HAND = {
    "tools/demo.sh": "installs packages, then bakes for minutes",
    "tools/test-long.sh": "runs for hours",
    "palpate bench --solver": "takes minutes",
    "palpate bench --solver scene.toml": "takes minutes",
    "palpate bench --solver liver.toml --contacts 1": "takes minutes",
    'seq 64 | parallel -S node1,node2 --wd "$PWD" --retries 3 palpate bake scene.toml --shard {}/64 --threads 1': "needs hosts",
}
PROGRAMS = re.compile(r"(palpate|cmake|ctest|tools/[\w.-]+\.sh|build/\S+|seq|for|arm-none-eabi-g\+\+)(?=[ _/]|$)")


def commands_of(text):
    """The commands of a document: indented lines that begin with a program, continued where they end with a backslash."""
    found, fenced = [], False
    for line in re.sub(r" *\\\n +", " ", text).splitlines():
        if line.startswith("```"):
            fenced = not fenced
        if not fenced and line.startswith("    ") and PROGRAMS.match(line[4:]):
            found.append(re.sub(r"\s+#.*", "", line[4:]).strip())
    return found


def whole(pattern, command):
    return re.fullmatch(pattern, command) is not None


faults, documented = [], set()
listed = subprocess.run(["git", "-C", source, "ls-files", "-z", "*.md"], capture_output=True, text=True)
if listed.returncode != 0:
    print("skipped: no git repository")
    sys.exit()
for name in filter(None, listed.stdout.split("\0")):
    for command in commands_of((source / name).read_text(encoding="utf-8")):
        # A line that builds a program and runs it is two commands.
        parts = command.split(" && ") if re.match(r"(cmake|build)", command) else [command]
        documented.update(parts)
        for part in parts:
            places = ([step[0] for step in RUN if step[0] == part] + [test for pattern, test in ELSEWHERE if whole(pattern, part)] +
                      [file for pattern, file in BUILD if whole(pattern, part)] + [part] * (part in BY_HAND))
            if len(places) != 1:
                faults.append(f"{name}: '{part}' runs in {len(places)} of the lists of run_commands_test.py, not in one")
for command in [*[step[0] for step in RUN[1:]], *BY_HAND]:
    if command not in documented:
        faults.append(f"no document has '{command}'")
for pattern, test in ELSEWHERE:
    if not any(whole(pattern, command) for command in documented):
        faults.append(f"no document has a command like '{pattern}'")
    if complete and not any(re.search(test, name) for name in tests):
        faults.append(f"there is no test '{test}' for '{pattern}'")
for pattern, file in BUILD:
    text = (source / file).read_text(encoding="utf-8")
    if not any(re.search(pattern, line) for line in text.splitlines()):
        faults.append(f"{file} has no command like '{pattern}'")
if faults:
    raise SystemExit("\n".join(faults))


def label_ball(path):
    """A segmentation in NIfTI: a ball of 20 mm in voxels of 2 mm."""
    n, size = 32, 2.0
    header = bytearray(352)
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, 3, n, n, n, 1, 1, 1, 1)
    struct.pack_into("<2h", header, 70, 2, 8)  # unsigned bytes
    struct.pack_into("<8f", header, 76, 1, size, size, size, 0, 0, 0, 0)
    struct.pack_into("<2f", header, 108, 352, 1)
    header[123] = 2  # mm
    struct.pack_into("<2h", header, 252, 0, 1)
    for row in range(3):
        struct.pack_into("<4f", header, 280 + 16 * row, *[size * (row == column) for column in range(3)], 0)
    header[344:348] = b"n+1\0"
    centre = (n - 1) / 2
    voxels = bytes(int((x - centre) ** 2 + (y - centre) ** 2 + (z - centre) ** 2 < 100) for z in range(n) for y in range(n)
                   for x in range(n))
    path.write_bytes(gzip.compress(bytes(header) + voxels, mtime=0))


shutil.rmtree(folder, ignore_errors=True)
folder.mkdir(parents=True)
label_ball(folder / "ball.nii.gz")
block = (source / "tests/report/block.toml.in").read_text(encoding="utf-8")
(folder / "block.toml").write_text(block.replace("@BLOCK@", str(source / "tests/report/grooved_block.obj")), encoding="utf-8")
path = {**os.environ, "PATH": f"{palpate.parent}{os.pathsep}{os.environ['PATH']}"}
for command, expected, *copied in RUN:
    for old, new in copied:
        (folder / new).parent.mkdir(exist_ok=True)
        shutil.copy(folder / old, folder / new)
    if command.endswith("--out scene.toml"):
        (folder / "scene.toml").unlink(missing_ok=True)
    shorter = command
    for part, instead in SHORTER:
        shorter = shorter.replace(part, instead)
    run = subprocess.run(["bash", "-c", shorter], cwd=folder, capture_output=True, text=True, env=path)
    output = run.stdout + run.stderr
    if run.returncode != 0:
        raise SystemExit(f"'{command}' ends with {run.returncode}\n{output}")
    if not ((folder / expected).exists() if isinstance(expected, pathlib.Path) else expected in output):
        raise SystemExit(f"'{command}' gives no '{expected}'\n{output}")
print(f"{len(documented)} commands in documents, {len(RUN)} run here; {len(BY_HAND)} by hand")
