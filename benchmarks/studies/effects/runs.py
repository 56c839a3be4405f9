"""All that ``benchmarks/run effects`` measures: instructions, times, and the paper's cage."""

import re
from dataclasses import dataclass, field
from pathlib import Path

from benchmarks.studies.bench.runs import breakdowns
from benchmarks.engine.decks import examples_folder
from benchmarks.engine.lammps_runner import Job, LammpsError, find_lmp, run
from . import count, plan
from .scenes import write_molecules


@dataclass(frozen=True)
class Sizes:
    """How much is run: bodies along an edge and steps, for counts, for times, and of the cage."""

    counted: tuple = (3, 4)
    counted_steps: int = 10
    timed: int = 8
    timed_steps: int = 300
    rounds: int = 5
    cage_steps: int = 100_000


QUICK = Sizes(timed=4, timed_steps=20, rounds=1, cage_steps=2000)


@dataclass(frozen=True)
class Cage:
    """The paper's cage: seconds a step (rounds,) and pairs in the list, without and with exclusions."""

    plain: list
    mended: list
    pairs: int
    left: int

    @property
    def speedup(self):
        """Of the least times."""
        return min(self.plain) / min(self.mended)


@dataclass
class Results:
    """``profiles``: (scene, side) -> count.Profile; ``seconds``: scene -> seconds a step in the fix and
    in the pair style, [(fix, forces), ...] by round; ``cage``: Cage.
    """

    sizes: Sizes
    profiles: dict = field(default_factory=dict)
    seconds: dict = field(default_factory=dict)
    cage: Cage = None

    def per_body(self, scene, of):
        """Instructions a body and step: what more bodies add, so nothing that is done once a step.

        ``of``: a function of a Profile.
        """
        low, high = self.sizes.counted
        more = of(self.profiles[scene, high]) - of(self.profiles[scene, low])
        return more / (high**3 - low**3) / self.sizes.counted_steps

    def fix(self, scene):
        """Instructions a body and step in the fix."""
        return self.per_body(scene, lambda profile: profile.fix)

    def forces(self, scene):
        """Instructions of a body of the larger scene and step in the pair style."""
        high = self.sizes.counted[1]
        return self.profiles[scene, high].forces / high**3 / self.sizes.counted_steps

    def idle(self, effect):
        """Instructions a body and step of an effect's own functions where it is not called for."""
        return self.per_body(effect.idle, lambda profile: profile.of(effect.own))

    def nanoseconds(self, scene, part=0):
        """Time a body and step in the fix, or in the pair style (part 1): the least of all rounds.

        What else a machine does only adds to a time; differences of least times are left free of it.
        """
        return 1e9 / self.sizes.timed**3 * min(pair[part] for pair in self.seconds[scene])


def time_scenes(folder, sizes, lmp, progress):
    """Scene -> [(seconds a step in the fix, in the pair style), ...], all scenes in turn."""
    write_molecules(folder)
    found = {scene: [] for scene in plan.scenes()}
    for number in range(sizes.rounds):
        for k, scene in enumerate(found):
            deck = folder / f"in.time{k + 1}"
            deck.write_text(scene.deck(sizes.timed, sizes.timed_steps), encoding="utf-8")
            log = folder.parent / "logs" / f"log.time{k + 1}.{number + 1}"
            run(Job(deck, log), lmp)
            timed = breakdowns(log.read_text(encoding="utf-8"))[-1]
            found[scene].append(tuple(timed[of] / sizes.timed_steps for of in ("Modify", "Pair")))
            progress(1)
    return found


_PAIRS = re.compile(r"^Total # of neighbors = (\d+)", re.MULTILINE)
_PROPOSED = re.compile(r"^    (neigh_modify .*)$", re.MULTILINE)
EXCLUSIONS = " exclude group cage cage exclude molecule/intra body"


def time_cage(folder, sizes, lmp, progress):
    """Test case 1 without exclusions, and with the lines that the report proposes for it."""
    folder.mkdir(parents=True, exist_ok=True)
    case = examples_folder() / "case1"
    scene = (examples_folder() / "common" / "in.scene").read_text(encoding="utf-8")
    if EXCLUSIONS not in scene:
        raise LammpsError(
            f"in.scene does not exclude the pairs that are to be counted ({EXCLUSIONS})"
        )
    plain = scene.replace(EXCLUSIONS, "\n${exclusions}").replace(
        "include ../common/in.motion", f"include {examples_folder() / 'common' / 'in.motion'}"
    )
    (folder / "in.scene").write_text(plain, encoding="utf-8")
    deck = folder / "in.cage"
    text = (case / "in.case1").read_text(encoding="utf-8")
    deck.write_text(text.replace("../common/in.scene", "in.scene"), encoding="utf-8")

    seconds, pairs, proposed = {"plain": [], "mended": []}, {}, "print ''"
    for number in range(sizes.rounds):
        for kind, times in seconds.items():
            log = folder.parent / "logs" / f"log.cage.{kind}.{number + 1}"
            steps = sizes.cage_steps
            variables = {"data": case / "data", "steps": steps, "every": steps}
            variables["exclusions"] = proposed if kind == "mended" else "print ''"
            run(Job(deck, log, variables), lmp)
            said = log.read_text(encoding="utf-8")
            times.append(breakdowns(said)[-1]["Loop"] / steps)
            pairs[kind] = int(_PAIRS.search(said)[1])
            if kind == "plain":
                words = [line.removeprefix("neigh_modify ") for line in _PROPOSED.findall(said)]
                if not words:
                    raise LammpsError(f"{log.name}: the report proposes no exclusions")
                proposed = "neigh_modify " + " ".join(words)
            progress(1)
    return Cage(seconds["plain"], seconds["mended"], pairs["plain"], pairs["mended"])


def work(sizes):
    """Number of runs, as ``progress`` gets them."""
    return 1 + sizes.rounds * (len(plan.scenes()) + 2)


def measure(folder, sizes=Sizes(), lmp=None, progress=lambda runs: None):
    """Results.  ``folder`` gets decks, profiles and ``logs``."""
    folder, lmp = Path(folder), find_lmp(lmp)
    count.find_valgrind()
    (folder / "logs").mkdir(parents=True, exist_ok=True)
    results = Results(sizes)
    steps = sizes.counted_steps
    results.profiles = count.count(folder / "count", plan.scenes(), sizes.counted, steps, lmp)
    progress(1)
    (folder / "time").mkdir(exist_ok=True)
    results.seconds = time_scenes(folder / "time", sizes, lmp, progress)
    results.cage = time_cage(folder / "cage", sizes, lmp, progress)
    return results
