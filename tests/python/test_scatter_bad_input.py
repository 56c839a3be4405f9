"""gearquat scatter refuses decks without two bodies that meet and part, and states what is required."""

from support import colliding
import pytest
from click.testing import CliRunner

from lammps_gearquat.cli import main

THIRD = "set atom 2 mol 2\n"
FIX = "fix move all gear/quat molecule tolerance 1e-10 energy"
DECKS = {
    "three bodies": (
        {THIRD: THIRD + "create_atoms 1 single 0 9 0\nset atom 3 mol 3\n"},
        "two bodies are required: fix move has 3",
    ),
    "one body": ({THIRD: "set atom 2 mol 1\n"}, "two bodies are required: fix move has 1"),
    "an atom more": (
        {FIX: "group pair id 1 2\ncreate_atoms 1 single 0 9 0\n" + FIX.replace("all", "pair")},
        "1 atoms are in no body",
    ),
    "periodic": ({"boundary s s s": "boundary s s p"}, "boundary s s s is required"),
    "no tolerance": ({" tolerance 1e-10 energy": ""}, "keyword tolerance is required"),
    "another method": (
        {FIX: "fix move all rigid/nve/small molecule", "atoms": colliding.DUMBBELLS},
        "one fix gear/quat that moves both bodies is required",
    ),
    "an infile": ({FIX: FIX + " infile no.such"}, "LAMMPS refuses"),
    "a masked force": ({FIX: FIX + " force 1 off off off"}, "keyword force has to be left out"),
    "no forces": ({"pair_style lj/smooth 6.0 7.0\npair_coeff 1 1 1.0 1.0": ""}, "has no forces between atoms"),
    "no forces at all": ({"1 1 1.0 1.0": "1 1 0.0 1.0"}, "the bodies exert no forces on each other"),
    "a thermostat of the fix": (
        {" tolerance 1e-10 energy": " temp 1 1 1"},
        "keyword tolerance is required",
    ),
    "spheres": (
        {"atom_style bond": "atom_style hybrid bond sphere", "mass 1 1.0": "set type 1 density 1.0"},
        "atoms have to be points",
    ),
}
EXTRAS = {
    "thermostat": ("fix heat all langevin 1 1 1 4711", "its forces are random"),
    "field": ("fix field all addforce 0 0 1", "--without field leaves it out"),
    "bond": (
        "bond_style harmonic\nspecial_bonds lj 1 1 1\nbond_coeff 1 1.0 1.0\ncreate_bonds single/bond 1 1 2",
        "forces do not vanish",
    ),
}
OPTIONS = {
    "negative temperature": (("--temperature", "-1"), "-1.0 is not in the range"),
    "negative rotation": (("--temperature", "1", "--rotation", "-1"), "-1.0 is not in the range"),
    "neither": ((), "either --temperature or --energy is required"),
    "both": (("--temperature", "1", "--energy", "1"), "either --temperature or --energy is required"),
    "no way to part": (("--temperature", "1", "--steps", "30"), "none of the 512 flights has parted"),
}


def refused(*arguments):
    result = CliRunner().invoke(main, ["scatter", "--processes", "1", *map(str, arguments)])
    assert result.exit_code != 0
    return " ".join(result.output.split())


@pytest.mark.parametrize(("changes", "words"), DECKS.values(), ids=DECKS)
def test_decks(tmp_path, changes, words):
    deck = colliding.write(tmp_path, **changes)
    assert words in refused(deck, "--temperature", "1", "--out", tmp_path / "out")


@pytest.mark.parametrize(("extra", "words"), EXTRAS.values(), ids=EXTRAS)
def test_what_else_acts(tmp_path, extra, words):
    deck = colliding.write(tmp_path, extra=extra)
    assert words in refused(deck, "--temperature", "1", "--out", tmp_path / "out")


@pytest.mark.parametrize(("options", "words"), OPTIONS.values(), ids=OPTIONS)
def test_options(tmp_path, options, words):
    assert words in refused(colliding.write(tmp_path), *options, "--out", tmp_path / "out")


def test_other_settings_in_the_folder(tmp_path):
    deck, out = colliding.write(tmp_path, **{"tolerance 1e-10": "tolerance 1e-8"}), tmp_path / "out"
    options = ("--count", "512", "--processes", "1", "--out", str(out))
    assert CliRunner().invoke(main, ["scatter", str(deck), "--temperature", "1", *options]).exit_code == 0
    assert "results of other settings (--temperature" in refused(deck, "--temperature", "2", *options)
    assert "results of other settings (--seed)" in refused(deck, "--temperature", "1", "--seed", "2", *options)
