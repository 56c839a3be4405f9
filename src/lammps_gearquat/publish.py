"""Put what a run has measured into a checkout: doc/results.md, doc/figures, README's block.

Every number that README shows comes from here, so that none of them can go stale unnoticed.
"""

import datetime
import os
import platform
import re
import shutil
from collections import Counter
from importlib import metadata
from pathlib import Path

from . import accuracy, report
from .cases import ACCURACY_END, ACCURACY_STEPS
from .claims import EXPLAINED, NOT, REPRODUCED

COMMAND = "gearquat cases --publish"
BEGIN = f"<!-- begin: written by `{COMMAND}` -->"
END = "<!-- end -->"

#: committed figures and what they show; all of them are among the figures of the run
FIGURES = {
    "overview.png": "The cage, the paths of test cases 1 and 3, and what accuracy costs there.",
    "parting.png": "How fast the two formulations part, by body, start and projection.",
    "figure04.png": "Fig. 4 of the paper: x of the centre of mass in test case 1.",
    "figure06.png": "Fig. 6 of the paper: test case 2, where the step is too large.",
    "figure09.png": "Fig. 9 of the paper: kinetic energies in test case 3, where the body leaves.",
}
GEAR_SECOND, GEAR_FIRST, PAPER_SECOND, _, RIGID = accuracy.METHODS


class PublishError(RuntimeError):
    """The folder is not a checkout of GEARQUAT."""


def checkout(folder):
    """``folder`` as a Path, if it is a checkout."""
    folder = Path(folder).resolve()
    readme = folder / "README.md"
    if not (folder / "src" / "GEARQUAT").is_dir() or not readme.is_file():
        raise PublishError(f"{folder} is not a checkout of GEARQUAT")
    split_readme(readme.read_text(encoding="utf-8"))
    return folder


def split_readme(text):
    """README before, inside and after the markers."""
    if text.count(BEGIN) != 1 or text.count(END) != 1 or text.index(BEGIN) > text.index(END):
        raise PublishError(f"README.md needs one {BEGIN} and after it one {END}")
    before, rest = text.split(BEGIN)
    inside, after = rest.split(END)
    return before, inside, after


# --- where it was measured ----------------------------------------------------------------------
def processor():
    """Name of the processor, as Linux tells it."""
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except OSError:
        text = ""
    found = re.search(r"^model name\s*:\s*(.*)$", text, re.MULTILINE)
    return found[1].strip() if found else platform.machine()


def system():
    """Name of the operating system."""
    try:
        return platform.freedesktop_os_release()["PRETTY_NAME"]
    except (OSError, KeyError):
        return platform.system()


def lammps_of(logs):
    """The LAMMPS that wrote the logs in a folder, from their first lines."""
    first = {log.open(encoding="utf-8").readline().strip() for log in Path(logs).glob("log.*")}
    return ", ".join(sorted(first)) or "LAMMPS of unknown version"


def provenance(out):
    """One sentence: what measured, where and when.  ``out``: folder of the run."""
    cores = len(os.sched_getaffinity(0))
    versions = [f"{name} {metadata.version(name)}" for name in ("lammps-gearquat", "numpy")]
    return (
        f"Measured with {lammps_of(Path(out) / 'logs')}, {', '.join(versions)}, Python "
        f"{platform.python_version()}, on {system()}, {processor()} ({cores} cores), "
        f"{datetime.date.today():%d %b %Y}."
    )


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


def readme_block(claims, results, out):
    """What README shows between its markers."""
    lines = [
        f"![{FIGURES['overview.png']}](doc/figures/overview.png)",
        "",
        f"*{FIGURES['overview.png']} The charges of the cage are reconstructed: the paper does not "
        "print them.*",
        "",
        *report.accuracy_markdown(results),
        "",
        f"Test case 1, consistent body; its trajectory to t = {ACCURACY_END:g} is known from "
        "extended precision. One step is one evaluation of the forces in every row. "
        f"{accuracy_sentence(results)} {energy_sentence(results)}",
        "",
        f"{counted(claims)} Every claim with its numbers, its rule and its verdict, and Table 7 by "
        "threshold: [doc/results.md](doc/results.md).",
        "",
        f"{provenance(out)} Times a step are those of a shared machine with several runs at once.",
    ]
    return "\n".join(lines)


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
        counted(claims),
        "",
        *report.tables_markdown(claims, results),
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
    folder, out = checkout(folder), Path(out)
    figures = folder / "doc" / "figures"
    figures.mkdir(parents=True, exist_ok=True)
    for name in FIGURES:
        shutil.copyfile(out / "figures" / name, figures / name)
    text = results_text(claims, results, out)
    (folder / "doc" / "results.md").write_text(text, encoding="utf-8")
    readme = folder / "README.md"
    before, _, after = split_readme(readme.read_text(encoding="utf-8"))
    block = readme_block(claims, results, out)
    readme.write_text(f"{before}{BEGIN}\n{block}\n{END}{after}", encoding="utf-8")
