"""LAMMPS' unit tests of fix styles (fix-timestep-*.yaml) with rigid bodies of fix gear/quat.

The scene is that of LAMMPS' harness: 29 atoms in 5 molecules with all kinds of bonds, 8 steps.  In the tests of rigid
fixes the rigid fix is replaced; in the tests of other fixes, rigid bodies replace the integrator of atoms, fix nve.
Both are compared with fix rigid at small steps; and fix rigid at the step of the test has to give the positions that
the test lists, or the scene was not rebuilt as the harness has it.
"""

import re
from dataclasses import dataclass, field

import numpy as np
import yaml

from lammps_gearquat.trials import script

from . import beside, convert

STEPS, DT = 8, 0.25
COEFFICIENTS = """pair_style lj/cut 8.0
pair_coeff 1 1 0.02 2.5
pair_coeff 2 2 0.005 1.0
pair_coeff 2 4 0.005 0.5
pair_coeff 3 3 0.02 3.2
pair_coeff 4 4 0.015 3.1
pair_coeff 5 5 0.015 3.1
bond_style harmonic
bond_coeff 1 250.0 1.5
bond_coeff 2 300.0 1.1
bond_coeff 3 350.0 1.3
bond_coeff 4 650.0 1.2
bond_coeff 5 450.0 1.0
angle_style harmonic
angle_coeff 1 75.0 110.1
angle_coeff 2 45.0 111.0
angle_coeff 3 50.0 120.0
angle_coeff 4 100.0 108.5
group solute molecule 1:2
group solvent molecule 3:5""".splitlines()

#: tests in which there is nothing to replace, or whose fix has another meaning for bodies
NOT_TRIED = (
    (
        r"(brownian|deform|move|nph|npt|nve|nvt|press).*|python_move.*",
        "the fix under test integrates time or changes the box: tried among the other styles",
    ),
    (
        r"adapt_(hybrid|pair|coul).*|.*tip4p.*|.*dipole.*|wall_table.*",
        "its pair style or data file is not that of the scene",
    ),
    (
        r"(shake|rattle|recenter|oneway|temp_csld|wall_reflect|smd).*",
        "refused beside bodies, or moves by chance: tried among the other styles",
    ),
    (
        r"rigid_np[ht](_small)?",
        "the barostat has other equations: tried in tests/lammps/test_pressure_company.py and others",
    ),
    (
        r"(momentum|heat|temp)_?.*",
        "fix rigid does not follow such changes of velocities: tried among the other styles",
    ),
)


@dataclass
class YamlVerdict:
    """``result``: agrees, refused, or NEITHER."""

    name: str
    result: str = "NEITHER"
    notes: list = field(default_factory=list)


def lines_of(test, method, folder, divide=1):
    """Lines of a job; None if the test has no fix that could be replaced."""
    commands, bodies = [], False
    for line in convert.lines_of(test["post_commands"]):
        text, words = line.text, line.words
        if line.rigid:
            text, bodies = convert.converted(line) if method == "gear" else text, True
        elif words[0] == "fix" and words[3] == "nve":
            text, bodies = f"fix {words[1]} {words[2]} {beside.MOVERS[method]}", True
        commands.append(text)
    if not bodies:
        return None
    run = f"run {STEPS * divide // 2} post no start 0 stop {STEPS * divide}"
    return [
        "variable newton_pair index on",
        "variable newton_bond index on",
        f"variable input_dir index {folder}",
        *(line for line in script.logical_lines(test["pre_commands"]) if line.strip()),
        f"include {folder / test['input_file']}",
        *COEFFICIENTS,
        *commands,
        f"timestep {DT / divide}",
        "run 0 post no",
        "thermo 2",
        run,
        run,
        "@state atoms",
    ]


def outcomes(source, engine, scratch):
    """(list of YamlVerdict, {name: reason} of those not tried)."""
    folder = source / "unittest" / "force-styles" / "tests"
    tests, reasons = {}, {}
    for path in sorted(folder.glob("fix-timestep-*.yaml")):
        name = path.stem.removeprefix("fix-timestep-")
        reason = next((why for pattern, why in NOT_TRIED if re.fullmatch(pattern, name)), None)
        test = None if reason else yaml.load(path.read_text(), Loader=yaml.BaseLoader)
        if reason or lines_of(test, "gear", folder) is None:
            reasons[name] = reason or "no fix in it that moves atoms"
        else:
            tests[name] = test
    runs = (("gear", 4), ("rigid", 1), ("rigid", 4), ("rigid", 8))
    jobs = {
        (name, method, divide): lines_of(test, method, folder, divide)
        for name, test in tests.items()
        for method, divide in runs
    }
    answers = engine.answers(jobs, scratch)
    return [
        _judge(name, test, *(answers[name, *run] for run in runs)) for name, test in tests.items()
    ], reasons


def _judge(name, test, gear, as_listed, coarse, fine):
    outcome = YamlVerdict(name)
    if gear.error or fine.error:
        outcome.notes.append(gear.first_line or fine.first_line)
        if gear.error and beside.REFUSES.search(gear.error):
            outcome.result = "refused"
        return outcome
    if "rigid" in name:
        listed = np.loadtxt(test["run_pos"].strip().splitlines())
        own = as_listed.noted["atoms"][:, 1:4]
        apart = np.abs(own - listed[np.argsort(listed[:, 0]), 1:4]).max()
        if not apart < 1e-9:
            outcome.notes.append(f"fix rigid is {apart:.1e} from what the test lists")
            return outcome
    error = beside.distances(coarse, fine)
    ours = beside.distances(gear, fine)
    wrong = beside.worst(
        ours, {key: beside.WITHIN * value + 1e-9 for key, value in error.items()}
    )
    outcome.notes.append(f"apart {ours}, error of the reference {error}")
    outcome.result = "NEITHER" if wrong else "agrees"
    return outcome
