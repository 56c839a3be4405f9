"""`benchmarks/run effects` counts: an effect that is off takes no instruction of a body's step."""

import pytest

from benchmarks.studies.effects import count, page, plan, runs


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """Counts of all scenes, no times."""
    from running import make_lmp_tree

    folder = tmp_path_factory.mktemp("effects")
    sizes = runs.Sizes(counted=(2, 3), counted_steps=4)
    lmp = str(make_lmp_tree(folder).executable)
    found = runs.Results(sizes)
    found.profiles = count.count(folder, plan.scenes(), sizes.counted, sizes.counted_steps, lmp)
    return found


EFFECTS = {effect.name: effect for effect in plan.EFFECTS}


def test_off_is_free(results):
    for name, effect in EFFECTS.items():
        assert not effect.own or results.idle(effect) == 0, name
        if effect.never:
            assert results.fix(effect.off) == results.fix(effect.never), name
    assert page.off_sentence(results).startswith("Of every effect that is off, 0 instructions")


def test_on_is_counted_in_the_functions_named_for_it(results):
    for name, effect in EFFECTS.items():
        if not effect.on:
            continue
        more = results.fix(effect.on) - results.fix(effect.base)
        assert more > 10, name
        if effect.own:
            own = results.per_body(effect.on, lambda profile, effect=effect: profile.of(effect.own))
            assert 10 < own < results.fix(effect.on), name


def test_steps_are_all_alike(results):
    """Whole numbers of instructions a body and step: nothing but the steps of bodies was counted."""
    for scene in plan.scenes():
        per_body = results.fix(scene)
        assert per_body == pytest.approx(round(per_body), abs=1e-9), scene


def test_every_rung_costs_more_only_by_its_own_row(results):
    for rung in plan.LADDER:
        effect = page.row_of(rung)
        if effect:
            more = results.fix(rung.on) - results.fix(rung.base)
            alone = results.fix(effect.on) - results.fix(effect.base)
            assert more == pytest.approx(alone, rel=1e-3)
            assert more != pytest.approx(1.01 * alone, rel=1e-3)
    assert results.fix(plan.CHARGED) == results.fix(plan.MOVED)
    assert results.forces(plan.CHARGED) > 1.05 * results.forces(plan.MOVED)


def test_a_point_costs_a_fraction_of_a_body(results):
    assert results.fix(plan.POINTS) < 0.4 * results.fix(plan.MOVED)
