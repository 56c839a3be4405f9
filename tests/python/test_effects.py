"""The study of effects: reading of profiles, judging of made-up counts; real counts are in tests/lammps."""

import itertools

import pytest

from benchmarks.engine.page import render
from benchmarks.engine.runner import LammpsError
from benchmarks.engine.store import read_data, write_data
from benchmarks.studies import effects
from benchmarks.studies.effects import count, plan, runs

PART = """\
# callgrind format
events: Ir
fn=LAMMPS_NS::Verlet::run(int)
0 5
cfn=LAMMPS_NS::FixGearQuat::final_integrate()
calls=10 0
0 1000
cfn=LAMMPS_NS::PairLJCut::compute(int, int)
calls=10 0
0 300
fn=LAMMPS_NS::FixGearQuat::final_integrate()
0 400
+3 300
cob=lmp
cfi=file
cfn=LAMMPS_NS::FixGearQuat::show_bodies()
calls=1 0
0 300
fn=LAMMPS_NS::FixGearQuat::show_bodies()
* 300
"""


def test_a_profile_is_read():
    profile = count.parse(PART)
    assert profile.own["LAMMPS_NS::FixGearQuat::final_integrate()"] == 700
    assert profile.fix == 700 and profile.forces == 300
    assert profile.of("show_bodies") == 300
    assert sum(profile.own.values()) == 5 + 700 + 300
    assert count.parse(PART.replace("0 1000", "0 1010")).fix == 710


def test_a_stub_of_the_linker_is_no_function():
    """What it calls is called by its caller, and is left out as if it were called directly."""
    shown = "LAMMPS_NS::FixGearQuat::show_bodies()"
    through = PART.replace(f"cfn={shown}\ncalls=1 0\n0 300", "cfn=0x00000000049e61e0\ncalls=1 0\n0 303")
    through += f"fn=0x00000000049e61e0\n0 3\ncfn={shown}\ncalls=1 0\n0 300\n"
    assert count.parse(through).fix == 1000 - 303
    assert count.parse(through.replace("0x00000000049e61e0", "somebody()")).fix == 1000


def made_up(cost=lambda scene, number: 100 * number + 7):
    """Results in which a scene's step takes cost(scene, its number) instructions per body."""
    sizes, profiles, seconds = runs.QUICK, {}, {}
    for number, scene in enumerate(plan.scenes(), 1):
        for side in sizes.counted:
            fix = round(sizes.counted_steps * (5 + side**3 * cost(scene, number)))
            profiles[scene, side] = count.parse(PART.replace("0 1000", f"0 {fix + 300}"))
        seconds[scene] = [(1e-6 * number, 2e-6), (1.1e-6 * number, 2e-6)]
    cage = runs.Cage([2e-6, 3e-6, 4e-6], [1e-6] * 3, 435, 104)
    return runs.Results(sizes, profiles, seconds, cage)


def broken(results):
    """Names of the effects that are not free."""
    measurements = effects.idle_measurements(results)
    return [m.what.partition(",")[0] for m in measurements if not m.holds]


def test_numbers_are_those_of_a_body_and_a_step():
    results = made_up()
    assert results.fix(plan.scenes()[0]) == pytest.approx(107)
    assert results.nanoseconds(plan.scenes()[0]) == pytest.approx(1e3 / 64)
    assert results.cage.speedup == 2.0
    finding = effects.find(results)
    assert len(finding.tables["effects"].rows) == len(plan.EFFECTS)
    rows = finding.tables["ladder"].rows
    assert len(rows) == len(plan.LADDER)
    for below, above in itertools.pairwise(rows):
        assert float(above[1]) - float(above[3]) == float(above[4])
        assert (above[2] == "the row above") == (above[3] == below[1])


def test_results_come_back_from_their_file(tmp_path):
    results = made_up()
    write_data(tmp_path / "data.json", results)
    again = read_data(tmp_path / "data.json")
    assert again.profiles == results.profiles and again.seconds == results.seconds
    assert effects.find(again).tables == effects.find(results).tables


def effect(name):
    return next(effect for effect in plan.EFFECTS if effect.name == name)


def test_an_effect_that_is_not_free_is_named():
    even = made_up(lambda scene, number: 1000)
    assert broken(even) == [] and effects.find(even).context["not_free"] == []
    off = effect("virial").off
    dear = made_up(lambda scene, number: 1001 if scene == off else 1000)
    assert broken(dear) == ["virial"]
    page = render("effects.md.j2", effects.STUDY, effects.find(dear), "")
    assert "although they are off: virial." in page


def test_own_functions_where_an_effect_is_off_are_named():
    results = made_up(lambda scene, number: 1000)
    key = effect("finite size").idle, results.sizes.counted[1]
    results.profiles[key].own["GearQuat::Extended::place"] = 9
    assert broken(results) == ["finite size"]


def test_without_valgrind_the_line_that_installs_it_is_told(monkeypatch, tmp_path):
    monkeypatch.setattr(count.shutil, "which", lambda name: None)
    with pytest.raises(LammpsError, match="apt-get install -y --no-install-recommends valgrind"):
        count.find_valgrind()


def test_a_program_without_names_is_refused(tmp_path):
    (tmp_path / "callgrind.1").write_text("")
    with pytest.raises(LammpsError, match="has no names of functions"):
        count._parts(tmp_path)
