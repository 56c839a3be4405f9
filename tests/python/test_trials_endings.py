"""Early ends of trials: bodies that leave the box, Ctrl-C, signals; and the folder of results."""

import json
import os
import signal
import subprocess
import sys
import sysconfig
import time
from pathlib import Path

import pytest
from click.testing import CliRunner
from support.clumps import FOR_GEAR

from lammps_gearquat.commands.cost import cost as cost_command
from support.running import processes_that_mention

SMALL = {"region box block -30 30 -30 30 -30 30": "region box block -2 5 -2 5 -2 5"}
WALLS, FREE = "boundary f f f", "boundary m m m"


def runs(command, *words):
    return CliRunner().invoke(command, [str(word) for word in words])


# --- bodies that leave ------------------------------------------------------------------------------
def test_cost_of_bodies_that_leave_the_box_later(make_deck, tmp_path):
    """Events after --time do not matter."""
    words = ["--budget", 12, "--time", 0.2, "--error", 1e-5, "--timings", 1, "--out", tmp_path / "out"]
    found = runs(cost_command, make_deck(**SMALL, **FOR_GEAR), *words)
    assert found.exit_code == 0, found.output


# --- signals ------------------------------------------------------------------------------------------
def workers(folder):
    """Command lines of LAMMPS whose socket is in ``folder``."""
    return processes_that_mention(f"lammps_gearquat.trials.process {folder}")


def wait_until(condition, seconds=60.0):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.1)


@pytest.fixture
def started(make_deck, tmp_path):
    """A long run of gearquat cost, while LAMMPS is running; its processes have sockets in the folder."""
    begun = []

    def start(*words):
        program = Path(sysconfig.get_path("scripts")) / "gearquat"
        free = {WALLS: FREE, "velocity all create 0.5": "velocity all create 0.01"}
        command = [program, "cost", make_deck(**free, **FOR_GEAR), "--time", "1e5", "--out", tmp_path / "out", *words]
        environment = {**os.environ, "TMPDIR": str(tmp_path)}
        words = list(map(str, command))
        pipes = dict(env=environment, stderr=subprocess.PIPE, text=True)
        # in the background a shell has interrupts ignored
        begun.append(
            subprocess.Popen(words, **pipes, preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
        )
        wait_until(lambda: workers(tmp_path))
        time.sleep(1.0)
        return begun[0]

    yield start
    for process in begun:
        process.kill()
        process.communicate()


@pytest.mark.parametrize("words", [[], ["--until", "1"]])
@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM])
def test_a_command_that_is_interrupted(started, tmp_path, words, sent):
    """The command prints one line about stored results, and leaves no process and no folder."""
    process = started(*words)
    process.send_signal(sent)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 130
    assert f"Interrupted: trials are not kept, and nothing was written to {tmp_path / 'out'}" in said
    assert "Traceback" not in said and not (tmp_path / "out").exists()
    assert not workers(tmp_path) and not list(tmp_path.glob("gearquat-*"))


#: a trial of 10^9 steps, in one segment
ENDLESS = """
import sys
from lammps_gearquat.trials.measure import Deck
with Deck(sys.argv[1], ranks=int(sys.argv[2])) as deck:
    print("begins", flush=True)
    deck.run(None, [10**9], 1e-6)
"""


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_caller_that_is_killed_leaves_no_lammps(make_deck, tmp_path, ranks):
    words = [sys.executable, "-c", ENDLESS, make_deck(), ranks]
    environment = {**os.environ, "TMPDIR": str(tmp_path)}
    with subprocess.Popen(list(map(str, words)), env=environment, stdout=subprocess.PIPE, text=True) as caller:
        assert caller.stdout.readline() == "begins\n"
        time.sleep(1.0)
        begun = workers(tmp_path)
        caller.kill()
    assert begun
    wait_until(lambda: not workers(tmp_path), 20.0)


# --- folders ------------------------------------------------------------------------------------------
def test_results_of_another_deck_and_of_other_options_are_kept(make_deck, tmp_path):
    path, out = make_deck(), tmp_path / "out"
    words = ["--until", 1, "--time", 0.4, "--out", out]
    assert runs(cost_command, path, *words).exit_code == 0
    settings = json.loads((out / "settings.json").read_text())
    assert (settings["deck"], settings["time"]) == (str(path), 0.4)
    before = {file: file.read_bytes() for file in out.iterdir()}

    def refused(path, *words):
        found = runs(cost_command, path, *words)
        assert found.exit_code == 1 and {file: file.read_bytes() for file in out.iterdir()} == before
        return found.output

    other = tmp_path / "in.other"
    other.write_text(path.read_text())
    assert "out has results of other settings (the deck): another --out is required" in refused(other, *words)
    assert "settings (--var, --until): another" in refused(path, *words, "--var", "k2", "1", "--until", 2)
    again = runs(cost_command, path, *words)
    assert again.exit_code == 0 and f"These results replace the earlier ones in {out}." in again.stderr
    path.write_text(path.read_text() + "# changed\n")
    before = {file: file.read_bytes() for file in out.iterdir()}
    assert "settings (the deck was rewritten): another" in refused(path, *words)
