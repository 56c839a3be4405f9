"""Runs in pieces, cut in the middle of a collision: the same to the last bit as in one go."""

from dataclasses import dataclass

import numpy as np

from benchmarks.engine.tables import Row
from .case import FORMULATIONS, Case, Curve, Finding, Panel, at_most, floor

STEPS, MIDDLE, EVERY = 2000, 660, 20
#: asked where the fix was removed: to the error of a new start
ANEW = 1e-7
#: asked of energies that rerun finds at dumped poses, to the second order of predicted to corrected
RERUN = 1e-10
#: life: what happens, and whether it is to be the same to the last bit
LIVES = {
    "pieces": ("`run 0`, `run` many times, `pre no`, `every`", True),
    "reset": ("`reset_timestep`", True),
    "restart": ("`write_restart`, in the run that writes", True),
    "continued": ("`write_restart`, `read_restart`", True),
    "rerun": ("`rerun` and on, `reinit no`", True),
    "rerun-yes": ("`rerun` and on, `reinit yes`: bodies begin anew", False),
    "refix": ("`unfix` and back", False),
}


@dataclass(frozen=True)
class Lived:
    """How a run ended: ``text``, its last dump as written; ``positions`` (n, 3).

    ``rerun``: largest difference of an energy from that of the run itself, None where there is none.
    """

    text: str
    positions: np.ndarray
    rerun: float = None


def judge(results):
    """Rows; ``results``: (life or "whole", formulation) -> Lived."""
    rows = []
    for life, (words, same) in LIVES.items():
        if (life, FORMULATIONS[0]) not in results:
            continue
        pairs = [(results["whole", f], results[life, f]) for f in FORMULATIONS]
        worst = max(np.abs(a.positions - b.positions).max() for a, b in pairs)
        if not same:
            rows.append(at_most(f"{words}: sites at the end, both formulations", ANEW, worst))
            continue
        equal = all(a.text == b.text for a, b in pairs)
        measured = "the same digits" if equal else f"{worst:.1e}"
        rows.append(
            Row(f"{words}: sites at the end, both formulations", "bit-identical", measured, equal)
        )
    again = [lived.rerun for (life, _), lived in results.items() if life == "rerun-yes"]
    if again:
        rows.append(at_most("`rerun`: total energy at dumped poses", RERUN, max(again)))
    return tuple(rows)


def panels(results, whole):
    """The cut, and differences at the end; ``whole``: thermo table of the run in one go."""
    cut = MIDDLE * whole["Time"][-1] / STEPS
    hit = (
        Curve("potential energy", whole["Time"], whole["c_potential"], "potential"),
        Curve("the cut", np.array([cut, cut]), np.array([-5.0, 70.0]), "rigid", "--"),
    )
    curves = []
    for formulation in FORMULATIONS:
        y = [
            np.abs(results["whole", formulation].positions - results[life, formulation].positions)
            for life in LIVES
        ]
        x = np.arange(len(LIVES))
        worst = floor(np.array([v.max() for v in y]), 1e-17)
        curves.append(Curve(formulation, x, worst, formulation, "", "o"))
    ticks = ("pieces", "reset", "restart", "contin.", "rerun", "rerun\nreinit", "refix")
    return (
        Panel("second formulation", "time", "energy", hit, log=""),
        Panel(
            "against the run in one go; 1e-17: the same digits",
            "",
            "distance of a site",
            tuple(curves),
            ticks=ticks,
        ),
    )


def _lived(finished):
    """Lived of a finished run; that of a rerun compares its energies with the run's own."""
    text = finished.dump.read_text(encoding="utf-8").rpartition("ITEM: ATOMS")[2]
    positions, rerun = finished.sites.positions[-1], None
    if len(finished.tables) == 3:  # first part, rerun, second part
        run, again = (table["v_total"] for table in finished.tables[:2])
        rerun = float(np.abs(run - again).max())
    return Lived(text, positions, rerun)


def measure(runs, lives=tuple(LIVES), **options):
    """(life or "whole", formulation) -> Lived, and the thermo table of the whole run.

    The life "continued" needs "restart", which writes the file it begins from.
    """
    variables = {}
    for formulation in FORMULATIONS:
        for name in ("whole", *lives):
            life, _, reinit = name.partition("-")
            variables[f"{name}_{formulation}"] = {
                "life": life,
                "formulation": formulation,
                "reinit": reinit or ("no" if life == "rerun" else "yes"),
                "every": EVERY,
                "steps": STEPS if life == "whole" else MIDDLE,
            } | options
    after = {name: v for name, v in variables.items() if v["life"] == "continued"}
    found = runs.many("lifecycle", {n: v for n, v in variables.items() if n not in after})
    for name, v in after.items():
        _, dump = runs.files("lifecycle", f"restart_{v['formulation']}")
        v |= {"from": dump.with_suffix(".restart").resolve(), "steps": STEPS - MIDDLE}
    found |= runs.many("lifecycle", after)
    lived = {tuple(name.split("_")): _lived(finished) for name, finished in found.items()}
    return lived, found[f"whole_{FORMULATIONS[0]}"].thermo


def run(runs):
    """Finding of the case."""
    results, whole = measure(runs)
    text = (
        "The top of the collision, cut when its potential energy is largest. A rerun puts the atoms "
        "where they were: with `reinit yes`, the default, its kinetic energies are those of the frames "
        "and the bodies begin anew after it, which the fix says; with `reinit no` bodies, and their "
        "kinetic energies, stay what they are."
    )
    return Finding(judge(results), panels(results, whole), text)


CASE = Case(
    "lifecycle",
    "Life cycle, in the middle of an encounter",
    "A history has to outlive everything that may happen between two steps.",
    6.0,
    run,
)
