"""The study of effects counts instructions: an effect that is off adds none to a body's step."""

from dataclasses import replace

import pytest

from benchmarks.studies import effects
from benchmarks.studies.effects import count, plan, runs
from running import make_lmp_tree


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """Counts of all scenes, no times."""
    folder = tmp_path_factory.mktemp("effects")
    sizes = runs.Sizes(counted=(2, 3), counted_steps=72)
    lmp = str(make_lmp_tree(folder).executable)
    profiles = count.count(folder, plan.scenes(), sizes.counted, sizes.counted_steps, lmp)
    return runs.Results(sizes, profiles, {}, None)


EFFECTS = {effect.name: effect for effect in plan.EFFECTS}


def test_off_is_free(results):
    idle = effects.idle_measurements(results)
    assert len(idle) > 10
    assert [m.what for m in idle if not m.holds] == []
    assert not replace(idle[0], value=0.01).holds


def test_on_is_counted_in_the_functions_named_for_it(results):
    for name, effect in EFFECTS.items():
        if not effect.on:
            continue
        assert results.fix(effect.on, effect.base) > 10, name
        if effect.own:
            own = results.per_body(effect.on, lambda profile, effect=effect: profile.of(effect.own))
            # because of inlining, few instructions are assigned to these functions
            assert 5 < own < results.fix(effect.on), name


def test_steps_are_all_alike(results):
    """Integer numbers of instructions of all bodies in a step: nothing but the steps of bodies was counted."""
    low, high = results.sizes.counted
    for scene in plan.scenes():
        of_all = results.fix(scene) * (high**3 - low**3)  # bodies are predicted in pairs
        # step control takes maxima, whose branches depend on the data
        if "tolerance" not in scene.words:
            assert of_all == pytest.approx(round(of_all), abs=1e-6), scene


def test_costs_add_up(results):
    assert effects.apart(results) < effects.MOST_APART
    assert results.fix(plan.CHARGED) == results.fix(plan.MOVED)
    assert results.forces(plan.CHARGED) > 1.05 * results.forces(plan.MOVED)


def test_a_point_costs_a_fraction_of_a_body(results):
    assert results.fix(plan.POINTS) < 0.4 * results.fix(plan.MOVED)
