"""Every fix and compute of LAMMPS beside fix gear/quat: what has to be the same, and is.

For each scene of styles.py these are compared, positions and velocities as well as every output of
the neighbor:

    order      the neighbor defined before and after the fix that moves bodies
    ranks      1 and several MPI ranks
    restart    through, and with a restart in the middle
    alone      with and without a neighbor that does nothing to atoms
    rigid      with fix rigid/nve/small, at small steps or (kind COUNT) at the same step

Where two runs that should agree do not, the same two are made with fix rigid/nve/small: what LAMMPS
itself does not keep is no fault of fix gear/quat, and is counted apart.
"""

import re
import subprocess
from collections import Counter
from dataclasses import dataclass, field

import numpy as np

from . import scene, styles
from .styles import BOX, CHANCE, COUNT, FORCE, INTEGRATES, MOVES, PASSIVE, RIGID_ONLY, TAKEN, Try

STEPS, DT = 20, 0.005
#: styles that are tried on 4 ranks in every run of the tests: with data per atom, or global sums
OFTEN = (
    r"spring.*|store/.*|property/atom|ave/atom|msd.*|vacf.*|displace/atom|.*stress/atom|heat/flux|momentum"
    r"|temp/(rescale|berendsen)|wall/harmonic|wall/reflect|addforce|evaporate|balance|recenter|shake|nve|npt"
)
MOVERS = {"gear": "gear/quat molecule", "rigid": "rigid/nve/small molecule"}
#: two runs of the same method: relative to the largest value of a kind
SAME = 2e-9
#: in units of the error of the reference, which is found by halving its step
WITHIN = 4.0
#: error of fix rigid at step DT in the plain scene, in units of that at DT/4 to DT/8
BROAD = 1e-5


def listed(executable, kind):
    """Names of all styles of a kind, "fix" or "compute", in `lmp -h`."""
    text = subprocess.run([str(executable), "-h"], capture_output=True, text=True).stdout
    title = {"fix": r"\* Fix styles:?", "compute": r"\* Compute styles:?"}[kind]
    block = re.search(rf"^{title}\n\n(.*?)\n\n\*", text, re.MULTILINE | re.DOTALL)
    return sorted(set(block[1].split()))


# --- scripts --------------------------------------------------------------------------------------
def _fixes(kind, style, a_try, method, order, divide):
    neighbor = []
    if style:
        words = styles.scaled(a_try.args, divide)
        neighbor = [styles.scaled(line, divide) for line in a_try.before]
        neighbor += [f"{kind} n {a_try.group} {style} {words}"]
        if a_try.modify:
            neighbor += [f"{kind}_modify n {a_try.modify}"]
    movers = [f"fix m bodies {MOVERS[method]}"]
    if a_try.kind not in (INTEGRATES, BOX):
        movers += ["fix f free nve"]
    lines = neighbor + movers if order == "before" else movers + neighbor
    if "sphere" in a_try.atoms:
        lines += ["compute ts all temp/sphere", "thermo_modify temp ts"]
    if style and a_try.outputs:
        lines += [f"@probe {kind} n {STEPS * divide}"]
    return [*lines, f"thermo {STEPS * divide}", f"timestep {DT / divide}"]


def script(kind, style, a_try, method="gear", order="after", divide=1, restart=False):
    """Lines of a job: two runs, with a restart between them or not."""
    fixes = _fixes(kind, style, a_try, method, order, divide)
    run = [f"run {STEPS * divide}"]
    if a_try.pieces and method == "rigid":
        pieces = a_try.pieces * divide if a_try.pieces > 1 else 1
        run = [f"run {pieces}"] * (STEPS * divide // pieces)
    lines = [*scene.begin(a_try.atoms), *a_try.once, *fixes, *run]
    if restart:
        lines += ["write_restart middle", "clear", "read_restart middle"]
        lines += [*scene.after_restart(), *fixes]
    return [*lines, *run, "@state atoms", "@values values"]


# --- comparing ------------------------------------------------------------------------------------
def _distance(a, b):
    """Largest difference in units of the largest value; infinite if shapes or NaN differ."""
    if a.shape != b.shape or (np.isnan(a) != np.isnan(b)).any():
        return np.inf
    finite = np.isfinite(a) & np.isfinite(b)
    if (a[~finite & ~np.isnan(a)] != b[~finite & ~np.isnan(b)]).any():
        return np.inf
    if not finite.any():
        return 0.0
    scale = max(np.abs(a[finite]).max(), np.abs(b[finite]).max())
    return np.abs(a[finite] - b[finite]).max() / scale if scale > 1e-9 else 0.0


def distances(one, other, sums=False):
    """Dictionary of what two answers hold -> distance; "error" alone if one of them is an error.

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
    """What of ``ours`` is further from the finer reference than its error allows, as text."""
    error = distances(coarse, fine, a_try.sums)
    apart = distances(ours, fine, a_try.sums)
    if a_try.pieces:  # what the neighbor counts begins anew with each piece
        apart = {name: apart[name] for name in apart if name in ("x", "v", "atoms", "error")}
    wrong = worst(apart, {name: WITHIN * error[name] + a_try.floor for name in error})
    if not wrong:
        return ""
    names = [name for name in apart if f"{name} " in wrong]
    return f"{wrong} (its own error: {', '.join(f'{name} {error[name]:.1e}' for name in names)})"


# --- one style ------------------------------------------------------------------------------------
@dataclass
class Outcome:
    """``result``: same, acts, refused, warned, LAMMPS refuses, or DIFFERS."""

    kind: str
    style: str
    a_try: Try
    result: str = ""
    faults: list = field(default_factory=list)
    excused: list = field(default_factory=list)
    message: str = ""
    ranks: tuple = (1,)

    @property
    def name(self):
        words = f" {self.a_try.args}" if self.a_try.args else ""
        return f"{self.kind} {self.a_try.group} {self.style}{words}"


REFUSES = re.compile(r"[Ff]ix gear/quat")


FIRST = ("after", 1, False)
#: how the reference is run: a rigid fix takes its first forces from the fixes that are defined before
REFERENCE = ("before", 1, False)


def reference(a_try):
    return FIRST if a_try.behind else REFERENCE


def variants(a_try, ranks):
    """(order, ranks, restart) of the runs of a scene; the first is what others are compared with."""
    found = [FIRST, ("before", 1, False)]
    if a_try.kind in (INTEGRATES, BOX, RIGID_ONLY):
        return found + [("after", r, False) for r in ranks if r > 1]
    found += [("after", 1, True), ("before", 1, True)]
    for r in ranks:
        if r > 1:
            found += [("after", r, False), ("before", r, True)]
    return found


def named(variant):
    order, ranks, restart = variant
    return f"{order}, {ranks} rank{'s' * (ranks > 1)}{', restart' * restart}"


class Campaign:
    """All scenes; ``run`` is a function (jobs, ranks) -> answers."""

    def __init__(self, scenes, ranks, run):
        self.scenes, self.ranks, self.run_jobs = scenes, ranks, run
        self.answers = {}

    def _need(self, wanted):
        """Runs what has not been run: keys (scene, method, order, ranks, divide, restart)."""
        for ranks in self.ranks:
            jobs = {}
            for key in wanted:
                if key in self.answers or key[3] != ranks:
                    continue
                number, method, order, _, divide, restart = key
                kind, style, a_try = self.scenes[number]
                jobs[key] = script(kind, style, a_try, method, order, divide, restart)
            if jobs:
                self.answers |= self.run_jobs(jobs, ranks)

    def _key(self, number, variant, method="gear", divide=1):
        order, ranks, restart = variant
        return (number, method, order, ranks, divide, restart)

    def outcomes(self):
        numbers = range(len(self.scenes))
        self._need(
            [self._key(n, v) for n in numbers for v in variants(self.scenes[n][2], self.ranks)]
        )
        smaller = []
        for n in numbers:
            a_try = self.scenes[n][2]
            if a_try.kind in (PASSIVE, FORCE, TAKEN):
                smaller += [self._key(n, FIRST, "gear", 4)]
                smaller += [self._key(n, reference(a_try), "rigid", d) for d in (4, 8)]
            elif a_try.kind in (COUNT, CHANCE, MOVES):
                smaller += [self._key(n, reference(a_try), "rigid")]
        self._need(smaller)
        found = [self._judge(n) for n in numbers if self.scenes[n][1]]
        return found

    def _plain(self, atoms):
        for n, (_, style, a_try) in enumerate(self.scenes):
            if not style and a_try.atoms == atoms:
                return n
        raise KeyError(atoms)

    def _judge(self, n):
        kind, style, a_try = self.scenes[n]
        outcome = Outcome(kind, style, a_try, ranks=self.ranks)
        answers = {v: self.answers[self._key(n, v)] for v in variants(a_try, self.ranks)}
        errors = {v: answer.error for v, answer in answers.items() if answer.error}
        if a_try.kind in (INTEGRATES, BOX, MOVES, RIGID_ONLY):
            self._refused(outcome, answers)
            return outcome
        errors = self._without_refusals_of_lammps(n, outcome, answers, errors)
        if errors:
            self._broken(n, outcome, errors)
            return outcome
        self._consistent(n, outcome, answers)
        if a_try.kind == PASSIVE:
            plain = self.answers[self._key(self._plain(a_try.atoms), FIRST)]
            wrong = worst(distances(plain, answers[FIRST]), SAME)
            if wrong:
                outcome.faults.append(f"alone: {wrong}")
        if a_try.kind in (PASSIVE, FORCE, TAKEN):
            self._converges(n, outcome)
        elif a_try.kind in (COUNT, CHANCE):
            self._like_rigid(n, outcome)
        outcome.result = {PASSIVE: "same"}.get(a_try.kind, "acts")
        if outcome.faults:
            outcome.result = "DIFFERS"
        return outcome

    def _refused(self, outcome, answers):
        """In every variant the fix, or LAMMPS, has to refuse, or the fix to warn."""
        name = re.compile(rf"\b{re.escape(outcome.style)}\b")

        def said(answer):
            """What the fix, or else LAMMPS, has against the neighbor."""
            if answer.error:
                return answer.error.splitlines()[0]
            lines = [line for line in answer.warnings if REFUSES.search(line) and name.search(line)]
            return next((line for line in lines if "WARNING" in line), "")

        first = answers[FIRST]
        outcome.message = said(first)
        if not all(map(said, answers.values())):
            outcome.result = "DIFFERS"
            outcome.faults.append("neither refused nor warned of")
        elif not REFUSES.search(outcome.message):
            outcome.result = "LAMMPS refuses"
        else:
            outcome.result = "refused" if first.error else "warned"

    def _without_refusals_of_lammps(self, n, outcome, answers, errors):
        """Errors but those that LAMMPS ends the same variant with beside fix rigid, such as a style that does
        not run on several ranks: these variants leave ``answers``.  A crash is never excused."""
        left = {}
        for variant, error in errors.items():
            key = self._key(n, variant, "rigid")
            self._need([key])
            if error.startswith("crash") or self.answers[key].error != error or variant == FIRST:
                left[variant] = error
                continue
            del answers[variant]
            outcome.excused.append(f"{named(variant)}: {error.strip().splitlines()[0]}")
        return left

    def _broken(self, n, outcome, errors):
        variant, error = next(iter(errors.items()))
        outcome.result = "DIFFERS"
        key = self._key(n, variant, "rigid")
        self._need([key])
        same = self.answers[key].error
        outcome.faults.append(
            f"{named(variant)}: {error.strip().splitlines()[0]}"
            + (f" (with fix rigid: {same.splitlines()[0]})" if same else " (fix rigid runs)")
        )

    def _consistent(self, n, outcome, answers):
        for variant, answer in answers.items():
            if variant[1] > 1 and outcome.a_try.kind == CHANCE:
                continue  # each rank draws its own numbers
            ours = distances(answers[FIRST], answer)
            wrong = worst(ours, SAME)
            if not wrong:
                continue
            keys = [self._key(n, v, "rigid") for v in (FIRST, variant)]
            self._need(keys)
            control = distances(*(self.answers[key] for key in keys))
            bad = [name for name, value in ours.items() if not value <= SAME]
            if all(control.get(name, 0.0) >= 0.1 * ours[name] for name in bad):
                outcome.excused.append(f"{named(variant)}: {wrong}")
            else:
                rigid = worst(control, SAME) or "same"
                outcome.faults.append(f"{named(variant)}: {wrong} (with fix rigid: {rigid})")

    def _converges(self, n, outcome):
        """Against fix rigid at small steps."""
        ours, coarse, fine = (
            self.answers[key]
            for key in (
                self._key(n, FIRST, "gear", 4),
                self._key(n, reference(outcome.a_try), "rigid", 4),
                self._key(n, reference(outcome.a_try), "rigid", 8),
            )
        )
        if ours.error or fine.error:
            outcome.faults.append(f"rigid: {(ours.error or fine.error).splitlines()[0]}")
            return
        wrong = beyond(ours, coarse, fine, outcome.a_try)
        if wrong:
            outcome.faults.append(f"rigid: {wrong}")

    def _like_rigid(self, n, outcome):
        """Against fix rigid at the same step: its error at that step is known to be below BROAD."""
        ours = self.answers[self._key(n, FIRST)]
        rigid = self.answers[self._key(n, reference(outcome.a_try), "rigid")]
        wrong = worst(distances(ours, rigid), dict.fromkeys(distances(ours, rigid), BROAD))
        if wrong and outcome.a_try.kind != CHANCE:
            outcome.faults.append(f"rigid at the same step: {wrong}")


# --- all ------------------------------------------------------------------------------------------
def scenes_of(executable, only=None):
    """([(kind, style, Try)], {style: reason}, [unknown styles]) of what `lmp -h` lists."""
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


def counted(outcomes):
    return Counter(outcome.result for outcome in outcomes)
