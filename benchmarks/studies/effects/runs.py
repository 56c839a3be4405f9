"""All measurements of the study: instructions, times, and the paper's cage."""

import re
from dataclasses import dataclass

from benchmarks.engine import EXAMPLES, ROOT, Job, LammpsError, deck

from . import count, plan
from .scenes import write_molecules


@dataclass(frozen=True)
class Sizes:
    """Sizes of the runs: bodies along an edge and steps, for counts, for times, and for the cage."""

    counted: tuple = (3, 4)
    counted_steps: int = 60
    timed: int = 8
    timed_steps: int = 300
    rounds: int = 5
    cage_steps: int = 100_000


QUICK = Sizes(timed=4, timed_steps=20, rounds=1, cage_steps=2000)


@dataclass(frozen=True)
class Cage:
    """The paper's cage: seconds per step (rounds,) and pairs in the list, without and with exclusions."""

    plain: list
    mended: list
    pairs: int
    left: int

    @property
    def speedup(self):
        """Ratio of the shortest times."""
        return min(self.plain) / min(self.mended)


@dataclass(frozen=True)
class Results:
    """``profiles``: (scene, side) -> count.Profile; ``seconds``: scene -> seconds per step in the fix and
    in the pair style, [(fix, forces), ...] by round; ``cage``: Cage.
    """

    sizes: Sizes
    profiles: dict
    seconds: dict
    cage: Cage

    def per_body(self, scene, of):
        """Instructions per body and step, from the difference of two numbers of bodies, without work done once per step.

        ``of``: a function of a Profile.
        """
        low, high = self.sizes.counted
        more = of(self.profiles[scene, high]) - of(self.profiles[scene, low])
        return more / (high**3 - low**3) / self.sizes.counted_steps

    def fix(self, scene, base=None):
        """Instructions per body and step in the fix, or their difference from ``base``."""
        more = self.per_body(scene, lambda profile: profile.fix - profile.of(plan.ONCE_A_STEP))
        return more - (self.fix(base) if base else 0)

    def forces(self, scene):
        """Instructions per body of the larger scene and step in the pair style."""
        high = self.sizes.counted[1]
        return self.profiles[scene, high].forces / high**3 / self.sizes.counted_steps

    def idle(self, effect):
        """Instructions per body and step of an effect's own functions if it is off."""
        return self.per_body(effect.idle, lambda profile: profile.of(effect.own))

    def nanoseconds(self, scene, base=None, part=0):
        """Time per body and step in the fix, or in the pair style (part 1): the shortest of all rounds.

        The shortest is taken because other work on the machine only adds time.  With ``base``: the difference from it.
        """
        least = 1e9 / self.sizes.timed**3 * min(pair[part] for pair in self.seconds[scene])
        return least - (self.nanoseconds(base, part=part) if base else 0.0)


def time_scenes(lab, sizes):
    """Scene -> [(seconds per step in the fix, in the pair style), ...]; scenes take turns."""
    folder, scenes, jobs = lab.out / "time", {}, {}
    folder.mkdir(parents=True, exist_ok=True)
    write_molecules(folder)
    for number, scene in enumerate(plan.scenes(), 1):
        path = folder / f"in.time{number}"
        path.write_text(scene.deck(sizes.timed, sizes.timed_steps), encoding="utf-8")
        scenes[f"time{number}"], jobs[f"time{number}"] = scene, Job(path, {})
    runs = lab.in_turn(jobs, sizes.rounds)

    def per_step(run):
        return tuple(run.log.timers[-1][part] / sizes.timed_steps for part in ("Modify", "Pair"))

    return {scenes[name]: [per_step(run) for run in of_scene] for name, of_scene in runs.items()}


_PAIRS = re.compile(r"^Total # of neighbors = (\d+)", re.MULTILINE)
_PROPOSED = re.compile(r"^    neigh_modify (.*)$", re.MULTILINE)
_EXCLUSIONS = " exclude group cage cage exclude molecule/intra body"


def cage_deck(folder):
    """Test case 1 with the variable ``exclusions`` instead of the scene's exclusions."""
    common = EXAMPLES / "common"
    scene = (common / "in.scene").read_text(encoding="utf-8")
    if _EXCLUSIONS not in scene:
        raise LammpsError(f"in.scene does not exclude the pairs that are counted ({_EXCLUSIONS})")
    scene = scene.replace(_EXCLUSIONS, "\n${exclusions}")
    scene = scene.replace("include ../common/in.motion", f"include {common / 'in.motion'}")
    text = deck("case1").read_text(encoding="utf-8").replace("../common/in.scene", "in.scene")
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "in.scene").write_text(scene, encoding="utf-8")
    (folder / "in.cage").write_text(text, encoding="utf-8")
    return folder / "in.cage"


def time_cage(lab, sizes):
    """Cage: test case 1 without exclusions, and with the lines that the report proposes for it."""
    path, steps = cage_deck(lab.out / "cage"), sizes.cage_steps
    settings = {"data": EXAMPLES / "case1" / "data", "steps": steps, "every": steps}
    plain = Job(path, settings | {"exclusions": "print ''"})
    said = lab.many({"cage.report": plain})["cage.report"].log.text
    proposed = " ".join(_PROPOSED.findall(said))
    if not proposed:
        raise LammpsError("log.cage.report: the report proposes no exclusions")
    mended = Job(path, settings | {"exclusions": f"neigh_modify {proposed}"})
    runs = lab.in_turn({"cage.plain": plain, "cage.mended": mended}, sizes.rounds)
    seconds = [[run.log.seconds / steps for run in of_kind] for of_kind in runs.values()]
    pairs = [int(_PAIRS.search(of_kind[0].log.text)[1]) for of_kind in runs.values()]
    return Cage(*seconds, *pairs)


def measure(lab):
    """Results.  LAMMPS built in the tree is preferred, because counting needs the names of functions."""
    lab.prefer(ROOT / "build" / "tree" / "lmp")
    sizes = QUICK if lab.quick else Sizes()
    steps, scenes = sizes.counted_steps, plan.scenes()
    profiles = count.count(lab.out / "count", scenes, sizes.counted, steps, lab.lmp)
    lab.advance(0.2)
    with lab.share(0.7):
        seconds = time_scenes(lab, sizes)
    with lab.share(0.1):
        return Results(sizes, profiles, seconds, time_cage(lab, sizes))
