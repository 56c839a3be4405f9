"""gearquat scatter refuses decks without two bodies that meet and part, and states what is required."""

import json
import shutil

from support import colliding
import pytest
from click.testing import CliRunner

from lammps_gearquat.cli import main

THIRD = "set atom 2 mol 2\n"
FIX = "fix move all gear/quat molecule tolerance 1e-10 energy"
SHORT = {"cutoff": 2.5, "inner": 2.4}
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
    "a force that jumps": ({"lj/smooth 6.0 7.0": "lj/cut 2.5"}, "jumps where they are 2.5 apart"),
    "one that jumps between sites": (
        {"lj/smooth 6.0 7.0": "lj/cut 2.5", "atoms": colliding.DUMBBELLS},
        "the force between the bodies jumps",
    ),
    "a thermostat of the fix": (
        {" tolerance 1e-10 energy": " temp 1 1 1"},
        "keyword temp has to be left out, and 'tolerance 1e-9 energy' put in its place",
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
    "both": (("--temperature", "1", "--energy", "1"), "not both --temperature and --energy"),
    "spheres and one energy": (("--energy", "1", "--sigma", "1"), "--sigma is for collision integrals"),
    "first alone": (("--temperature", "1", "--first", "3"), "--first needs --count"),
    "too far": (("--temperature", "1", "--largest", "7.5"), "a longer cutoff is required"),
    "too near": (("--temperature", "1", "--largest", "1.5"), "a larger --largest is required, or --count"),
    "far apart": (
        [word for value in ("1", "2", "6.5") for word in ("--temperature", value)],
        "--temperature 2 and 6.5: flights at one of them contribute little to averages at the other",
    ),
    "no way to part": (("--temperature", "1", "--steps", "30"), "of 768 pilot flights have not parted within --steps"),
    "a dump and new flights": (("--replay", "3", "--count", "8"), "--replay takes all settings from the folder --out"),
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


def test_a_cutoff_inside_the_largest_impact_parameter(tmp_path):
    deck = colliding.write(tmp_path, **SHORT)
    words = refused(deck, "--temperature", "1", "--out", tmp_path / "out")
    assert "does not decay towards the cutoff of 2.5" in words and "longer cutoff is required" in words


def test_other_settings_in_the_folder(tmp_path, few_pilots):
    deck, out = colliding.write(tmp_path), tmp_path / "out"
    options = ("--largest", "3", "--count", "8", "--processes", "1", "--out", str(out))
    assert CliRunner().invoke(main, ["scatter", str(deck), "--temperature", "1", *options]).exit_code == 0
    assert "flights of other settings (--temperature)" in refused(deck, "--temperature", "2", *options)
    assert "flights of other settings (--seed)" in refused(deck, "--temperature", "1", "--seed", "2", *options)
    other = tmp_path / "other"
    second = [*options[:-1], str(other)]
    assert CliRunner().invoke(main, ["scatter", str(deck), "--temperature", "2", *second]).exit_code == 0
    words = refused("--merge", out, "--merge", other, "--out", tmp_path / "merged")
    assert "(--temperature): parts have to be made with the same deck and options" in words
    assert "temperature has to be left out" in refused("--merge", out, "--temperature", "1")
    assert "a folder with results" in refused("--merge", tmp_path)


def test_flights_of_releases_that_drew_them_from_another_density(tmp_path, few_pilots):
    """Such folders are neither continued nor joined nor replayed, and nothing is changed."""
    deck, new, old = colliding.write(tmp_path), tmp_path / "new", tmp_path / "old"
    options = ("--temperature", "1", "--largest", "3", "--count", "8", "--processes", "1")
    assert CliRunner().invoke(main, ["scatter", str(deck), *options, "--out", str(new)]).exit_code == 0
    shutil.copytree(new, old)
    settings = json.loads((old / "settings.json").read_text())
    del settings["sampling"], settings["plan"]["s0"], settings["plan"]["s1"], settings["plan"]["power"]
    settings["plan"] |= {"core": 1.5, "temperature": 1.0, "rotation": 1.0}
    (old / "settings.json").write_text(json.dumps(settings))
    before = {path.name: path.read_bytes() for path in old.iterdir()}
    words = "old has flights of another release of gearquat scatter"
    assert words in refused(deck, *options, "--out", old)
    assert words in refused(deck, "--replay", "3", "--out", old)
    for parts in ((old, new), (new, old)):
        assert words in refused(*(word for part in parts for word in ("--merge", part)), "--out", tmp_path / "both")
    assert {path.name: path.read_bytes() for path in old.iterdir()} == before
    assert not (tmp_path / "both").exists()
