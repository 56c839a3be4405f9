"""Instructions of a step with each method, counted by callgrind."""

import re
from dataclasses import dataclass

from benchmarks.studies.effects import count

#: functions of fixes that LAMMPS calls in a step
FIXES = re.compile(r"LAMMPS_NS::Fix\w+::")
MODIFY = re.compile(r"LAMMPS_NS::Modify::(initial_integrate|pre_\w+|post_\w+|final_integrate|end_of_step)\(")
#: functions that are not called in every step
RENEWED = re.compile(r"LAMMPS_NS::(Neighbor::build|Comm\w*::(exchange|borders))\(")
#: functions that set up the mesh of PPPM for the new box of a step, and their callers
MESH = (
    (re.compile(r"LAMMPS_NS::PPPM::setup\("), FIXES),
    (re.compile(r"LAMMPS_NS::GearQuat::Box::show\("), re.compile(r"::predict\(")),
)
#: evaluations of the start, which are not part of a step
START = re.compile(r"LAMMPS_NS::GearQuat::Step::start\(")
RUN = re.compile(r"LAMMPS_NS::Verlet::run\(")


@dataclass(frozen=True)
class Instructions:
    """Instructions per molecule and step: in the ``fixes`` without the ``mesh`` of PPPM, in setting up this ``mesh`` for the
    new box, and in the ``step`` without the building of neighbor lists."""

    fixes: float
    mesh: float
    step: float


def measure(lab, deck, variables, methods, molecules, steps):
    """Method -> Instructions of a deck that runs only these steps."""
    found = {}
    for method in methods:
        own = variables | {"method": method, "steps": steps, "every": steps}
        profile = count.whole(lab.out / "count" / method, deck, own, lab.lmp)
        lists, start = profile.inclusive(RENEWED, RUN), profile.inclusive(START)
        mesh = sum(profile.inclusive(*pair) for pair in MESH)
        fixes, whole = profile.inclusive(FIXES, MODIFY) - start - mesh, profile.own.total() - lists - start
        found[method] = Instructions(*(part / (molecules * steps) for part in (fixes, mesh, whole)))
        lab.advance(1.0 / len(methods))
    return found
