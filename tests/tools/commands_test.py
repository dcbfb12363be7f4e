# SPDX-License-Identifier: GPL-3.0-or-later
"""Commands in the tracked documents exist: sub-commands and options of `palpate` by its own help, scripts in the tree,
presets in CMakePresets.json, and tests that `ctest -R` names in the list of ctest.

Usage: commands_test.py SOURCE PALPATE BUILD
"""
import functools
import json
import pathlib
import re
import shlex
import subprocess
import sys

source, palpate = pathlib.Path(sys.argv[1]), sys.argv[2]
listing = subprocess.run(["ctest", "--test-dir", sys.argv[3], "-N"], capture_output=True, text=True, check=True).stdout
tests = re.findall(r"^ +Test +#\d+: (.*)$", listing, re.M)
# The tests of a program are listed once it is built.
complete = "NOT_BUILT" not in listing
presets = json.loads((source / "CMakePresets.json").read_text(encoding="utf-8"))
overview = subprocess.run([palpate, "--help"], capture_output=True, text=True, check=True).stdout
commands = set(re.findall(r"^  ([a-z]+)  ", overview, re.M))
kinds = {"cmake": "configurePresets", "ctest": "testPresets"}


@functools.lru_cache(None)
def options_of(command):
    """The options of a sub-command by its help; None where there is no such sub-command."""
    if command and command != "COMMAND" and command not in commands:
        return None
    arguments = [palpate] + ([command] if command in commands else []) + ["--help"]
    text = subprocess.run(arguments, capture_output=True, text=True, check=True).stdout
    return set(re.findall(r"(?<![\w-])--[a-z][\w-]*", text))


def faults_of(words):
    """The faults of a command, given as words."""
    program = words[0]
    if program == "palpate":
        command = words[1] if len(words) > 1 and not words[1].startswith("-") else ""
        options = options_of(command)
        if options is None:
            return [f"palpate has no command '{command}'"]
        return [f"palpate {command} has no option {word}" for word in words[1:]
                if word.startswith("--") and word.split("=")[0] not in options | options_of("")]
    if program.startswith("tools/"):
        return [] if (source / program).exists() else [f"there is no {program}"]
    found = []
    if program in kinds and "--preset" in words[:-1]:
        preset = words[words.index("--preset") + 1]
        if preset not in [p["name"] for p in presets[kinds[program]]]:
            found.append(f"{program} has no preset '{preset}'")
    if program == "ctest" and "-R" in words[:-1]:
        pattern = words[words.index("-R") + 1]
        if pattern != "NAME" and complete and not any(re.search(pattern, name) for name in tests):
            found.append(f"no test matches '{pattern}'")
    return found


for wrong in ("palpate nothing", "palpate build --nothing", "tools/nothing.sh", "cmake --preset nothing", "ctest --preset nothing",
              *(["ctest -R NothingOfTheKind"] if complete else [])):
    if not faults_of(wrong.split()):
        raise SystemExit(f"no fault found in '{wrong}'")

checked, faults = 0, []
listed = subprocess.run(["git", "-C", source, "ls-files", "-z", "*.md"], capture_output=True, text=True)
if listed.returncode != 0:
    print("skipped: no git repository")
    sys.exit(0)
for name in filter(None, listed.stdout.split("\0")):
    for number, line in enumerate((source / name).read_text(encoding="utf-8").splitlines(), 1):
        quoted = [line] if line.startswith("    ") else re.findall(r"`((?:palpate|ctest|cmake|tools/[\w.-]+) [^`]*)`", line)
        for text in quoted:
            for part in re.split(r"&&|\|", text.split(" #")[0]):
                try:
                    words = shlex.split(part)
                except ValueError:
                    continue
                if not words or not re.match(r"(palpate|ctest|cmake)$|tools/", words[0]):
                    continue
                checked += 1
                faults += [f"{name}:{number}: {fault}" for fault in faults_of(words)]
print("\n".join(faults + [f"{checked} commands, {len(faults)} faults"]))
sys.exit(1 if faults or checked == 0 else 0)
