#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes a slab through faults of the machine: random kill -9, a full disk, a read-only folder, damaged files, a clock
that is set back. Nothing that was accepted is lost, every refusal names its file and the way out, and every bake ends
in the response file of an undisturbed one.
    tests/bake/faults.py build/release/bin/palpate --kills 100
Mounts need root, the clock needs libfaketime; a trial without them says so. Exit code 1 where something is wrong."""
import argparse, os, pathlib, random, re, shutil, struct, subprocess, sys, tempfile, time

HEADER = 64  # bytes of a journal before its first record (formats/journal/journal-file.md)
FAKETIME = pathlib.Path("/usr/lib/x86_64-linux-gnu/faketime/libfaketimeMT.so.1")


class Wrong(Exception):
    pass


def expect(condition, text):
    if not condition:
        raise Wrong(text)


def whole_records(journal):
    """Length of the part of a journal that holds whole records."""
    at = HEADER
    while at + 16 <= len(journal):
        end = at + 16 + struct.unpack_from("<I", journal, at)[0] + 8
        if end > len(journal):
            break
        at = end
    return min(at, len(journal))


class Bakes:
    """One scene, its undisturbed response file, and work folders."""

    def __init__(self, program, folder):
        self.program, self.folder = os.path.abspath(program), pathlib.Path(folder)
        self.run("synth", "slab", "--out", ".", "--scale", "0.5", "--friction", "0", "--tool-radius", "0.003",
                 "--depth", "0.001", "--spacing", "0.012")
        with open(self.folder / "scene.toml", "a") as scene:
            scene.write("normal_points = 4\n[solver]\nmesh_size = 1\ngrowth = 1\nmax_size = 0.025\ncheck_share = 0\n")
        begin = time.monotonic()
        self.build("whole")
        self.seconds = time.monotonic() - begin
        self.expected = (self.folder / "whole.palp").read_bytes()

    def command(self, name, *arguments):
        return [self.program, *arguments, "--quiet"] + (["--work", name] if name else [])

    def run(self, *arguments, work=None, code=0, says=()):
        """Runs the program; its messages. `code` and `says`: how it has to end."""
        done = subprocess.run(self.command(work, *arguments), cwd=self.folder, capture_output=True, text=True,
                              timeout=600)
        expect(done.returncode == code, f"{arguments} ended with {done.returncode}, not {code}: {done.stderr}")
        for part in says:
            expect(part in done.stderr, f"{arguments} does not say '{part}': {done.stderr}")
        return done.stderr

    def build(self, work, **options):
        return self.run("build", "scene.toml", "-o", work + ".palp", work=work, **options)

    def ends_as_expected(self, work):
        self.build(work)
        expect((self.folder / (work + ".palp")).read_bytes() == self.expected, work + " ended in another response file")

    def journals(self, work):
        return {f: f.read_bytes() for f in sorted((self.folder / work).rglob("*.journal"))}

    def copy(self, work):
        shutil.rmtree(self.folder / work, ignore_errors=True)
        shutil.copytree(self.folder / "whole", self.folder / work)
        return self.folder / work / "samples.journal"


def kills(bakes, count, randomly):
    """kill -9 in whole bakes, in shards and in merges, one after the other in one work folder."""
    runs = killed = finished = 0
    jobs = [("build", "scene.toml", "-o", "killed.palp"), ("bake", "scene.toml", "--shard", "1/2"),
            ("bake", "scene.toml", "--shard", "2/2"), ("merge", "scene.toml")]
    while killed < count:
        runs += 1
        expect(runs <= 20 * count, "the bakes end before they are killed")
        before = bakes.journals("killed") if (bakes.folder / "killed").exists() else {}
        child = subprocess.Popen(bakes.command("killed", *randomly.choice(jobs)), cwd=bakes.folder,
                                 stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        try:
            child.wait(randomly.uniform(0, 0.7 * bakes.seconds))
        except subprocess.TimeoutExpired:
            child.kill()
            killed += 1
        messages = child.communicate()[1].decode()
        # A merge ends with 4 while pairs are missing.
        expect(child.returncode in (-9, 0, 4), f"run {runs}: ended with {child.returncode}: {messages}")
        expect(child.returncode != 4 or "are missing" in messages, f"run {runs}: {messages}")
        after = bakes.journals("killed")
        for file, content in before.items():
            kept = content[:whole_records(content)]
            expect(after[file].startswith(kept), f"run {runs}: {file.name} lost records")
        if (bakes.folder / "killed.palp").exists():
            expect((bakes.folder / "killed.palp").read_bytes() == bakes.expected, f"run {runs}: another response file")
            finished += 1
            shutil.rmtree(bakes.folder / "killed")
            (bakes.folder / "killed.palp").unlink()
    bakes.ends_as_expected("killed")
    return f"{killed} of {runs} runs killed, {finished + 1} bakes ended in the same file"


def full_disk(bakes, randomly):
    """A file system that is full in the middle of the bake, then larger."""
    (bakes.folder / "disk").mkdir()
    # Pages of a manifest and of half of the journal.
    whole = bakes.folder / "whole"
    pages = [-(-(whole / name).stat().st_size // 4096) for name in ("manifest.json", "samples.journal")]
    kib = 4 * (pages[0] + pages[1] // 2)
    line = " ".join(bakes.command("disk/work", "build", "scene.toml", "-o", "disk/full.palp"))
    script = f"""mount -t tmpfs none disk -o size={kib}k || exit 125
{line}; code=$?
cp disk/work/samples.journal full.journal; mount -o remount,size=64m disk || exit 125
{line} || exit 124
cp disk/full.palp full.palp; cp disk/work/samples.journal resumed.journal; exit $code"""
    done = subprocess.run(["unshare", "-m", "sh", "-c", script], cwd=bakes.folder, capture_output=True, text=True)
    if done.returncode in (125, 1) and "palpate" not in done.stderr:
        return "not tried: this user may not mount"
    expect(done.returncode == 4, f"a full disk ended with {done.returncode}: {done.stderr}")
    expect("No space left on device" in done.stderr and "disk/work" in done.stderr, done.stderr)
    full = (bakes.folder / "full.journal").read_bytes()
    expect((bakes.folder / "resumed.journal").read_bytes().startswith(full[:whole_records(full)]), "records were lost")
    expect((bakes.folder / "full.palp").read_bytes() == bakes.expected, "another response file")
    return f"{kib} KiB: " + done.stderr.strip().splitlines()[-1][:100]


def read_only(bakes, randomly):
    """A work folder that cannot be written to."""
    journal = bakes.copy("closed")
    content = journal.read_bytes()
    journal.write_bytes(content[:len(content) // 2])  # something is left to do
    line = " ".join(bakes.command("closed", "bake", "scene.toml"))
    script = f"mount --bind closed closed && mount -o remount,bind,ro closed || exit 125\nexec {line}"
    done = subprocess.run(["unshare", "-m", "sh", "-c", script], cwd=bakes.folder, capture_output=True, text=True)
    if done.returncode in (125, 1) and "palpate" not in done.stderr:
        return "not tried: this user may not mount"
    expect(done.returncode == 4 and "Read-only file system" in done.stderr and "closed/" in done.stderr,
           f"ended with {done.returncode}: {done.stderr}")
    expect(journal.read_bytes() == content[:len(content) // 2], "the journal changed")
    bakes.ends_as_expected("closed")
    return done.stderr.strip()[:120]


def damaged_record(bakes, count, randomly):
    """A changed bit anywhere in a journal: refused with the way out, which is then taken."""
    content = (bakes.folder / "whole/samples.journal").read_bytes()
    cut = torn = 0
    for _ in range(count):
        at = randomly.randrange(HEADER, len(content))
        journal = bakes.copy("damaged")
        journal.write_bytes(content[:at] + bytes([content[at] ^ 1 << randomly.randrange(8)]) + content[at + 1:])
        done = subprocess.run(bakes.command("damaged", "fit", "scene.toml", "-o", "damaged.palp"), cwd=bakes.folder,
                              capture_output=True, text=True)
        if done.returncode == 2:
            expect("samples.journal: offset" in done.stderr, done.stderr)
            way_out = re.search(r"`(truncate -s \d+ '[^']*')`", done.stderr)
            expect(way_out, "no way out: " + done.stderr)
            subprocess.run(["sh", "-c", way_out[1]], cwd=bakes.folder, check=True)
            cut += 1
        else:  # in the last record: a torn tail, so that a pair has no outcome
            expect(done.returncode != 0 and "no outcome" in done.stderr, f"byte {at}: {done.returncode} {done.stderr}")
            torn += 1
        bakes.ends_as_expected("damaged")
    return f"{cut} bits refused by offset and mended by the command in the message, {torn} in the last record"


def damaged_files(bakes, randomly):
    """A manifest and an account that were cut short."""
    for name in ("manifest.json", "bake.json"):
        bakes.copy("cut")
        file = bakes.folder / "cut" / name
        file.write_bytes(file.read_bytes()[:-7])
        bakes.build("cut", code=2, says=["cut/" + name, "remov"])
        file.unlink()
        bakes.ends_as_expected("cut")
    return "manifest.json and bake.json: refused, removed as the message says"


def clock(bakes, randomly):
    """The clock goes back by a year between two runs and by a month within one."""
    if not FAKETIME.exists():
        return "not tried: no libfaketime (Debian: faketime)"
    journal = bakes.copy("clock")
    journal.write_bytes(journal.read_bytes()[:journal.stat().st_size // 2])
    setting = bakes.folder / "clock.setting"
    setting.write_text("-365d")
    environment = dict(os.environ, LD_PRELOAD=str(FAKETIME), FAKETIME_TIMESTAMP_FILE=str(setting),
                       FAKETIME_NO_CACHE="1", DONT_FAKE_MONOTONIC="1")
    year = subprocess.run(["date", "+%Y"], env=environment, capture_output=True, text=True).stdout
    expect(int(year) < time.gmtime().tm_year, "libfaketime does nothing")
    if subprocess.run([bakes.program, "--version"], env=environment, capture_output=True).returncode != 0:
        return "not tried: this build does not start with libfaketime (a sanitizer)"
    child = subprocess.Popen(bakes.command("clock", "build", "scene.toml", "-o", "clock.palp"), cwd=bakes.folder,
                             env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    time.sleep(0.4 * bakes.seconds)
    setting.write_text("-395d")
    messages = child.communicate(timeout=600)[1].decode()
    expect(child.returncode == 0, messages)
    expect((bakes.folder / "clock.palp").read_bytes() == bakes.expected, "another response file")
    return "set back by 365 days before and by 30 during the bake"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("palpate")
    parser.add_argument("--kills", type=int, default=100, help="runs to kill at a random moment")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    randomly = random.Random(arguments.seed)
    wrong = 0
    with tempfile.TemporaryDirectory(prefix="palpate-faults-") as folder:
        bakes = Bakes(arguments.palpate, folder)
        trials = [("kill -9", lambda b, r: kills(b, arguments.kills, r)), ("full disk", full_disk),
                  ("read-only folder", read_only),
                  ("damaged record", lambda b, r: damaged_record(b, max(3, arguments.kills // 5), r)),
                  ("damaged files", damaged_files), ("clock set back", clock)]
        for name, trial in trials:
            begin = time.monotonic()
            try:
                result = trial(bakes, randomly)
            except Wrong as error:
                wrong += 1
                result = "WRONG: " + str(error)
            print(f"{name:17} {time.monotonic() - begin:6.1f} s  {result}", flush=True)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
