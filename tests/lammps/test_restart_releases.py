"""Restart files of every release can be read: the run continues as in that release.

The files and their continuations are in `restarts`, see make_restarts.py.  If a
release or another compiler computes the same in another order, numbers differ by rounding,
which grows to less than 1e-12 of the largest one in a column within 20 steps.
"""

import json
import struct
from pathlib import Path

import numpy as np
import pytest
from make_restarts import CASES, FOLDER, go_on

RELEASES = sorted(path.name for path in FOLDER.iterdir())
ROUNDING = 1e-12
ANEW = "histories are rebuilt"
SUMS = (
    "does not have the kinetic energies of past steps that temp needs "
    "(its friction and energy are kept)"
)

# Later releases with different methods, and their differences after 20 steps. 0.3.0 integrated chains as separate histories: the two
# methods differ by their errors.
OTHERWISE = {("0.3.0", "temp"): 1e-7}


def stored(release, name):
    return json.loads((FOLDER / release / "continued.json").read_text())[name]


def columns(output, rows=slice(None)):
    """Of thermo output, and of the last frame: lists of numbers."""
    thermo = {name: np.array(column)[rows] for name, column in output["thermo"].items()}
    return thermo | dict(enumerate(np.array(output["frame"]).T))


def agree(found, right, tolerance):
    """True if all numbers agree, relative to the largest one of their column."""
    assert found.keys() == right.keys()
    return all(
        np.abs(found[name] - right[name]).max() <= tolerance * np.abs(right[name]).max()
        for name in right
    )


def expect(found, right, tolerance):
    """The results agree, and disagree if one number is 1 % off."""
    assert agree(found, right, tolerance)
    for name, column in right.items():
        n = np.abs(column).argmax()
        if column[n] != 0.0:
            changed = column.copy()
            changed[n] *= 1.01
            assert not agree(found, {**right, name: changed}, tolerance)


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("release", RELEASES)
def test_a_file_goes_on_as_in_its_release(lmp_tree, release, name):
    output, result = go_on(lmp_tree, name, FOLDER / release / f"{name}.restart")
    right = stored(release, name)
    tolerance = OTHERWISE.get((release, name), ROUNDING)
    expect(columns(output), columns(right), tolerance)
    said = "WARNING: Fix gear/quat" in result.words or ANEW in result.words
    assert said == (tolerance != ROUNDING)


def test_chains_of_0_3_0_keep_friction_and_energy(lmp_tree):
    """Before the first step the output is the same as in 0.3.0; then past sums start again."""
    output, result = go_on(lmp_tree, "temp", FOLDER / "0.3.0" / "temp.restart")
    before = columns(output, slice(1)), columns(stored("0.3.0", "temp"), slice(1))
    found, right = ({k: v for k, v in one.items() if isinstance(k, str)} for one in before)
    assert {"Econserve", "f_move[9]", "f_move[13]", "f_move[14]"} <= right.keys()
    expect(found, right, ROUNDING)
    assert all(right[f"f_move[{n}]"][0] != 0.0 for n in (9, 13, 14))
    assert f"the restart file, of release 0.3.0, {SUMS}; {ANEW}" in result.words
    assert "start of order 8" in result.words


@pytest.mark.parametrize("name", ["first", "second", "isokinetic", "temp", "spheres"])
@pytest.mark.parametrize("release", RELEASES)
def test_on_two_ranks(lmp_tree, release, name):
    output, _ = go_on(lmp_tree, name, FOLDER / release / f"{name}.restart", ranks=2)
    tolerance = OTHERWISE.get((release, name), 10 * ROUNDING)
    expect(columns(output), columns(stored(release, name)), tolerance)


@pytest.mark.parametrize("release", RELEASES)
def test_other_settings_are_noticed(lmp_tree, release):
    file = FOLDER / release / "second.restart"
    output, result = go_on(lmp_tree, "second", file, change=lambda words: words + " values 7")
    assert "was written with other settings of values" in result.words
    assert not agree(columns(output), columns(stored(release, "second")), ROUNDING)


# --- files of the next release, and files with missing sections ---------------------------------

HEAD = struct.pack("dd", float(int.from_bytes(b"gearquat", "big")), 6.0)


def changed(file: Path, folder: Path, change) -> Path:
    """A copy of a restart file with other sections; ``change`` modifies all of them, by name."""
    content = file.read_bytes()
    at = content.index(HEAD)
    (size,) = struct.unpack("i", content[at - 4 : at])
    block, sections = content[at : at + size], {}
    k = 24
    while k < size:
        name = block[k : k + 16].rstrip(b"\0").decode()
        count = int(struct.unpack("d", block[k + 16 : k + 24])[0])
        sections[name] = list(struct.unpack(f"{count}d", block[k + 24 : k + 24 + 8 * count]))
        k += 24 + 8 * count
    change(sections)
    written = b"".join(
        name.encode().ljust(16, b"\0") + struct.pack(f"{len(numbers) + 1}d", len(numbers), *numbers)
        for name, numbers in sections.items()
    )
    written = HEAD + struct.pack("d", 3 + len(written) // 8) + written
    copy = folder / "changed.restart"
    copy.write_bytes(
        content[: at - 4] + struct.pack("i", len(written)) + written + content[at + size :]
    )
    return copy


OF_SECTIONS = [release for release in RELEASES if release != "0.3.0"]


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("release", OF_SECTIONS)
def test_what_a_later_release_adds_is_passed_over(lmp_tree, release, name):
    def add(sections):
        for numbers in sections.values():
            numbers.append(4711.0)
        sections["a later one"] = [1.0, 2.0]

    file = changed(FOLDER / release / f"{name}.restart", lmp_tree.folder, add)
    output, result = go_on(lmp_tree, name, file)
    expect(columns(output), columns(stored(release, name)), ROUNDING)
    assert ANEW not in result.words


@pytest.mark.parametrize(
    "name, section, message",
    [
        ("temp", "sums of chains", f"the restart file {SUMS}; {ANEW}"),
        ("temp", "chains", f"the restart file does not have the friction of temp; {ANEW}"),
        ("isokinetic", "heat", f"the kinetic energy that isokinetic keeps; {ANEW}"),
        ("tolerance", "tolerance", f"does not have the number of values of tolerance; {ANEW}"),
        ("second", "scheme", "written with other settings of values"),
    ],
)
@pytest.mark.parametrize("release", OF_SECTIONS)
@pytest.mark.parametrize("shorter", [False, True])
def test_what_is_missing_begins_anew(lmp_tree, release, name, section, message, shorter):
    def remove(sections):
        if shorter and section in ("chains", "tolerance"):
            sections[section].pop()
        else:
            del sections[section]

    file = changed(FOLDER / release / f"{name}.restart", lmp_tree.folder, remove)
    output, result = go_on(lmp_tree, name, file)
    assert message in result.words
    assert not agree(columns(output), columns(stored(release, name)), ROUNDING)


@pytest.mark.parametrize("section", ["bodies", "parts of atoms"])
@pytest.mark.parametrize("ranks", [1, 2])
def test_what_cannot_be_missing_is_refused(lmp_tree, section, ranks):
    file = FOLDER / OF_SECTIONS[-1] / "second.restart"
    file = changed(file, lmp_tree.folder, lambda sections: sections.pop(section))
    deck = f"read_restart {file}\nfix move all gear/quat molecule"
    lmp_tree.refuse(deck, "the data of fix move in the restart file are damaged", ranks=ranks)
