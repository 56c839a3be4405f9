"""Running a program: errors are told, time is limited, nothing is left behind."""

import os
import time

import pytest

from benchmarks.engine.runner import LammpsError, find_lmp, run

PROGRAM = """#!/bin/sh
# stands in for lmp: -in DECK -log LOG -nocite; the deck is a shell script
. ./$2
"""


@pytest.fixture
def fake(tmp_path):
    """A program that runs its deck as a shell script, and a maker of deck and log."""
    program = tmp_path / "lmp"
    program.write_text(PROGRAM)
    program.chmod(0o755)

    def job(name, script):
        (tmp_path / name).write_text(script)
        return tmp_path / name, tmp_path / f"log.{name}"

    return str(program), job


def alive(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return open(f"/proc/{pid}/stat").read().split()[2] != "Z"


def gone(pid):
    """Whether a process ends within two seconds."""
    for _ in range(100):
        if not alive(pid):
            return True
        time.sleep(0.02)
    return False


def test_arguments_and_steps(fake):
    lmp, job = fake
    seen = []
    deck = 'echo "$@" > "$4"\necho "  Step  Time"\necho " 5 0.5 1"\necho " 10 1 2"\n'
    path, log = job("good", deck)
    run(path, log, {"dt": 0.1}, lmp, on_step=seen.append)
    assert seen == [5, 10]
    assert log.read_text().split() == [
        "-in", "good", "-log", str(log), "-nocite", "-var", "dt", "0.1",
    ]  # fmt: skip


def test_error_is_told_with_the_last_lines(fake):
    lmp, job = fake
    with pytest.raises(LammpsError, match="(?s)log.bad: exit code 3.*ERROR: no such fix"):
        run(*job("bad", "echo ERROR: no such fix\nexit 3\n"), lmp=lmp)


def test_timeout_ends_the_whole_group(fake, tmp_path):
    lmp, job = fake
    made = job("slow", f"sleep 60 &\necho $! > {tmp_path}/child\nwait\n")
    begin = time.monotonic()
    with pytest.raises(LammpsError, match="not finished after 0.5 s"):
        run(*made, lmp=lmp, timeout=0.5)
    assert time.monotonic() - begin < 10
    assert gone(int((tmp_path / "child").read_text()))


def test_missing_program_is_named():
    with pytest.raises(LammpsError, match="/nowhere/lmp"):
        find_lmp("/nowhere/lmp")
