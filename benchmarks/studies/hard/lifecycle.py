"""Runs in pieces, cut in the middle of a collision: the same to the last bit as in one go."""

from dataclasses import dataclass

import numpy as np

from benchmarks.engine import FORMULATIONS, Curve, Finding, Measurement, Panel, deck, floor

TITLE, SECONDS = "Life cycle, in the middle of an encounter", 6.0
STEPS, MIDDLE, EVERY = 2000, 660, 20
#: where the fix was removed: the error of a new start
MOST_ANEW = 1e-7
#: of energies that rerun finds at dumped poses: the second order of predicted to corrected
MOST_RERUN = 1e-10
#: life: (what happens, short name, whether it has to end the same to the last bit)
LIVES = {
    "pieces": ("`run 0`, `run` many times, `pre no`, `every`", "pieces", True),
    "reset": ("`reset_timestep`", "reset", True),
    "restart": ("`write_restart`, in the run that writes", "restart", True),
    "continued": ("`write_restart`, `read_restart`", "contin.", True),
    "rerun": ("`rerun` and on, `reinit no`", "rerun", True),
    "rerun-yes": ("`rerun` and on, `reinit yes`: bodies begin anew", "rerun\nreinit", False),
    "refix": ("`unfix` and back", "refix", False),
}


@dataclass(frozen=True)
class Lived:
    """How a run ended: ``text``, its last dump as written; ``positions`` (n, 3).

    ``rerun``: largest difference of an energy from that of the run itself, None where there is none.
    ``time`` and ``potential`` energy (n,) of the last part.
    """

    text: str
    positions: np.ndarray
    time: np.ndarray
    potential: np.ndarray
    rerun: float = None


def read(finished):
    """Lived of a finished run; that of a rerun compares its energies with the run's own."""
    text = finished.dump.read_text(encoding="utf-8").rpartition("ITEM: ATOMS")[2]
    tables, thermo, rerun = finished.log.tables, finished.thermo, None
    if len(tables) == 3:  # first part, rerun, second part
        run, again = (table["v_total"] for table in tables[:2])
        rerun = float(np.abs(run - again).max())
    return Lived(text, finished.sites.positions[-1], thermo["Time"], thermo["c_potential"], rerun)


def measure(lab, lives=tuple(LIVES), **options):
    """(life or "whole", formulation) -> Lived.

    The life "continued" needs "restart", which writes the file it begins from.
    """

    def settings(run):
        life, _, reinit = run["name"].partition("-")
        own = {"life": life, "every": EVERY, "steps": STEPS if life == "whole" else MIDDLE}
        own["reinit"] = reinit or ("no" if life == "rerun" else "yes")
        if life == "continued":
            written = lab.dump(f"lifecycle_restart_{run['formulation']}").with_suffix(".restart")
            own |= {"from": written.resolve(), "steps": STEPS - MIDDLE}
        return own | options

    results, scene = {}, deck("hard/lifecycle")
    for names in (["whole", *(life for life in lives if life != "continued")], ["continued"]):
        if set(names) <= {"whole", *lives}:
            axes = {"name": names, "formulation": FORMULATIONS}
            results |= lab.sweep("lifecycle", scene, axes, read, settings)
    return results


def find(results):
    """Finding of what ``measure`` returns."""
    measurements = []
    lives = [life for life in LIVES if (life, FORMULATIONS[0]) in results]
    for life in lives:
        words, _, same = LIVES[life]
        pairs = [(results["whole", f], results[life, f]) for f in FORMULATIONS]
        worst = max(np.abs(a.positions - b.positions).max() for a, b in pairs)
        what = f"{words}: largest difference of a position at the end"
        alike = all(a.text == b.text for a, b in pairs)  # -0 and 0 differ, too
        if not same:
            own = {"value": worst, "most": MOST_ANEW}
        elif alike:
            own = {"value": 0.0, "spec": ".0f", "remark": "the same digits", "most": 0.0}
        else:
            own = {"value": max(worst, 5e-324), "most": 0.0}
        measurements.append(Measurement(what, **own))
    again = [lived.rerun for (life, _), lived in results.items() if life == "rerun-yes"]
    if again:
        what = "`rerun`: largest difference of the total energy at dumped poses"
        measurements.append(Measurement(what, max(again), most=MOST_RERUN))
    return Finding(measurements, pictures={"lifecycle": _panels(results, lives)})


def _panels(results, lives):
    """The cut, and differences at the end."""
    whole = results["whole", FORMULATIONS[0]]
    cut = MIDDLE * whole.time[-1] / STEPS
    hit = (
        Curve("potential energy", whole.time, whole.potential, "potential"),
        Curve("the cut", np.array([cut, cut]), np.array([-5.0, 70.0]), "rigid", "--"),
    )
    curves = []
    for formulation in FORMULATIONS:
        of_whole = results["whole", formulation].positions
        y = [np.abs(of_whole - results[life, formulation].positions).max() for life in lives]
        curves.append(Curve(formulation, np.arange(len(y)), floor(y), formulation, "", "o"))
    title = "against the run in one go; 1e-17: the same digits"
    ticks = tuple(LIVES[life][1] for life in lives)
    return (
        Panel("second formulation", "time", "energy", hit, log=""),
        Panel(title, "", "distance of a site", tuple(curves), ticks=ticks),
    )
