"""Running a program: errors are told, time is limited, nothing is left behind."""

import os
import time

import pytest

from benchmarks.engine.lammps_runner import Job, LammpsError, find_lmp, run, run_many

PROGRAM = """#!/bin/sh
# stands in for lmp: -in DECK -log LOG -nocite; the deck is a shell script
. ./$2
"""


@pytest.fixture
def fake(tmp_path):
    """A program that runs its deck as a shell script, and a maker of such jobs."""
    program = tmp_path / "lmp"
    program.write_text(PROGRAM)
    program.chmod(0o755)

    def job(name, script, steps=0, **variables):
        (tmp_path / name).write_text(script)
        return Job(tmp_path / name, tmp_path / f"log.{name}", variables, steps)

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
    made = job("good", deck, dt=0.1)
    run(made, lmp, on_step=seen.append)
    assert seen == [5, 10]
    assert made.log.read_text().split() == [
        "-in", "good", "-log", str(made.log), "-nocite", "-var", "dt", "0.1",
    ]  # fmt: skip


def test_error_is_told_with_the_last_lines(fake):
    lmp, job = fake
    with pytest.raises(LammpsError, match="(?s)log.bad: exit code 3.*ERROR: no such fix"):
        run(job("bad", "echo ERROR: no such fix\nexit 3\n"), lmp)


def test_timeout_ends_the_whole_group(fake, tmp_path):
    lmp, job = fake
    made = job("slow", f"sleep 60 &\necho $! > {tmp_path}/child\nwait\n")
    begin = time.monotonic()
    with pytest.raises(LammpsError, match="not finished after 0.5 s"):
        run(made, lmp, timeout=0.5)
    assert time.monotonic() - begin < 10
    assert gone(int((tmp_path / "child").read_text()))


def test_many_add_up_and_an_error_ends_them(fake):
    lmp, job = fake
    done = []
    jobs = [job(f"job{k}", "echo 50 1 1\necho 100 1 1\n", steps=100) for k in range(5)]
    run_many(jobs, lmp, workers=2, progress=done.append)
    assert sum(done) == 500
    begin = time.monotonic()
    endless = job("endless", "while true; do echo 1 1 1; sleep 0.05; done\n", steps=1000)
    with pytest.raises(LammpsError, match="exit code 1"):
        run_many([endless, job("bad", "exit 1\n")], lmp, workers=2)
    assert time.monotonic() - begin < 10


def test_missing_program_is_named():
    with pytest.raises(LammpsError, match="/nowhere/lmp"):
        find_lmp("/nowhere/lmp")
