"""The paper's three test cases, and its claims about them.

plan.py (runs), claims.py (the paper's claims and their verdicts), accuracy.py (errors by step), figures.py (the paper's
figures and two others).
"""

from benchmarks.engine import Finding, Measurement, Study, Table

from . import accuracy
from .claims import EXPLAINED, NOT, REPRODUCED, THRESHOLDS, all_claims, parting_times, show_times
from .figures import pictures
from .plan import ACCURACY_END, ACCURACY_STEPS, ACCURATE, AS_PRINTED, END, ROWS, measure

PAPER_TIMES = ("1300", "250 to 300", "800")
#: bounds of --check: numbers of claims, and errors with the defaults of the fix
LEAST, MOST_NOT, MOST_ERROR = 15, 2, 1e-9
CHECKED_STEP = 0.02


# --- tables -------------------------------------------------------------------------------------
def claim_table(claims):
    """Every claim, what was measured, and the verdict."""
    rows = []
    for judged in claims:
        link = ", " if judged.verdict == REPRODUCED else ": "
        verdict = judged.verdict + (link + judged.why if judged.why else "")
        claim = judged.claim
        rows.append((claim.source, claim.paper, judged.measured, claim.condition, verdict))
    return Table(("where", "the paper says", "measured", "reproduced if", "verdict"), rows)


def table7(results):
    """Times at which the formulations diverge, for every start and threshold.

    The last row is for comparison: the times at which fix rigid/nve/small diverges from the defaults of the fix.
    """
    step = results.step
    header = ["apart by " + " / ".join(f"{t:g}" for t in THRESHOLDS)]
    header += [f"case {case}, step {dt:g}" for case, dt in step.items()]
    rows = [("the paper, which gives no threshold", *PAPER_TIMES)]
    remarks = dict.fromkeys(AS_PRINTED, " (as the paper ran)")
    remarks[ACCURATE] = " (other defaults of the fix)"
    for key, row in ROWS.items():
        times = [show_times(parting_times(results, case, key)) for case in step]
        rows.append((row.label + remarks.get(key, ""), *times))
    pair = ("rigid", "momentum")
    times = [show_times(parting_times(results, case, ACCURATE, pair)) for case in step]
    return Table(header, [*rows, ("fix rigid/nve/small against the defaults of the fix", *times)])


def error_table(first, steps, errors):
    """Errors by method and step."""
    rows = [(label, *(f"{error:.1e}" for error in row)) for label, row in errors.items()]
    return Table((first, *(f"step {step:g}" for step in steps)), rows)


# --- finding ------------------------------------------------------------------------------------
def measurements(position, energy, steps, count):
    """Errors of all methods with all digits, and the number of claims with each verdict."""
    found = [
        Measurement(f"claims that are {REPRODUCED}", count[REPRODUCED], spec="d", least=LEAST),
        Measurement(f"claims that are {NOT}", count[NOT], spec="d", most=MOST_NOT),
    ]
    of_position = f"error of the center of mass at t = {ACCURACY_END:g}"
    of_energy = f"largest error of the total energy to t = {END:g}"
    for words, errors, of_steps, checked in (
        (of_position, position, ACCURACY_STEPS, CHECKED_STEP),
        (of_energy, energy, steps, steps[0]),
    ):
        for label, row in errors.items():
            for step, error in zip(of_steps, row):
                bounded = label == accuracy.DEFAULT and step == checked
                most = MOST_ERROR if bounded else None
                found.append(Measurement(f"{label}, step {step:g}: {words}", error, most=most))
    return found


def listed(numbers):
    """Numbers joined for a sentence, "" if there are none."""
    *others, last = [f"{number:g}" for number in numbers] or [""]
    return f"{', '.join(others)} and {last}" if others else last


def find(results):
    """Finding of plan.Results."""
    claims = all_claims(results)
    verdicts = [judged.verdict for judged in claims]
    count = {verdict: verdicts.count(verdict) for verdict in (REPRODUCED, EXPLAINED, NOT)}
    position, energy = accuracy.position_errors(results), accuracy.energy_errors(results)
    steps, at = accuracy.energy_steps(results), ACCURACY_STEPS.index(CHECKED_STEP)
    ours, rigid = energy[accuracy.DEFAULT], energy[accuracy.RIGID]
    tables = {
        "claims": claim_table(claims),
        "table7": table7(results),
        "position": error_table("error of the center of mass", ACCURACY_STEPS, position),
        "energy": error_table("largest error of the total energy", steps, energy),
    }
    context = {
        "claims": len(claims),
        "count": count,
        "runs": len(results.series),
        "step": CHECKED_STEP,
        "at": {label: errors[at] for label, errors in position.items()},
        "better": listed(step for step, a, b in zip(steps, ours, rigid) if a < b),
        "worse": listed(step for step, a, b in zip(steps, ours, rigid) if not a < b),
        "ends": (ACCURACY_END, END),
    }
    found = measurements(position, energy, steps, count)
    return Finding(found, tables, pictures(results), context)


TITLE = "The paper's claims and what was measured"
STUDY = Study("cases", TITLE, 180.0, measure, find, blocks={"doc/results.md": "results.md.j2"})
