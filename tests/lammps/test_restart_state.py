"""All state is in a restart file: the state itself is compared, not only the trajectory after it.

Every object lists the members that decide about later steps in one function fields(), by which files are written
and read (gear_quat_fields.h).  A file that is read and written again at once has the same bits; `run 0` prints
the same numbers, and so does each of the next steps.
"""

import re
import struct

import numpy as np
import pytest
from support.constant_pressure import REPULSIVE, apart, ends as pressed_ends, pressed, trimers
from support.scenes import FORMULATIONS, one_after_the_other

MAGIC = struct.pack("d", float(int.from_bytes(b"gearquat", "big")))
STEPS, MORE = 60, 20

TEMP, SEPARATE = "temp 0.7 0.7 0.8", "temp 0.6 0.9 0.8 thermostat separate tchain 2"
TOLERANCE, LANGEVIN = "tolerance 1e-6", "langevin 0.7 0.9 0.2 4711"
MODES = [
    "",
    "values 7 compensate yes",
    "values 4 corrector gear",
    "values 8 corrector gear passes 1",
    "values 12",
    TOLERANCE,
    TEMP,
    SEPARATE,
    f"{TEMP} {TOLERANCE}",
    "isokinetic total",
    "isokinetic separate rescale no",
    "iso 0.3 0.3 1.0",
    f"iso 0.3 0.9 1.0 {TEMP}",
    f"aniso 0.3 0.3 1.0 {SEPARATE}",
    f"x 0.3 0.9 1.0 y 0.5 -0.2 0.7 {SEPARATE} pchain 2",
    f"iso 0.3 0.3 0.5 {TOLERANCE} energy",
    f"aniso 0.3 0.3 0.5 {TEMP} {TOLERANCE}",
    f"tri 0.3 0.3 1.0 {SEPARATE}",
    LANGEVIN,
    f"iso 0.3 0.9 1.0 {LANGEVIN}",
]
#: beside keywords of other modes the formulation is momentum, or with isokinetic first
ALONE = MODES[:5]
CASES = [(f"formulation {f}", mode) for f in FORMULATIONS for mode in ALONE]
CASES = [(f, mode) for f, mode in CASES if ("first" if "12" in mode else "momentum" if "passes" in mode else "none") not in f]
CASES += [("formulation first" if "isokinetic" in mode else "", mode) for mode in MODES if mode not in ALONE]
SPAN = f"start 0 stop {STEPS + MORE}"


@pytest.fixture(autouse=True)
def data(tmp_path):
    trimers(tmp_path / "data.trimers")
    trimers(tmp_path / "data.tilted", change=((1, 0.05, 0), (0, 1, 0.03), (0, 0, 1)))


def deck(words, run, file=None):
    box = "read_data data.tilted" if "tri " in words else "read_data data.trimers"
    return pressed(words, pair=REPULSIVE, thermo=1, run=run, box=f"read_restart {file}" if file else box)


def block(path):
    """The numbers of the fix in a restart file: count and numbers."""
    content = path.read_bytes()
    assert content.count(MAGIC) == 1
    at = content.index(MAGIC) + 16
    (count,) = struct.unpack_from("d", content, at)
    return struct.unpack_from(f"{int(count) + 1}d", content, at)


@pytest.mark.parametrize("formulation, mode", CASES)
def test_all_state_is_written_and_read(lmp_tree, formulation, mode):
    words = f"{formulation} {mode}"
    if "compensate" in mode and "first" in formulation:
        words += " passes 1"
    on = f"run 0 {SPAN}\nrun {MORE} {SPAN}"
    decks = [
        deck(words, f"run {STEPS} {SPAN}\nwrite_restart one\n{on}"),
        deck(words, f"write_restart two\n{on}", "one"),
        deck(words, on, "two"),
    ]
    result = lmp_tree.succeed(one_after_the_other(decks))
    one, two = (lmp_tree.folder / name for name in ("one", "two"))
    assert block(one) == block(two)
    assert len(block(one)) > 20
    if "tri " not in mode:  # LAMMPS converts positions in a tilted box whenever it writes a file
        assert one.read_bytes() == two.read_bytes()
    first, *others = result.thermo
    assert first["Step"][-1] == STEPS
    assert len(others) == 6
    for n, table in enumerate(others):
        for column, right in others[n % 2].items():
            near = dict(rel=1e-11, abs=1e-12) if "tri " in mode else dict(rel=1e-15, abs=0)  # one rounding
            assert table[column] == pytest.approx(right, **near), column
    assert "rebuilt" not in result.words


#: modes of equal steps, whose results agree on any ranks
EQUAL = [f"{f} {mode}" for f, mode in CASES if TOLERANCE not in mode]
#: each mode with one formulation
SOME = [of[k % len(of)] for k, of in enumerate([f"{f} {m}" for f, m in CASES if m == mode] for mode in MODES if TOLERANCE not in mode)]


def test_restarts_on_several_ranks_and_ranks_agree(lmp_tree):
    """Runs continue bit for bit from files that command restart writes during a run, and write_restart between runs."""
    ends = {}
    for ranks, chosen in ((1, EQUAL), (2, SOME), (4, SOME[::3])):
        decks = []
        for k, words in enumerate(chosen):
            words += " passes 1" * ("compensate" in words and "first" in words)
            wholes = f"restart 30 {k}.*\nrun 60 {SPAN}", f"run 30 {SPAN}\nwrite_restart {k}.30\nrun 30 {SPAN}"
            # this also determines the steps with new neighbor lists
            rests = f"restart 30 then.*\nrun 30 {SPAN}", f"run 30 {SPAN}"
            for file, run in ((None, wholes[k % 2]), (f"{k}.30", rests[k % 2])):
                # the grid of ranks that LAMMPS chooses depends on the edges
                decks.append(deck(words, run, file).replace("processors * * *", "processors 1 1 *"))
        _, ends[ranks] = pressed_ends(lmp_tree, decks, ranks)
        for k, words in enumerate(chosen):
            whole, again = ends[ranks][2 * k : 2 * k + 2]
            # a file has converted positions in a tilted box; with keyword langevin one rounding differs
            assert apart(whole, again) <= (1e-13 if re.search("tri |langevin", words) else 0.0), words
            assert apart(whole, ends[1][2 * EQUAL.index(words)]) < 1e-10, words


# --- other settings -------------------------------------------------------------------------------

NEW = "written with other settings of {}; poses"
CHANGED = "a target, a damping time or the degrees of freedom differ from those of the last steps"
#: words of the run that writes a file and of the run that reads it, and what the log says
OTHERS = [
    ("values 6 compensate yes", "values 8", "with other settings of values, compensate; poses"),
    ("values 8", "values 6 compensate yes", "with other settings of values, compensate; poses"),
    ("", "formulation second", NEW.format("formulation")),
    ("formulation second", "formulation first", NEW.format("formulation")),
    ("formulation first", "", NEW.format("formulation")),
    ("formulation first isokinetic total", "formulation first isokinetic separate", NEW.format("isokinetic")),
    ("formulation first isokinetic total", "formulation first", NEW.format("isokinetic")),
    (TEMP, f"{TEMP} thermostat separate", NEW.format("thermostat")),
    (TEMP, f"{TEMP} tchain 4", NEW.format("tchain")),
    (TEMP, "", NEW.format("temp")),
    (TEMP, "temp 0.7 0.7 0.9", CHANGED),
    (f"{TEMP} tolerance 1e-9", "temp 0.9 0.9 0.8 tolerance 1e-9", CHANGED),
    (f"aniso 0.3 0.3 1.0 {TEMP}", f"iso 0.3 0.3 1.0 {TEMP}", "iso, aniso, tri, x, y, z, xy, xz, yz or couple"),
    (f"iso 0.3 0.3 1.0 {TEMP}", f"iso 0.3 0.3 1.0 {TEMP} pchain 1", NEW.format("pchain")),
    (f"iso 0.3 0.3 1.0 {TEMP}", f"iso 0.3 0.3 0.6 {TEMP}", CHANGED),
    ("force 1 off on on", "force 2 off on on", "turn off other components than in the run that wrote"),
    ("corrector gear values 8", "corrector tuned values 8", NEW.format("corrector")),
    ("corrector tuned values 8", "corrector gear values 8", NEW.format("corrector")),
]


@pytest.mark.parametrize("before, after, said", OTHERS)
def test_other_settings_than_in_the_file(lmp_tree, before, after, said):
    """Histories start again, and a message names the reason; energy is conserved."""
    decks = [deck(before, f"run {STEPS}\nwrite_restart one\nrun {MORE}"), deck(after, f"run {MORE}", "one")]
    result = lmp_tree.succeed(one_after_the_other(decks))
    told = result.words.partition("Reading restart file")[2]
    assert said in told
    assert "start of order" in told or "tolerance" in after
    energies = "PotEng", "f_move[1]", "f_move[2]"
    whole, other = (sum(np.array(table[name]) for name in energies) for table in result.thermo[1:])
    assert other[0] == pytest.approx(whole[0], rel=1e-7)
    if not re.search("temp|iso|force", before + after):
        assert np.ptp(other) < 1e-6


# --- files of other releases --------------------------------------------------------------------


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("number, other", [(0, 1.0), (1, 6.0), (1, 99.0)])
def test_files_of_other_releases_are_refused(lmp_tree, ranks, number, other):
    """Files of 0.2.0 begin with the formulation, 0 or 1.  The remedy in the message helps."""
    lmp_tree.succeed(deck(TEMP, "run 5\nwrite_restart one"))
    file = lmp_tree.folder / "one"
    content = file.read_bytes()
    at = content.index(MAGIC) + 8 * number
    file.write_bytes(content[:at] + struct.pack("d", other) + content[at + 8 :])
    again = deck(TEMP, "run 5", "one")
    result = lmp_tree.refuse(again, "are from another release of GEARQUAT", ranks=ranks)
    assert len(set(result.errors)) == 1
    assert "the data of fix move" in result.errors[0]
    lmp_tree.succeed(re.sub(r"\bmove\b|(?<=f_)move", "other", again), ranks=ranks)


@pytest.mark.parametrize("ranks", [1, 2])
def test_damaged_data_are_refused(lmp_tree, ranks):
    lmp_tree.succeed(deck(TEMP, "run 5\nwrite_restart one"))
    file = lmp_tree.folder / "one"
    content = file.read_bytes()
    at = content.index(MAGIC) + 16
    (count,) = struct.unpack_from("d", content, at)
    file.write_bytes(content[:at] + struct.pack("d", count - 1.0) + content[at + 8 :])
    message = "the data of fix move in the restart file are damaged"
    lmp_tree.refuse(deck(TEMP, "run 5", "one"), message, ranks=ranks)
