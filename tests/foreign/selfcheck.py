"""The judge judged: a neighbor that is wrong by 1 % has to be seen."""

from dataclasses import replace

from . import neighbors, scene, styles

#: style -> its arguments, wrong by 1 %
WRONG = {
    "spring/self": "2.02",
    "viscous": "0.303",
    "gravity": "1.01 vector 0 0 -1",
    "rhok": "1 1 1 0.505 0.1",
    "aveforce": "NULL 0.101 NULL",
}


def wrong_by_one_percent(engine, folder):
    """Yields (style, whether it was noticed)."""
    scene.write_files(folder)
    jobs = {}
    for style, wrong in WRONG.items():
        (right,) = styles.FIXES[style]
        off = replace(right, args=wrong)
        jobs[style, "gear"] = neighbors.script("fix", style, off, "gear", divide=4)
        for divide in (4, 8):
            jobs[style, divide] = neighbors.script("fix", style, right, "rigid", "before", divide)
    answers = engine.answers(jobs, folder)
    for style in WRONG:
        coarse, fine = answers[style, 4], answers[style, 8]
        yield style, bool(
            neighbors.beyond(answers[style, "gear"], coarse, fine, styles.FIXES[style][0])
        )
