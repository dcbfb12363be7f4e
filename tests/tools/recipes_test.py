# SPDX-License-Identifier: GPL-3.0-or-later
"""Follows the recipes of CONTRIBUTING.md word by word on copies of the files that they change, and compiles and runs the
result. Every path that the table of changes names must be there.

Usage: recipes_test.py SOURCE FOLDER COMPILER COMMAND_LIST_FOLDER EIGEN
"""
import pathlib
import re
import shutil
import subprocess
import sys

source, folder = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
compiler, command_list, eigen = sys.argv[3:6]
text = (source / "CONTRIBUTING.md").read_text(encoding="utf-8")
step = re.compile(r"^(?:Write `(?P<new>[^`]+)`|In `(?P<file>[^`]+)`, (?P<where>after|before) the line `(?P<line>[^`]+)`):\n\n"
                  r"```\w+\n(?P<block>.*?)^```$", re.M | re.S)


def follow(title):
    """Changes copies of files below `folder` as the recipe says; the changed files."""
    begin = text.index(f"### Recipe: {title}\n")
    end = re.compile(r"^##", re.M).search(text, begin + 4)
    recipe = text[begin:end.start()]
    steps = list(step.finditer(recipe))
    if not steps or len(steps) != recipe.count("```") // 2:
        raise SystemExit(f"{title}: {len(steps)} steps, {recipe.count('```') // 2} blocks of code")
    files = []
    for s in steps:
        name = s["new"] or s["file"]
        copy = folder / name
        if name not in files:
            files.append(name)
            copy.parent.mkdir(parents=True, exist_ok=True)
            if s["file"]:
                shutil.copy(source / name, copy)
        if s["new"]:
            if (source / name).exists():
                raise SystemExit(f"{name}: there is such a file already")
            copy.write_text(s["block"], encoding="utf-8")
            continue
        lines = copy.read_text(encoding="utf-8").splitlines(keepends=True)
        found = [k for k, line in enumerate(lines) if s["line"] in line]
        if len(found) != 1:
            raise SystemExit(f"{name}: {len(found)} lines have '{s['line']}', a recipe needs exactly one")
        lines.insert(found[0] + (s["where"] == "after"), s["block"])
        copy.write_text("".join(lines), encoding="utf-8")
    return files


def run(*command):
    result = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    if result.returncode != 0:
        raise SystemExit(" ".join(map(str, command)) + "\n" + result.stdout + result.stderr)
    return result.stdout


flags = ["-std=c++20", "-O0", "-Wall", "-Wextra", "-Werror"]
for path in (folder, source, source / "formats/include", source / "runtime/include", source / "runtime", command_list):
    flags += ["-I", path]
flags += ["-isystem", eigen]

# Paths of the table: those without NAME are there.
table = text[text.index("## Places of a change"):text.index("### Recipe:")]
rows = [row for row in table.splitlines() if row.startswith("| a")]
if len(rows) < 10:
    raise SystemExit(f"the table of changes has {len(rows)} rows")
for row in rows:
    for path in re.findall(r"`([\w./]*/[\w./]*)`", row):
        if "NAME" not in path and not (source / path).exists():
            raise SystemExit(f"CONTRIBUTING.md names {path}, which is not there")

shutil.rmtree(folder, ignore_errors=True)
follow("a gate of the solver")
run(compiler, *flags, folder / "precompute/solve/contact/gates.cpp", folder / "tests/solve/contact/gates_test.cpp", "-lgtest", "-lgtest_main",
    "-o", folder / "gates_test")
if "[       OK ] Gates.AContactMuchDeeperThanWideIsRefused" not in run(folder / "gates_test"):
    raise SystemExit("the recipe's test did not run")

follow("a response model to compare")
(folder / "check.cpp").write_text("""
#include "precompute/verify/baselines/power_law.hpp"
#include <cmath>
int main() {
  std::vector<palpate::Sample> samples(5);
  for (int k = 0; k < 5; ++k) {
    samples[k].deflection = {0, 0, 1e-3 * (k + 1)};
    samples[k].force = {0, 0, 200 * std::pow(1e-3 * (k + 1), 1.5)};
  }
  const palpate::verify::PowerLaw law = palpate::verify::fit_power_law(samples, "check");
  return std::abs(law.exponent - 1.5) < 1e-9 && std::abs(law.force({0, 0, 0.002}).z() / samples[1].force.z() - 1) < 1e-9 ? 0 : 1;
}
""", encoding="utf-8")
run(compiler, *flags, folder / "precompute/verify/baselines/power_law.cpp", source / "precompute/fit/laws/pair_samples.cpp",
    folder / "check.cpp", "-o", folder / "check")
run(folder / "check")
run(compiler, *flags, "-fsyntax-only", folder / "tools/bench/bench_models.cpp")
if "power_law.cpp" not in (folder / "precompute/verify/baselines/CMakeLists.txt").read_text(encoding="utf-8"):
    raise SystemExit("the recipe does not build its file")
print("2 recipes followed")
