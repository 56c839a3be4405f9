"""Bodies among other atoms: forces of all kinds, other fixes for the rest, in one box of water.

Compared with fix rigid/nve/small at a step so small that its error is negligible, and by balances of
momentum and energy that are independent of the integrator.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from support.running import Lammps
from support.scenes import FORMULATIONS, WATER_MASSES, last_frame, one_after_the_other, water, water_data, with_bonds

RIGID, OURS = "rigid/nve/small molecule", "gear/quat molecule formulation "
METHODS = {"rigid": RIGID, **{formulation: OURS + formulation for formulation in FORMULATIONS}}
BODIES = "group bodies molecule 1:14\ngroup others subtract all bodies\n"
SPACING, N = 3.3, 3
SMOOTH = "pair_style lj/charmm/coul/charmm 2.7 3.9"
NO_DISPERSION = "pair_coeff 2 2 0.0 1.0\npair_coeff 1 2 0.0 1.0\n"


@dataclass
class Box:
    """The box of water with decks that have the same beginning; a deck writes a dump with its name."""

    lmp: Lammps
    data: Path

    def run(self, *decks, ranks=1):
        return self.lmp.succeed(one_after_the_other(decks), ranks=ranks)

    def deck(self, name, fix, group="all", dt=0.01, steps=1000, replace=(), **settings):
        text = water(self.data, fix, dt=dt, steps=steps, dump=name, **settings)
        text = text.replace("fix move all", f"fix move {group}")
        for old, new in replace:
            assert old in text
            text = text.replace(old, new)
        return text

    def end(self, name):
        return last_frame(self.lmp.folder / name)

    def start(self):
        lines = self.data.read_text().partition("Velocities\n\n")[2].partition("\n\n")[0]
        return np.loadtxt(lines.splitlines())[:, 1:]

    def difference(self, one, other, atoms=slice(None)):
        """Deviation of positions and velocities, relative to the change of the velocities by forces."""
        one, other = (self.end(name)[atoms] for name in (one, other))
        changed = np.abs(one[:, 4:7] - self.start()[one[:, 0].astype(int) - 1]).max()
        travelled = np.abs(one[:, 4:7]).max()
        moved = np.abs(one - other)
        return max(moved[:, 1:4].max() / (10 * travelled), moved[:, 4:7].max() / changed)


@pytest.fixture
def box(lmp_tree):
    return Box(lmp_tree, water_data(lmp_tree.folder / "data.water", N, shift=SPACING / 2))


# --- forces -----------------------------------------------------------------------------------


OPEN = [("read_data", "boundary p p f\nread_data")]
FIELDS = """
fix g all gravity 0.05 vector 0.3 0.2 -1
fix e all efield 0.5 -0.8 0.3
fix a all addforce 1.0 0.5 -0.3
"""
WALLS = """
fix lj93 all wall/lj93 zlo -1.5 2.0 2.5 7.0
fix lj126 all wall/lj126 zhi 11.4 2.0 2.5 7.0
fix harmonic all wall/harmonic zlo -1.5 2.0 2.5 7.0
fix morse all wall/morse zhi 11.4 2.0 1.2 2.5 7.0
"""
#: commands, and replacements in the deck
FORCES = {
    "pair": ("", []),
    "fields": (FIELDS, []),
    "walls": (WALLS, OPEN),
    "wall/region": ("region inside sphere 5 5 5 11.0\nfix w all wall/region inside harmonic 2.0 0.0 8.0", OPEN),
    "pppm": ("kspace_style pppm 1e-3", [(SMOOTH, "pair_style lj/charmm/coul/long 2.7 3.9 4.2")]),
    "hybrid": (
        "",
        [
            (SMOOTH, "pair_style hybrid/overlay lj/cut 3.9 coul/cut 4.4"),
            (NO_DISPERSION, ""),
            ("1 1 0.1553 3.166", "1 1 lj/cut 0.1553 3.166\npair_coeff * * coul/cut"),
        ],
    ),
}


@pytest.mark.parametrize("kind, ranks", [(kind, 2 if kind in ("fields", "wall/region") else 1) for kind in FORCES])
def test_every_force_counts(box, kind, ranks):
    """The motion agrees with fix rigid/nve/small at a tiny step.

    Plain cutoffs are jumps of the forces, whose errors decay over some tens of steps with tuned coefficients.
    """
    before, replace = FORCES[kind]
    # before: a fix rigid defined first lacks the forces of others in its first half step
    decks = [box.deck(name, fix, before=before, replace=replace) for name, fix in METHODS.items()]
    box.run(*decks, ranks=ranks)
    for formulation in FORMULATIONS:
        assert box.difference("rigid", formulation) < (1e-5 if kind == "hybrid" else 1e-6)


FTM2V = 1 / 48.88821291**2  # kcal/mol/Angstrom/(g/mol) in Angstrom/fs^2
MASS = np.tile(WATER_MASSES, N**3)
DRAG = {  # rate in 1/fs, and its command
    "langevin": (1 / 30, "fix d all langevin 0 0 30 4711"),
    "viscous": (40 * FTM2V, f"fix d all viscous {40 * MASS[0]} scale 2 {MASS[1] / MASS[0]}"),
}


@pytest.mark.parametrize("kind", DRAG)
def test_a_drag_on_every_site_stops_the_whole(box, fix, kind):
    """The friction is proportional to masses, so internal forces cancel and the momentum decays exponentially, and
    with velocity Verlet by the same part in each step."""
    rate, drag = DRAG[kind]
    box.run(box.deck("end", fix, dt=0.1, steps=300, before=drag))
    before, after = MASS @ box.start(), MASS @ box.end("end")[:, 4:7]
    part = 0.1 * rate
    verlet = kind == "langevin" and not fix.endswith("first")
    exact = before * ((1 - part / 2) ** 2 * (1 - part) ** 299 if verlet else np.exp(-300 * part))
    assert after == pytest.approx(exact, rel=1e-5)


# --- bodies among atoms that another fix moves ------------------------------------------------


SOLVENT = {
    "flexible": """
bond_style harmonic
bond_coeff 1 450.0 1.0
bond_coeff 2 20.0 3.0
angle_style harmonic
angle_coeff 1 55.0 109.47
"""
    + BODIES
    + "delete_bonds bodies multi",
    "atomic": BODIES
    + """
group light type 2
group spare intersect light others
delete_atoms group spare compress no
set group others charge 0.0
""",
}


@pytest.fixture(params=SOLVENT)
def solution(request, box):
    """Half of the molecules are rigid; the others are flexible, or single atoms, and moved by fix nve."""
    box.ranks = 2 if request.param == "flexible" else 1
    if request.param == "flexible":
        box.data = with_bonds(box.data, "2 40 43")
    box.before = SOLVENT[request.param] + "\nfix others others nve\n"
    return box


def test_bodies_and_solvent_move_each_other(solution):
    """The motion agrees with fix rigid/nve/small at a tiny step; without the forces between the two kinds it
    differs."""
    apart = "neigh_modify exclude group bodies others\n"
    common = dict(group="bodies", before=solution.before)
    solution.run(
        *(solution.deck(name, fix, **common) for name, fix in METHODS.items()),
        solution.deck("apart", OURS + "second", "bodies", before=solution.before + apart),
        ranks=solution.ranks,
    )
    bodies = solution.end("rigid")[:, 0] <= 3 * 14
    for atoms in (bodies, ~bodies):
        for formulation in FORMULATIONS:
            assert solution.difference("rigid", formulation, atoms) < 1e-6
        assert solution.difference("rigid", "apart", atoms) > 1e-5


def test_respa_with_forces_of_both_levels(box, fix):
    """A bond acts on a body on one level, and all pairs on the other level: their sum moves the body."""
    box.data = with_bonds(box.data, "2 40 43")
    before = SOLVENT["flexible"] + "\nfix others others nve\n"
    common = dict(group="bodies", dt=0.2, steps=200)
    levels = "run_style respa 2 1 bond 1 angle 1 pair 2\n"
    box.run(
        box.deck("verlet", fix, before=before, **common),
        box.deck("respa", fix, before=levels + before, **common),
    )
    assert box.difference("verlet", "respa") < 1e-11


def test_momentum_and_energy_of_a_solution(solution, fix):
    """Energy and momentum are exchanged between bodies and solvent, and their totals are conserved."""
    if "first" not in fix and "second" not in fix:
        fix += " values 9"  # five, the default beside other atoms, are not yet limited by fix nve
    # there is no cutoff: forces are the derivatives of the energy everywhere
    room = "change_box all x delta -9 9 y delta -9 9 z delta -9 9 units box\n"
    whole = [
        ("read_data", "boundary f f f\nread_data"),
        (SMOOTH, "pair_style lj/cut/coul/cut 90.0"),
    ]
    common = dict(group="bodies", replace=whole, before=room + solution.before)
    result = solution.run(
        solution.deck("coarse", fix, dt=0.2, steps=250, thermo=25, **common),
        solution.deck("fine", fix, dt=0.1, steps=500, thermo=50, **common),
    )
    drift, lost = [], []
    for name, table in zip(("coarse", "fine"), result.thermo):
        frame = solution.end(name)
        atoms = frame[:, 0].astype(int) - 1
        gained = MASS[atoms, None] * (frame[:, 4:7] - solution.start()[atoms])
        exchanged = np.abs(gained[atoms < 3 * 14].sum(axis=0)).max()
        lost.append(np.abs(gained.sum(axis=0)).max() / exchanged)
        potential, kinetic = np.array(table["PotEng"]), np.array(table["KinEng"])
        total = potential + kinetic
        drift.append(np.abs(total - total[0]).max() / np.ptp(potential))
    # The remaining error is of the order of fix nve, and small.
    for errors in (drift, lost):
        assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.05)
        assert errors[1] < 1e-5


# --- several fixes ----------------------------------------------------------------------------


def test_two_fixes_are_one(box, formulation):
    """Motion, temperature and pressure are the same; a sum over all bodies is the sum of both fixes."""
    fix, ranks = f"{OURS}{formulation} start zero", 2 if formulation == "momentum" else 1
    sums, both = "f_move[1] f_move[2]", "f_move[1] f_move[2] f_rest[1] f_rest[2]"
    two = f"fix rest others {fix}\nfix_modify rest energy yes\n"
    settings = dict(dt=0.2, steps=200, thermo=50)
    result = box.run(
        box.deck("one", fix, columns=sums, **settings),
        box.deck("two", fix, "bodies", before=BODIES + two, columns=both, **settings),
        ranks=ranks,
    )
    one, two = result.thermo[:2]
    for column in ("Temp", "PotEng", "TotEng", "Press"):
        assert two[column] == pytest.approx(one[column], rel=1e-11)
    for k in (1, 2):
        whole = np.add(two[f"f_move[{k}]"], two[f"f_rest[{k}]"])
        assert whole == pytest.approx(one[f"f_move[{k}]"], rel=1e-11)
        assert min(two[f"f_rest[{k}]"]) > 0
    assert box.difference("one", "two") < 1e-12


@pytest.mark.parametrize("beside, ranks", [(OURS + "first", 2), (RIGID, 1)])
def test_another_rigid_fix_beside(box, beside, ranks):
    """The other fix has the other formulation, or is rigid/nve/small: the motion is as if rigid/nve/small moved all
    bodies."""
    fix = OURS + "second"
    two = f"{BODIES}fix rest others {beside}\n"
    # another fix gear/quat is followed, since both start together; other fixes are not
    start = "start with known forces only (order 2), because fix rest"
    if beside != RIGID:
        start = "Fix gear/quat move: start of order 9 from"
    result = box.run(
        box.deck("all", RIGID),
        box.deck("mixed", fix, "bodies", before=two),
        ranks=ranks,
    )
    assert result.stdout.count(start) == 1
    assert box.difference("all", "mixed") < 1e-6
    temperature, pressure = ([t[key] for t in result.thermo] for key in ("Temp", "Press"))
    assert temperature[1] == pytest.approx(temperature[0], rel=1e-6)
    assert pressure[1][1] == pytest.approx(pressure[0][1], rel=1e-3)
