"""Do tests notice wrong code?  Signs, factors and indices are changed one at a time, and tests run until one fails.

    tests/run mutants [--number N] [--seed N]

changes the sources of this checkout, which has to be clean, and restores them: use a work tree of its own.  The output
is a line for each change, with the test that detected it.
"""

from __future__ import annotations

import argparse
import os
import random
import re
import subprocess
import sys
from pathlib import Path

from support.running import OPEN_MPI_ENVIRONMENT, ROOT, TREE_BUILD

SOURCES, UNIT = ROOT / "src" / "GEARQUAT", ROOT / "build" / "unit"
#: a pattern in a line, and its replacement
CHANGES = (
    (r" \+ ", " - "),
    (r" - ", " + "),
    (r" \+= ", " -= "),
    (r" -= ", " += "),
    (r" \* ", " * 1.01 * "),
    (r" / ", " / 1.01 / "),
    (r"\b0\.5\b", "0.505"),
    (r"\[0\]", "[1]"),
    (r"\[2\]", "[1]"),
)
#: lines with messages, comments, loops over pointers and sizes of arrays are not changed
LEFT_OUT = re.compile(r"[\"'#]|//|^ *[/*]|\bfor \(|static_assert|sizeof|FLERR|size_t|begin\(\)|operator|int .*\[\d\]")


def candidates() -> list[tuple[Path, int, str]]:
    """File, line number and changed line, for every possible change."""
    found = []
    for path in sorted([*SOURCES.glob("*.h"), *SOURCES.glob("*.cpp")]):
        comment = False
        for number, line in enumerate(path.read_text().splitlines()):
            comment = (comment or "/*" in line) and "*/" not in line
            if comment or LEFT_OUT.search(line) or not line.startswith("  "):
                continue
            found += [(path, number, re.sub(old, new, line, count=1)) for old, new in CHANGES if re.search(old, line)]
    return found


def passes(*command: object, **settings: object) -> tuple[bool, str]:
    """True if a command succeeds, and its output."""
    done = subprocess.run([*map(str, command)], cwd=ROOT, capture_output=True, text=True, **settings)
    return done.returncode == 0, done.stdout + done.stderr


def unit_tests(source: Path) -> list[str]:
    """Programs of the kernel's tests; programs that name the source's header come first."""
    tests, header = sorted((ROOT / "tests" / "unit").glob("test_*.cpp")), source.with_suffix(".h").name
    word = source.stem.removeprefix("gear_quat_")
    return [path.stem for path in sorted(tests, key=lambda path: (word not in path.stem, header not in path.read_text()))]


def noticed_by(path: Path) -> str:
    """The first test that fails, "" if no test fails; "-" for code that does not compile."""
    for name in unit_tests(path):
        was = (UNIT / name).stat().st_mtime_ns if (UNIT / name).exists() else 0
        if not passes("ninja", "-C", UNIT, name)[0]:
            return "-"
        if (UNIT / name).stat().st_mtime_ns == was:
            continue
        try:
            if not passes(UNIT / name, "--gtest_fail_fast", timeout=300)[0]:
                return name
        except subprocess.TimeoutExpired:
            return f"{name}, which did not end"
    if not passes("cmake", "--build", TREE_BUILD, "-j", os.cpu_count())[0]:
        return "-"
    for reference in (ROOT / "tests" / "lammps").glob("fix-timestep-*.yaml"):  # seconds, and they notice most
        harness = TREE_BUILD / "test_fix_timestep", reference, "--gtest_filter=FixTimestep.plain"
        if not passes(*harness, env=os.environ | OPEN_MPI_ENVIRONMENT)[0]:
            return reference.name
    words = ["-m", "tree", "-x", "-q", "-p", "no:cacheprovider", "-n", "2", "--dist", "loadfile"]
    passed, said = passes(sys.executable, "-m", "pytest", *words, "tests/lammps")
    failed = re.search(r"^(?:FAILED|ERROR) (\S+)", said, re.MULTILINE)
    return "" if passed else failed[1] if failed else said[-500:]


def main() -> int:
    """The number of changes that no test detected."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--number", type=int, default=30)
    parser.add_argument("--seed", type=int, default=1)
    wanted = parser.parse_args()
    if passes("git", "status", "--porcelain", "src")[1]:
        sys.exit("src has changes that are not committed")
    chosen, caught, missed = candidates(), 0, 0
    random.Random(wanted.seed).shuffle(chosen)
    for path, line, changed in chosen:
        if caught + missed == wanted.number:
            break
        text = path.read_text()
        lines = text.splitlines()
        lines[line] = changed
        path.write_text("\n".join(lines) + "\n")
        try:
            test = noticed_by(path)
        finally:
            path.write_text(text)
        if test != "-":
            caught, missed = caught + bool(test), missed + (not test)
            print(f"{path.name}:{line + 1}: {changed.strip()}\n   {test or 'NOT NOTICED'}", file=sys.stderr, flush=True)
    print(caught, missed, 0)
    return missed


if __name__ == "__main__":
    sys.exit(main() > 0)
