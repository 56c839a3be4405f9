"""Instructions of a step with each method, counted by callgrind."""

import re
from dataclasses import dataclass

from benchmarks.studies.effects import count

#: what LAMMPS calls in the fixes at a step
FIXES = re.compile(r"LAMMPS_NS::Fix\w+::")
MODIFY = re.compile(r"LAMMPS_NS::Modify::(initial_integrate|pre_\w+|post_\w+|final_integrate|end_of_step)\(")
#: what a step does only now and then
RENEWED = re.compile(r"LAMMPS_NS::(Neighbor::build|Comm\w*::(exchange|borders))\(")
#: who makes the mesh of PPPM anew for the new box of a step, by whom it is called
MESH = (
    (re.compile(r"LAMMPS_NS::PPPM::setup\("), FIXES),
    (re.compile(r"LAMMPS_NS::GearQuat::Box::show\("), re.compile(r"::predict\(")),
)
#: evaluations of the start, which belong to no step
START = re.compile(r"LAMMPS_NS::GearQuat::Motion::begin_steps\(")
RUN = re.compile(r"LAMMPS_NS::Verlet::run\(")


@dataclass(frozen=True)
class Instructions:
    """Per molecule and step: in the ``fixes`` but for the ``mesh`` of PPPM, which they make anew for the new box, and
    of the ``step`` without the building of neighbor lists."""

    fixes: float
    mesh: float
    step: float


def measure(lab, deck, variables, methods, molecules, steps):
    """Method -> Instructions of a deck whose only steps are these."""
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
