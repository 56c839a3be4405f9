"""Put what a run has measured into a checkout: doc/results.md and doc/figures.
"""

import shutil
from collections import Counter
from pathlib import Path

from benchmarks.engine.checkout import find, provenance
from . import accuracy, tables
from .claims import EXPLAINED, NOT, REPRODUCED
from .runs import ACCURACY_STEPS

COMMAND = "benchmarks/run cases --publish"

#: committed figures and what they show; all of them are among the figures of the run
FIGURES = {
    "overview.png": "The cage, the paths of test cases 1 and 3, and what accuracy costs there.",
    "parting.png": "How fast the two formulations part, by body, start and projection.",
    "figure04.png": "Fig. 4 of the paper: x of the centre of mass in test case 1.",
    "figure06.png": "Fig. 6 of the paper: test case 2, where the step is too large.",
    "figure09.png": "Fig. 9 of the paper: kinetic energies in test case 3, where the body leaves.",
}
GEAR_SECOND, GEAR_FIRST, PAPER_SECOND, _, RIGID = accuracy.METHODS


# --- texts --------------------------------------------------------------------------------------
def counted(claims):
    """How many claims got which verdict, as text."""
    count = Counter(claim.verdict for claim in claims)
    parts = [f"{count[verdict]} {verdict}" for verdict in (REPRODUCED, EXPLAINED, NOT)]
    return f"Of {len(claims)} claims of the paper: " + ", ".join(parts) + "."


def rounded(number):
    """Two significant digits, as a whole number in groups of thousands."""
    return f"{float(f'{number:.1e}'):,.0f}".replace(",", " ")


def accuracy_sentence(results, step=0.02):
    """How much closer to the trajectory than fix rigid/nve/small, at one step."""
    errors = accuracy.position_errors(results)
    at = ACCURACY_STEPS.index(step)
    rigid = errors[RIGID][at]
    first, second = (rounded(rigid / errors[label][at]) for label in (GEAR_FIRST, GEAR_SECOND))
    loss = rounded(errors[PAPER_SECOND][at] / rigid)
    return (
        f"At a step of {step:g} the first formulation ends {first} times closer to the trajectory "
        f"than `fix rigid/nve/small`, the second {second} times; with the paper's own choices the "
        f"second ends {loss} times further away from it."
    )


def energy_sentence(results):
    """At which steps which method holds the energy best, from the table."""
    errors = accuracy.energy_errors(results)
    held = {True: [], False: []}
    for at, step in enumerate(accuracy.ENERGY_STEPS):
        held[errors[GEAR_SECOND][at] < errors[RIGID][at]].append(f"{step:g}")
    parts = []
    if held[True]:
        parts.append(f"better than `fix rigid/nve/small` at steps of {', '.join(held[True])}")
    if held[False]:
        parts.append(f"worse at {', '.join(held[False])}: Gear's method is not symplectic")
    return "The second formulation holds the energy " + " and ".join(parts) + "."


def results_text(claims, results, out):
    """doc/results.md."""
    lines = [
        "# The paper's claims and what was measured",
        "",
        f"Written by `{COMMAND}`; do not edit. {provenance(out)}",
        "",
        f"To make it anew: `examples/run --publish .` in a checkout. The decks are those under "
        f"`examples`, {len(results.runs)} runs, sampled once per unit of time or at every step.",
        "",
        f"{counted(claims)} {accuracy_sentence(results)} {energy_sentence(results)}",
        "",
        *tables.tables_markdown(claims, results),
        "",
        "## Figures",
        "",
        "All of Figures 2 to 13 are drawn by `examples/run`; a few are kept here. The charges of "
        "the cage are reconstructed in all of them.",
    ]
    for name, text in FIGURES.items():
        lines += ["", f"![{text}](figures/{name})", "", f"*{text}*"]
    return "\n".join(lines) + "\n"


def publish(folder, out, claims, results):
    """Write it all.  ``folder``: the checkout; ``out``: where the run left its logs and figures."""
    folder, out = find(folder), Path(out)
    figures = folder / "doc" / "figures"
    figures.mkdir(parents=True, exist_ok=True)
    for name in FIGURES:
        shutil.copyfile(out / "figures" / name, figures / name)
    text = results_text(claims, results, out)
    (folder / "doc" / "results.md").write_text(text, encoding="utf-8")
