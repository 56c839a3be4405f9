"""Variants of LAMMPS' styles (`-sf opt` and others) with fix gear/quat: the motion is the same as without the option.

The suffix may change the order of sums, and what the fix can evaluate before step 0.  If the start is
of another order for that reason, the log has to name the package; the reference then begins alike.
"""

from dataclasses import dataclass, field

from support.scenes import WATER_MASSES, water_data

from . import beside, scene, thermostat

STEPS = 20
EDGE = 4
#: has no effect except that it prevents the start from evaluating forces
UNFOLLOWED = "fix unfollowed free nve"


def of_molecules(pair, *more):
    """Lines that make the molecules of scene.py with another pair style."""
    lines = [f"pair_style {pair}" if "pair_style" in line else line for line in scene.begin()]
    return [*lines, *more, *thermostat.BEGIN, f"timestep {beside.DT}"]


#: of the order that package INTEL has by default, and like its styles without tables of Coulomb forces
KSPACE = ("kspace_style pppm 1e-4", "kspace_modify order 7", "pair_modify table 0")
LIQUID = """units real
atom_style full
atom_modify map yes
read_data data.water
pair_style lj/cut/coul/long 6.0
pair_coeff * * 0 0
pair_coeff 1 1 0.15535 3.166
neigh_modify exclude molecule/intra all
group bodies union all
group free empty
velocity all create 300 1 loop geom
timestep 0.5""".splitlines()


@dataclass(frozen=True)
class Scene:
    """``variants``: the pair style that has to be in use with each suffix; ``bodies`` as in thermostat.py."""

    lines: list
    temp: str
    variants: dict
    bodies: thermostat.Bodies = thermostat.Bodies()


def _variants(pair, *suffixes):
    return {suffix: f"{pair}/{suffix}" for suffix in suffixes}


SCENES = {
    "lj/cut": Scene(
        of_molecules("lj/cut 2.5"), thermostat.MOVER, _variants("lj/cut", "opt", "omp", "intel")
    ),
    "lj/cut/coul/long": Scene(
        of_molecules("lj/cut/coul/long 2.5", *KSPACE),
        thermostat.MOVER,
        _variants("lj/cut/coul/long", "opt", "omp", "intel"),
    ),
    "lj/charmm/coul/charmm": Scene(
        of_molecules("lj/charmm/coul/charmm 2.0 3.0"),
        thermostat.MOVER,
        _variants("lj/charmm/coul/charmm", "omp", "intel"),
    ),
    "water": Scene(
        [*LIQUID, *KSPACE],
        "gear/quat molecule temp 300 300 100",
        _variants("lj/cut/coul/long", "opt", "omp", "intel"),
        thermostat.Bodies(tuple(WATER_MASSES), EDGE**3, 0.0019872067),
    ),
}


def script(name, temp, suffix="", known=False):
    """Lines of a job; ``known`` if the start shall take known forces only."""
    here = SCENES[name]
    lines = [*here.lines, f"fix m bodies {here.temp if temp else beside.MOVERS['gear']}"]
    lines += [UNFOLLOWED] if known else []
    # LAMMPS refuses it if no such style is in use
    lines += [f"compute variant all pair {here.variants[suffix]}"] if suffix else []
    run = [f"thermo {STEPS}", f"run {STEPS}"]
    lines += ["@state begin", *run, "@state middle", *(thermostat.note("middle") if temp else ())]
    return [*lines, *run, "@state atoms", *(thermostat.note("atoms") if temp else ())]


@dataclass
class VariantVerdict:
    """``start``: the message about it in the log."""

    name: str
    start: str = ""
    faults: list = field(default_factory=list)


def outcomes(engine, suffix, ranks, folder):
    """Outcomes of all scenes that have variants with this suffix, on this number of ranks."""
    folder.mkdir(parents=True, exist_ok=True)
    scene.write_files(folder)
    water_data(folder / "data.water", EDGE, spacing=3.2, shift=1.6)
    names = [(n, temp) for n in SCENES if suffix in SCENES[n].variants for temp in (False, True)]
    plain = {(*name, known): script(*name, known=known) for name in names for known in (False, True)}
    references = engine.answers(plain, folder, ranks)
    variant = engine.with_suffix(suffix)
    answers = variant.answers({name: script(*name, suffix) for name in names}, folder, ranks)
    return [
        judge(name, suffix, ranks, answers[name], *(references[(*name, k)] for k in (False, True)))
        for name in names
    ]


def start_of(answer):
    """The message about the start in the log, without the name of the fix."""
    return next((line for line in answer.warnings if "start" in line), "").partition(": ")[2]


def judge(name, suffix, ranks, ours, plain, known):
    """VariantVerdict of scene ``name`` from its answers with the suffix, without, and with known forces only."""
    style, temp = name
    outcome = VariantVerdict(f"{style}{', temp' * temp}, {ranks} rank{'s' * (ranks > 1)}", start_of(ours))
    for answer in (ours, plain, known):
        if answer.error:
            outcome.faults.append(answer.first_line)
            return outcome
    if outcome.start == start_of(plain):
        reference = plain
    else:
        reference = known
        if "order 2" not in outcome.start or suffix not in outcome.start.lower():
            outcome.faults.append(f"{outcome.start}, and without the suffix {start_of(plain)}")
    wrong = beside.worst(beside.distances(ours, reference), beside.SAME)
    if wrong:
        outcome.faults.append(f"another motion than without the suffix: {wrong}")
    if temp:
        outcome.faults += thermostat.faults(ours, False, SCENES[style].bodies)
    return outcome
