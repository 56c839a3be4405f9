"""Every fix and compute of LAMMPS together with fix gear/quat: tests that results are the same.

For each scene of styles.py these are compared, positions and velocities as well as every output of
the other style:

    order      the other style defined before and after the fix that moves bodies
    ranks      1 and several MPI ranks
    restart    through, and with a restart in the middle
    alone      with and without a style that does nothing to atoms
    rigid      with fix rigid/nve/small, at small steps or (kind COUNT) at the same step

With keyword temp there is no such reference; there the judge of thermostat.py counts degrees of freedom.

Where two runs that should agree do not, the same two are made with fix rigid/nve/small: what LAMMPS
itself does not keep is no fault of fix gear/quat, and is counted apart.
"""

import re
import subprocess
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from lammps_gearquat.trials.worker import ENDED

from . import scene, styles, thermostat
from .styles import BOX, CHANCE, COUNT, FORCE, INTEGRATES, MOVES, PASSIVE, RIGID_ONLY, Try

STEPS, DT = 20, 0.005
#: styles that are tried on 4 ranks in every run of the tests: with data per atom, or global sums
OFTEN = (
    r"spring.*|store/.*|property/atom|ave/atom|msd.*|vacf.*|displace/atom|.*stress/atom|heat/flux|momentum"
    r"|temp/(rescale|berendsen)|wall/harmonic|wall/reflect|addforce|evaporate|balance|recenter|shake|nve|npt"
)
#: and of those with keyword temp, besides one that only reads: with a force, and with bodies that go
OFTEN_WITH_TEMP = r"store/force|wall/harmonic|evaporate"
MOVERS = {
    "gear": "gear/quat molecule values 9",  # whatever the style beside it is
    "rigid": "rigid/nve/small molecule",
    "temp": thermostat.MOVER,
}
#: two runs of the same method: relative to the largest value of a kind
SAME = 2e-9
#: in units of the error of the reference, which is determined by halving its step
WITHIN = 4.0
#: error of fix rigid at step DT in the plain scene, in units of its error at DT/4 to DT/8
BROAD = 1e-5
#: messages of LAMMPS if variants of styles lack a feature that a style needs
NO_VARIANT = re.compile(r"INTEL package does not support")
REFUSES = re.compile(r"[Ff]ix gear/quat")


def listed(executable, kind):
    """Names of all styles of a kind, "fix" or "compute", in `lmp -h`."""
    text = subprocess.run([str(executable), "-h"], capture_output=True, text=True).stdout
    title = rf"\* {kind.capitalize()} styles:?"
    block = re.search(rf"^{title}\n\n(.*?)\n\n\*", text, re.MULTILINE | re.DOTALL)
    return sorted(set(block[1].split()))


# --- scripts --------------------------------------------------------------------------------------
def _fixes(kind, style, a_try, method, order, divide):
    others = []
    if style:
        words = styles.scaled(a_try.args, divide)
        others = [styles.scaled(line, divide) for line in a_try.before]
        others += [f"{kind} n {a_try.group} {style} {words}"]
        if a_try.modify:
            others += [f"{kind}_modify n {a_try.modify}"]
    movers = [f"fix m bodies {MOVERS[method]}"]
    if a_try.kind not in (INTEGRATES, BOX):
        movers += ["fix f free nve"]
    lines = others + movers if order == "before" else movers + others
    if "sphere" in a_try.atoms:
        lines += ["compute ts all temp/sphere", "thermo_modify temp ts"]
    lines += thermostat.OUTPUT if method == "temp" else ()
    if style and a_try.outputs:
        lines += [f"@probe {kind} n {STEPS * divide}"]
    return [*lines, f"thermo {STEPS * divide}", f"timestep {DT / divide}"]


def script(
    kind, style, a_try, method="gear", order="after", divide=1, restart=False, alone=False
):
    """Lines of a job: two runs, with a restart between them or not; ``alone`` without free atoms."""
    fixes = _fixes(kind, style, a_try, method, order, divide)
    run = [f"run {STEPS * divide}"]
    if a_try.pieces and method == "rigid":
        pieces = a_try.pieces * divide if a_try.pieces > 1 else 1
        run = [f"run {pieces}"] * (STEPS * divide // pieces)
    lines = [*scene.begin(a_try.atoms), *a_try.once, *(thermostat.BEGIN if alone else ())]
    lines += ["@state begin", *fixes, *run] if method == "temp" else [*fixes, *run]
    if method == "temp":
        lines += ["@state middle", *thermostat.note("middle")]
    if restart:
        lines += ["write_restart middle", "clear", "read_restart middle"]
        lines += [*scene.after_restart(), *fixes]
    lines += [*run, "@state atoms", "@values values"]
    return lines + (thermostat.note("atoms") if method == "temp" else [])


# --- comparing ------------------------------------------------------------------------------------
def _distance(a, b):
    """Largest difference in units of the largest value; infinite if shapes or NaN differ."""
    if a.shape != b.shape:
        return np.inf
    finite = np.isfinite(a)
    others = (np.where(np.isfinite(values), 0.0, values) for values in (a, b))
    if not np.array_equal(*others, equal_nan=True):
        return np.inf
    scale = max(np.abs(values[finite]).max(initial=0.0) for values in (a, b))
    return np.abs(a[finite] - b[finite]).max() / scale if scale > 1e-9 else 0.0


def distances(one, other, sums=False):
    """Dictionary of the entries of two answers -> distance; "error" alone if one of them is an error.

    With ``sums`` per-atom values are added up first.
    """
    if one.error or other.error:
        return {"error": 0.0 if bool(one.error) == bool(other.error) else np.inf}
    a, b = one.noted["atoms"], other.noted["atoms"]
    if a.shape != b.shape or (a[:, 0] != b[:, 0]).any():
        return {"atoms": np.inf}
    found = {"x": _distance(a[:, 1:4], b[:, 1:4]), "v": _distance(a[:, 4:], b[:, 4:])}
    left, right = one.noted.get("values", {}), other.noted.get("values", {})
    for form in left.keys() & right.keys():
        a, b = left[form], right[form]
        if sums and form.split()[1].startswith("atom"):
            a, b = a.sum(axis=0)[1:], b.sum(axis=0)[1:]
        found[form] = _distance(a, b)
    return found


def worst(found, tolerance):
    """The entries above their tolerance (a number, or a dictionary) as text."""
    limit = tolerance if isinstance(tolerance, dict) else dict.fromkeys(found, tolerance)
    wrong = {name: value for name, value in found.items() if not value <= limit.get(name, SAME)}
    return ", ".join(f"{name} {value:.1e}" for name, value in sorted(wrong.items()))


def beyond(ours, coarse, fine, a_try):
    """The entries of ``ours`` that are further from the finer reference than its error allows, as text."""
    error = distances(coarse, fine, a_try.sums)
    apart = distances(ours, fine, a_try.sums)
    if a_try.pieces:  # counts of the style start again with each part of the run
        apart = {name: apart[name] for name in apart if name in ("x", "v", "atoms", "error")}
    wrong = worst(apart, {name: WITHIN * error[name] + a_try.floor for name in error})
    if not wrong:
        return ""
    names = [name for name in apart if f"{name} " in wrong]
    return f"{wrong} (its own error: {', '.join(f'{name} {error[name]:.1e}' for name in names)})"


# --- one style ------------------------------------------------------------------------------------
@dataclass
class StyleVerdict:
    """``result``: same, acts, refused, warned, LAMMPS refuses, or DIFFERS."""

    kind: str
    style: str
    a_try: Try
    result: str = ""
    faults: list = field(default_factory=list)
    excused: list = field(default_factory=list)

    @property
    def name(self):
        words = f" {styles.scaled(self.a_try.args, 1)}" if self.a_try.args else ""
        return f"{self.kind} {self.a_try.group} {self.style}{words}"


class SceneRun(NamedTuple):
    """One run of the scene with that number."""

    scene: int
    order: str = "after"
    ranks: int = 1
    restart: bool = False
    method: str = "gear"
    divide: int = 1

    def __str__(self):
        many, restart = "s" * (self.ranks > 1), ", restart" * self.restart
        return f"{self.order}, {self.ranks} rank{many}{restart}"

    def rigid(self):
        """The same with fix rigid/nve/small."""
        return self._replace(method="rigid")


def variants(n, a_try, ranks):
    """The runs of scene ``n`` that have to agree; the other runs are compared with the first."""
    found, several = [SceneRun(n), SceneRun(n, "before")], [number for number in ranks if number > 1]
    if a_try.kind in (INTEGRATES, BOX, RIGID_ONLY) or not a_try.restarts:
        return found + [SceneRun(n, ranks=number) for number in several]
    found += [SceneRun(n, restart=True), SceneRun(n, "before", restart=True)]
    for number in several:
        found += [SceneRun(n, "after", number), SceneRun(n, "before", number, restart=True)]
    return found


class Campaign:
    """All scenes.

    ``run`` is a function (jobs, ranks) -> answers; ``temp`` if the fix is a thermostat, ``conserves`` if
    forces are derivatives of an energy.
    """

    def __init__(self, scenes, ranks, run, temp=False, conserves=True):
        self.scenes, self.ranks, self.run_jobs = scenes, ranks, run
        self.temp, self.conserves = temp, conserves
        self.answers = {}

    def _script(self, run):
        method = "temp" if self.temp and run.method == "gear" else run.method
        words = *self.scenes[run.scene], method, run.order, run.divide, run.restart
        return script(*words, alone=self.temp)

    def _answers(self, *runs):
        """Answers of these runs; missing runs are made first, all together."""
        for ranks in self.ranks:
            jobs = {
                run: self._script(run)
                for run in runs
                if run.ranks == ranks and run not in self.answers
            }
            if jobs:
                self.answers |= self.run_jobs(jobs, ranks)
        return [self.answers[run] for run in runs]

    def _references(self, n):
        """Runs in which scene ``n`` is compared with fix rigid: ours, and then with fix rigid."""
        a_try = self.scenes[n][2]
        if self.temp:
            return []
        # a rigid fix includes in its first forces only fixes that are defined before it
        rigid = SceneRun(n, "after" if a_try.behind else "before").rigid()
        if a_try.kind in (PASSIVE, FORCE):
            return [SceneRun(n, divide=4), rigid._replace(divide=4), rigid._replace(divide=8)]
        return [SceneRun(n), rigid] if a_try.kind == COUNT else []

    def outcomes(self):
        tried = [n for n, (_, style, _) in enumerate(self.scenes) if style]
        alone = [SceneRun(n) for n, (_, style, _) in enumerate(self.scenes) if not style]
        for runs_of in (lambda n: variants(n, self.scenes[n][2], self.ranks), self._references):
            self._answers(*alone, *(run for n in tried for run in runs_of(n)))
        return [self._judge(n) for n in tried]

    def _judge(self, n):
        outcome = StyleVerdict(*self.scenes[n])
        kind, runs = outcome.a_try.kind, variants(n, outcome.a_try, self.ranks)
        answers = dict(zip(runs, self._answers(*runs)))
        another = self.temp and outcome.kind == "fix" and outcome.a_try.group != "free"
        another = another and thermostat.THERMOSTATS.fullmatch(outcome.style)
        if another or kind in (INTEGRATES, BOX, MOVES, RIGID_ONLY):
            self._refused(outcome, answers)
            return outcome
        if all(NO_VARIANT.search(answer.error) for answer in answers.values()):
            outcome.result = "LAMMPS refuses"
            return outcome
        self._without_refusals_of_lammps(outcome, answers)
        if not outcome.faults:
            self._consistent(outcome, answers)
            if kind == PASSIVE or (kind == FORCE and not self.temp):
                self._beside_none(outcome, answers[SceneRun(n)])
            self._like_rigid(outcome, self._answers(*self._references(n)))
            if self.temp:
                self._counted(outcome, answers)
        outcome.result = "DIFFERS" if outcome.faults else "same" if kind == PASSIVE else "acts"
        return outcome

    def _refused(self, outcome, answers):
        """In every variant the fix, or LAMMPS, has to refuse, or the fix to warn."""
        name = re.compile(rf"\b{re.escape(outcome.style)}\b")

        def said(answer):
            """The reason why the fix, or otherwise LAMMPS, refuses the style."""
            warnings = (
                line
                for line in answer.warnings
                if "WARNING" in line and REFUSES.search(line) and name.search(line)
            )
            return answer.first_line if answer.error else next(warnings, "")

        first = next(iter(answers.values()))
        if not all(map(said, answers.values())):
            outcome.result = "DIFFERS"
            outcome.faults.append("neither refused nor warned of")
        elif not REFUSES.search(said(first)):
            outcome.result = "LAMMPS refuses"
        else:
            outcome.result = "refused" if first.error else "warned"

    def _without_refusals_of_lammps(self, outcome, answers):
        """Excuses errors that LAMMPS ends the same variant with beside fix rigid, such as a style that does
        not run on several ranks: these leave ``answers``.  Any other is a fault; a crash is never excused."""
        errors = {run: answer for run, answer in answers.items() if answer.error}
        for run, answer in errors.items():
            (rigid,) = self._answers(run.rigid())
            told = f"{run}: {answer.first_line}"
            first = run == next(iter(answers))
            if answer.error.startswith(ENDED) or rigid.error != answer.error or first:
                same = f"with fix rigid: {rigid.first_line}" if rigid.error else "fix rigid runs"
                outcome.faults.append(f"{told} ({same})")
            else:
                del answers[run]
                outcome.excused.append(told)

    def _consistent(self, outcome, answers):
        first = next(iter(answers))
        for run, answer in answers.items():
            if run.ranks > 1 and outcome.a_try.kind == CHANCE:
                continue  # each rank draws its own numbers
            ours = distances(answers[first], answer)
            wrong = worst(ours, SAME)
            if not wrong:
                continue
            control = distances(*self._answers(first.rigid(), run.rigid()))
            bad = [name for name, value in ours.items() if not value <= SAME]
            if all(control.get(name, 0.0) >= 0.1 * ours[name] for name in bad):
                outcome.excused.append(f"{run}: {wrong}")
            else:
                rigid = worst(control, SAME) or "same"
                outcome.faults.append(f"{run}: {wrong} (with fix rigid: {rigid})")

    def _beside_none(self, outcome, answer):
        """Against the same atoms without another style: the same if it is passive, others if it has a force."""
        (plain,) = (
            n
            for n, (_, style, a_try) in enumerate(self.scenes)
            if not style and a_try.atoms == outcome.a_try.atoms
        )
        wrong = worst(distances(*self._answers(SceneRun(plain)), answer), SAME)
        if outcome.a_try.kind == FORCE and not wrong:
            outcome.faults.append("it has no effect in this scene")
        # by the rule of keyword temp, the total momentum then counts, also beside a force of zero
        counts = any("may exert forces" in line for line in answer.warnings)
        if outcome.a_try.kind == PASSIVE and wrong and not counts:
            outcome.faults.append(f"alone: {wrong}")

    def _counted(self, outcome, answers):
        """The degrees of freedom of the thermostat, and the energy that it conserves."""
        a_try = outcome.a_try
        conserves = a_try.kind == PASSIVE or (a_try.kind == FORCE and "energy" in a_try.modify)
        conserves = conserves and self.conserves
        for run, answer in answers.items():
            wrong = thermostat.faults(answer, conserves)
            if wrong:
                outcome.faults.append(f"{run}: {'; '.join(wrong)}")

    def _like_rigid(self, outcome, answers):
        """Against fix rigid at small steps, or at the same: its error at that step is below BROAD."""
        errors = [answer.first_line for answer in answers if answer.error]
        if errors:
            outcome.faults.append(f"rigid: {errors[0]}")
        elif len(answers) == 3:
            wrong = beyond(*answers, outcome.a_try)
            if wrong:
                outcome.faults.append(f"rigid: {wrong}")
        elif answers:
            apart = distances(*answers)
            wrong = worst(apart, dict.fromkeys(apart, max(BROAD, outcome.a_try.floor)))
            if wrong:
                outcome.faults.append(f"rigid at the same step: {wrong}")


# --- all ------------------------------------------------------------------------------------------
def scenes_of(executable, only=None):
    """([(kind, style, Try)], {style: reason}, [unknown styles]) for the styles that `lmp -h` lists."""
    scenes = [("fix", "", Try(PASSIVE, atoms=atoms)) for atoms in scene.FORMATS]
    reasons, unknown = {}, []
    for kind in ("fix", "compute"):
        for style in listed(executable, kind):
            if style == "gear/quat" or (only and not re.fullmatch(only, style)):
                continue
            found = styles.known(kind, style)
            if found is None:
                unknown.append(f"{kind} {style}")
            elif isinstance(found, str):
                reasons[f"{kind} {style}"] = found
            else:
                scenes += [(kind, style, a_try) for a_try in found]
    return scenes, reasons, unknown


def scenes_with_temp(scenes, kinds):
    """The scenes of these kinds ("fix", "compute") that say something where all atoms are in bodies."""
    return [
        (kind, style, a_try)
        for kind, style, a_try in scenes
        if kind in kinds and (a_try.group != "free" or style in thermostat.INSERTS)
    ]
