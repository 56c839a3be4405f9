"""Tests of the judge: it has to detect errors of 1 % and surplus degrees of freedom."""

import copy
import re
from dataclasses import replace

from . import beside, decks, scene, styles, suffixes, thermostat

#: style -> its arguments, wrong by 1 %
WRONG = {
    "spring/self": "2.02",
    "viscous": "0.303",
    "gravity": "1.01 vector 0 0 -1",
    "rhok": "1 1 1 0.505 0.1",
    "aveforce": "NULL 0.101 NULL",
}
#: the epsilon of the molecules, and an epsilon that is wrong by 1 %
EPSILON, WRONG_EPSILON = "* * 0.3 ", "* * 0.303 "


def all_errors(engine, folder):
    """Yields (text of an error, whether it was detected)."""
    scene.write_files(folder)
    yield from wrong_forces(engine, folder)
    yield from wrong_thermostats(engine, folder)
    yield from wrong_variant(engine, folder)


def missing_reasons(text):
    """Names of the refusals whose reasons the text does not have."""
    return [name for _, name, words in decks.REASONS if not re.search(words.replace("STYLE", "heat"), text)]


def wrong_forces(engine, folder):
    """Other styles that are wrong by 1 %, against fix rigid."""
    jobs = {}
    for style, wrong in WRONG.items():
        right = styles.FIXES[style][0]
        off = replace(right, args=wrong)
        jobs[style, "gear"] = beside.script("fix", style, off, "gear", divide=4)
        for divide in (4, 8):
            jobs[style, divide] = beside.script("fix", style, right, "rigid", "before", divide)
    answers = engine.answers(jobs, folder)
    for style in WRONG:
        coarse, fine = answers[style, 4], answers[style, 8]
        wrong = beside.beyond(answers[style, "gear"], coarse, fine, styles.FIXES[style][0])
        yield f"{style} is wrong by 1 %", bool(wrong)


def wrong_thermostats(engine, folder):
    """Degrees of freedom, heat and target of keyword temp."""
    job = beside.script("fix", "", styles.Try(styles.PASSIVE), "temp", alone=True)
    target = f"temp {thermostat.TARGET}"
    warmer = [line.replace(target, f"temp {1.01 * thermostat.TARGET}") for line in job]
    answers = engine.answers({"right": job, "warmer": warmer}, folder)
    right = answers["right"]
    yield "the thermostat is judged wrong without an error", not thermostat.faults(right, True)
    apart = beside.distances(right, answers["warmer"])
    yield "the target is wrong by 1 %", bool(beside.worst(apart, beside.SAME))

    def seen(change):
        wrong = copy.deepcopy(right)
        change(wrong.noted)
        return bool(thermostat.faults(wrong, True))

    def three_more(noted):
        found = 3 * (scene.MOLECULES - 1)
        for moment in thermostat.MOMENTS:
            noted[f"vector-{moment}"][thermostat.OF_TRANSLATION] *= found / (found + 3)

    def heat(noted):
        taken = [noted[f"vector-{moment}"][thermostat.HEAT] for moment in thermostat.MOMENTS]
        noted["energy-atoms"] += 0.01 * (taken[1] - taken[0])

    def momentum(noted):
        noted["atoms"][:, 4] *= 1.01 ** (noted["atoms"][:, 0] == 1)

    yield "the thermostat has three degrees of freedom too many", seen(three_more)
    yield "the heat is wrong by 1 %", seen(heat)
    yield "a velocity is wrong by 1 %, so that the total momentum is not zero", seen(momentum)


def wrong_variant(engine, folder):
    """A variant of a pair style that is wrong by 1 %."""
    right = suffixes.script("lj/cut", False)
    wrong = [line.replace(EPSILON, WRONG_EPSILON) for line in right]
    answers = engine.answers({"right": right, "wrong": wrong}, folder)
    outcome = suffixes.judge(("lj/cut", False), "opt", 1, answers["wrong"], *2 * [answers["right"]])
    yield "a variant of a pair style is wrong by 1 %", bool(outcome.faults)
