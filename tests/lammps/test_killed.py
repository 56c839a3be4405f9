"""A run that loses a process: its files are complete, and the continued run is the same as an uninterrupted run."""

import os
import signal
import time
from pathlib import Path

import pytest
from support.paper_case import Case1, end
from support.scenes import restarted

from lammps_gearquat.launch import processes_of_session

AGAIN = 500  # steps after the restart
NAMES = ("even", "odd")


def ranks_of(session):
    """Processes of LAMMPS itself, not of its launcher."""
    return sorted(
        process
        for process in processes_of_session(session)
        if Path(f"/proc/{process}/comm").read_text().strip() == "lmp"
    )


def killer(folder, rank, delay):
    """Kills a rank a while after the first restart files exist, at an arbitrary point."""

    def kill(session):
        limit = time.monotonic() + 60.0
        while not all((folder / name).exists() for name in NAMES):
            assert time.monotonic() < limit
            time.sleep(0.01)
        time.sleep(delay)
        os.kill(ranks_of(session)[rank], signal.SIGKILL)

    return kill


def newest_first(folder):
    return sorted(NAMES, key=lambda name: (folder / name).stat().st_mtime_ns, reverse=True)


@pytest.mark.parametrize("formulation, rank, delay", [("first", 0, 0.1), ("second", 1, 0.3)])
def test_a_killed_rank(lmp_tree, examples, formulation, rank, delay):
    """Restart files every step, two in turn: the rank is killed while one of them is written."""
    case1 = Case1(lmp_tree, examples, formulation, ranks=2)
    # no atom migrates, which would change the order of sums
    case1.variables["dt"] = 1e-4
    folder = lmp_tree.folder
    result = lmp_tree.run(
        case1.scene.replace("run ${steps}", "restart 1 even odd\nrun 10000000"),
        case1.variables,
        ranks=2,
        meanwhile=killer(folder, rank, delay),
    )
    assert result.returncode != 0

    # LAMMPS refuses an incomplete file; this can only be the file that was being written
    for name in newest_first(folder):
        scene = restarted(case1.scene.replace("run ${steps}", f"run {AGAIN}"), name)
        again = lmp_tree.run(scene, case1.variables, ranks=2)
        if again.returncode == 0:
            break
        assert name == newest_first(folder)[0], again.output
        assert "restart file" in again.output
    assert again.returncode == 0, again.output
    begin = int(again.thermo[0]["Step"][0])
    assert begin > 1
    whole = case1.run(f"run {begin + AGAIN}", every=begin + AGAIN)
    assert (end(again) == end(whole)).all()  # bit for bit
    other = case1.run(f"run {begin + AGAIN - 1}", every=begin + AGAIN - 1)
    assert (end(again) != end(other)).all()
