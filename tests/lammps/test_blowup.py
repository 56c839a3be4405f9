"""An unstable body ends the run at this step, with a message sufficient to find it."""

import re

import numpy as np
import pytest
from support.running import SCENES
from support.scenes import TWO_SITES, frames, two_molecules, water, water_data, whole_deck

# Forces on chosen atoms from step 5 on; before it exp(0) * 0.
PUSH = """
variable on equal step>=5
variable push equal {size}*v_on
variable pull equal -({size})*v_on
group pushed {pushed}
group pulled {pulled}
fix push pushed addforce 0 0 v_push
fix pull pulled addforce 0 0 v_pull
thermo 1
dump poses all custom 1 poses.dump id x y z vx vy vz
dump_modify poses sort id flush yes
{style}
run 20
"""
TOO_MUCH = "exp(1000*v_on)"

WHERE = re.compile(
    r"Fix gear/quat: blow-up in step (\d+), time (\S+): body (\d+) (.*?); the largest force acts on its "
    r"atom (\d+); (.*?) \("
)
APART = "begin with atoms farther apart, for example after minimize or a run with keywords tolerance and temp"
HALVE = "halve the time step, 0.01, until the run is stable; atoms that overlap have to begin farther apart"


def blow_up(lmp, deck, ranks=1):
    """The single message of the fix: groups of WHERE; and the result."""
    result = lmp.refuse(deck, "blow-up", ranks=ranks)
    assert result.output.count("blow-up") == 1, result.output
    assert len(result.errors) == 1, result.output
    found = WHERE.search(" ".join(result.errors[0].split()))
    assert found, result.output
    return found.groups(), result


def pushed(size, pushed="id 5", pulled="empty", style="", fix="molecule"):
    after = PUSH.format(size=size, pushed=pushed, pulled=pulled, style=style)
    return two_molecules(fix, after=after)


# size of the force, atoms it acts on, atoms its opposite acts on, message, remedy
NO_NUMBER = "meets a force or torque that is not a finite number"
ABSURD = {
    "force": (TOO_MUCH, "id 5", "empty", NO_NUMBER, APART),
    "forces": (TOO_MUCH, "id 5", "id 6", NO_NUMBER, APART),
    "way": ("1e9", "id 4 5 6", "empty", "moves by", HALVE),
    "turn": ("1e7", "id 5", "id 4", "turns by ", HALVE),
}


@pytest.mark.parametrize("name, ranks", [*zip(ABSURD, [1] * 4), *zip(ABSURD, [2, 4, 2, 4])])
def test_an_absurd_force(lmp_tree, name, ranks):
    size, on, against, what, remedy = ABSURD[name]
    deck = pushed(size, on, against, fix="molecule values 7")
    (step, time, body, said, atom, told), result = blow_up(lmp_tree, deck, ranks)
    assert (step, float(time), body, told) == ("5", 0.05, "2", remedy)
    assert what in said
    assert atom in (("5", "6") if size == TOO_MUCH else ("4", "5", "6"))
    # neither a dump nor thermo has been affected
    seen = frames(lmp_tree.folder / "poses.dump")
    assert max(seen) == 4 and all(np.abs(frame).max() < 20 for frame in seen.values())
    assert "nan" not in result.stdout and "inf" not in result.stdout.replace("info", "")


@pytest.mark.parametrize("style", ["", "run_style respa 2 1 pair 1"])
def test_in_every_way_to_run(lmp_tree, style):
    for words in ("formulation first start bootstrap", "start zero", "formulation second passes 1"):
        deck = pushed(TOO_MUCH, style=style, fix=f"molecule {words}")
        assert blow_up(lmp_tree, deck)[0][:3] == ("5", "0.05", "2")


@pytest.mark.parametrize("start, ranks", [("zero", 1), ("bootstrap", 2)])
@pytest.mark.parametrize("distance", [0.0, 1e-30])
def test_atoms_on_top_of_each_other(lmp_tree, distance, start, ranks):
    """Infinite or very large forces before the first step: the start must end the run."""
    overlap = (
        f"set atom 4 x {1 + distance} y 0 z 0\nset atom 5 x 2 y 0 z 0\nset atom 6 x 1 y 1 z 0\n"
    )
    deck = two_molecules(f"molecule start {start}", before=overlap)
    deck = deck.replace("pair_style zero 2.0", "pair_style lj/cut 2.0")
    deck = deck.replace("pair_coeff * *", "pair_coeff * * 1.0 1.0")
    *said, atom, told = blow_up(lmp_tree, deck, ranks)[0]
    assert said[0] == "1" and said[2] in "12" and atom in ("2", "4") and told == APART


def test_an_inserted_body(lmp_tree):
    """An inserted body starts with the forces of its first step."""
    (lmp_tree.folder / "molecule.two").write_text(TWO_SITES)
    after = """
molecule two molecule.two
unfix move
delete_atoms group all compress no
fix move all gear/quat molecule mol two
variable push equal exp(1000*(atoms>0))*(atoms>0)
fix push all addforce 0 0 v_push
region put block -8 -6 -8 -6 -8 -6
fix put all deposit 1 0 3 4711 region put mol two rigid move near 0.5
run 9
"""
    message = "blow-up in step 1, time 0.01: body 1 meets"
    result = lmp_tree.refuse(two_molecules(after=after), message)
    assert len(result.errors) == 1
    assert APART in result.words


@pytest.mark.parametrize("values, dt, ranks", [(8, 40, 1), (8, 40, 2), (12, 6, 1), (12, 10, 4)])
def test_too_large_a_step(lmp_tree, values, dt, ranks):
    """Before LAMMPS loses atoms, whose message does not name a body."""
    data = water_data(lmp_tree.folder / "data.water")
    still = "velocity all set 0 0 0"  # faster rotations are refused at the beginning
    fix = f"gear/quat molecule corrector gear values {values}"
    deck = water(data, fix, dt=dt, thermo=1, steps=100, after=still)
    deck = deck.replace("dump poses all custom 100", "dump poses all custom 1")
    result = lmp_tree.refuse(deck, "Fix gear/quat: blow-up", ranks=ranks)
    assert all("blow-up" in error for error in result.errors), result.output
    whole = frames(lmp_tree.folder / "poses.dump")
    assert whole and all(np.isfinite(frame).all() for frame in whole.values())


@pytest.mark.parametrize("keywords", ["", "preset paper"])
def test_coarse_runs_of_today_are_left_alone(lmp_tree, formulation, keywords):
    """In these runs the energy is not conserved, but bodies are stable: in some runs |q|^2 is wrong by a factor of
    two."""
    if formulation == "momentum":
        keywords = ""  # the only ones
    scene = whole_deck(SCENES / "in.case1")
    for dt in (0.25, 1.0) if not keywords or formulation == "second" else (0.25,):
        settings = dict(formulation=formulation, keywords=keywords, dt=dt, out="none")
        lmp_tree.succeed(scene, settings | dict(steps=2000, every=1000))
