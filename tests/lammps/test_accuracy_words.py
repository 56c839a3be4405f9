"""The keywords of the accuracy (values, passes, compensate) and the errors reported by the fix."""

import re

import numpy as np
import pytest
from support.scenes import WATER_MASSES, last_frame, two_molecules, water

LADDER = [("first", 3), ("first", 6), ("first", 8), ("second", 4), ("second", 9), ("second", 12)]
ERRORS = "f_move[5] f_move[6] f_move[7] f_move[8]"


@pytest.fixture
def liquid(lmp_tree, data):
    """Run 27 water molecules: liquid(fix words, ...) -> result and last frame of the dump."""

    def run(words, steps=20, dt=0.5, ranks=1, **more):
        fix, columns = f"gear/quat molecule {words}", f"{ERRORS} f_move[4]"
        deck = water(data, fix, steps=steps, dt=dt, columns=columns, **more)
        result = lmp_tree.succeed(deck, ranks=ranks)
        return result, last_frame(lmp_tree.folder / "poses.dump")[:, 1:4]

    return run


def errors(result, row=-1):
    """Largest and rms estimated error of positions, then of orientations, of one thermo row."""
    return np.array([result.thermo[-1][word][row] for word in ERRORS.split()])


@pytest.mark.parametrize("formulation, values", LADDER)
def test_every_number_of_values_starts_with_its_order_and_stays_rigid(liquid, formulation, values):
    result, x = liquid(f"formulation {formulation} corrector gear values {values}")
    found = re.search(r"start of order (\d+) from (\d+) force evaluations", result.output)
    # the switching function of the forces has kinks, which limit the derivatives
    full, kinks = values + (values % 2 == 0), "forces change suddenly" in result.output
    assert int(found[1]) == (min(full, 6) if kinks else full)
    assert not kinks or values > 5
    pairs = (values + 1) // 2
    assert 2 * (3 if kinks else pairs) <= int(found[2]) <= pairs * (pairs + 1) + 4 * pairs
    arms = np.linalg.norm(x[1::3] - x[0::3], axis=1)
    assert arms == pytest.approx(np.ones(len(arms)), abs=1e-13)
    assert result.thermo[-1]["f_move[4]"][-1] < 1e-6  # q stays orthogonal to its rate


GEAR = "corrector gear passes 1 start zero project no"
PRESET = {"second": f"values 6 {GEAR} c0 velocity", "first": f"values 5 {GEAR} momentum predicted"}


@pytest.mark.parametrize("formulation", PRESET)
def test_the_preset_of_the_paper_is_its_keywords(liquid, formulation):
    """The results agree to the last bit; given keywords take precedence at any position."""
    fix, words = f"formulation {formulation}", PRESET[formulation]
    same = {name: liquid(f"{fix} {more}")[1] for name, more in (("preset", "preset paper"), ("words", words))}
    assert (same["preset"] == same["words"]).all()
    changed = [liquid(f"{fix} {more}")[1] for more in ("passes 2 preset paper", words.replace("passes 1", "passes 2"))]
    assert (changed[0] == changed[1]).all() and (changed[0] != same["words"]).any()


def test_the_preset_means_formulation_second(liquid, lmp_wheel):
    assert (liquid("preset paper")[1] == liquid("formulation second preset paper")[1]).all()
    deck = two_molecules("molecule formulation momentum preset paper", after="run 0")
    lmp_wheel.refuse(deck, "preset paper requires formulation second or first", ranks=2)


def test_estimates_of_many_bodies(liquid):
    """The largest is not the rms, and the number of ranks does not matter."""
    one, four = (errors(liquid("values 6", ranks=ranks)[0]) for ranks in (1, 4))
    assert (one[[0, 2]] > one[[1, 3]]).all()
    assert (one[[0, 2]] < one[[1, 3]] * np.sqrt(27)).all()
    assert one == pytest.approx(four, rel=1e-7)


def test_estimates_outlive_a_run(liquid):
    """The first line of a run repeats the errors of the last step of the previous run."""
    result, _ = liquid("values 6", run="run 10\nrun 10")
    before, after = result.thermo[-2], result.thermo[-1]
    for word in ERRORS.split():
        assert after[word][0] == before[word][-1] > 0


def test_passes_change_orientations_only_through_the_same_forces(liquid):
    """A pass requires no force evaluation."""
    fix = "formulation second values 6 start zero"
    runs = {n: liquid(f"{fix} passes {n}", steps=1, dt=2.0) for n in (1, 2)}
    frames = {n: frame for n, (_, frame) in runs.items()}
    assert "force evaluations" not in runs[2][0].output
    center = {
        n: np.average(x.reshape(27, 3, 3), axis=1, weights=WATER_MASSES) for n, x in frames.items()
    }
    change = np.abs(frames[1] - frames[2]).max()
    assert np.abs(center[1] - center[2]).max() < 1e-10 < change  # bodies move as before


def test_jumping_forces_are_told(lmp_wheel, examples):
    """A plain cutoff: a polynomial does not represent a jump, and the start reports its size."""
    deck = (examples / "water" / "in.water").read_text()
    for name in ("data.water", "forces."):
        deck = deck.replace(name, str(examples / "water" / name))
    orders = {}
    for forces in ("smooth", "plain"):
        result = lmp_wheel.succeed(
            deck, dict(forces=forces, steps=1, every=1, fix="gear/quat molecule values 12 corrector gear", dt=1.0)
        )
        orders[forces] = int(re.search(r"start of order (\d+) from", result.output)[1])
        jump = re.search(r"because forces change suddenly, by (\S+) of the motion", result.output)
        assert (jump is None) == (forces == "smooth")
    assert orders == {"smooth": 13, "plain": 4}
    assert 1e-5 < float(jump[1]) < 10.0
