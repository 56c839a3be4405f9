"""Theta = 0 and pi, at the start and passing through: a trajectory knows no preferred frame."""

import numpy as np

from .case import FORMULATIONS, Case, Curve, Finding, Panel, at_most, floor

ASKED = 1e-12
POSES = {"upright": "theta = 0", "inverted": "theta = pi", "passing": "passing through both"}
FRAMES = ("straight", "turned")
#: the rotation of make_poles.py: a quaternion, scalar first
TURN = (4, 1, 2, 3)


def rotation(turn=TURN):
    """Matrix (3, 3) of a quaternion of any length, scalar first."""
    w, v = turn[0], np.array(turn[1:], dtype=float)
    cross = np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
    return ((w * w - v @ v) * np.eye(3) + 2 * np.outer(v, v) + 2 * w * cross) / (w * w + v @ v)


def difference(straight, turned, matrix):
    """Largest distance of a site from that of the turned scene, turned back; by frame, (F,).

    ``straight`` and ``turned``: site positions (F, n, 3).
    """
    return np.linalg.norm(turned @ matrix - straight, axis=2).max(axis=1)


def theta(quaternion):
    """Angle between the third axes of body and space; columns of q, scalar first, each (n,)."""
    _, x, y, _ = quaternion
    return 2 * np.arcsin(np.minimum(np.hypot(x, y), 1.0))


def judge(results):
    """Rows; ``results``: (pose, formulation) -> (time, theta, difference), each (F,)."""
    rows = []
    for pose, words in POSES.items():
        if (pose, FORMULATIONS[0]) not in results:
            continue
        worst = max(results[pose, formulation][2].max() for formulation in FORMULATIONS)
        what = f"{words}: sites against those of the turned scene, both formulations"
        rows.append(at_most(what, ASKED, worst))
    return tuple(rows)


def panels(results):
    """Theta over time, and differences over time."""
    angles, off = [], []
    for (pose, formulation), (time, angle, distance) in results.items():
        colour = dict(zip(POSES, "xyz"))[pose]
        if formulation == "second":
            angles.append(Curve(POSES[pose], time, angle / np.pi, colour))
        line = "-" if formulation == "second" else ":"
        off.append(Curve(f"{pose}, {formulation}", time, floor(distance), colour, line))
    return (
        Panel("Euler angle", "time", "theta / pi", tuple(angles), log=""),
        Panel("against the turned scene", "time", "distance of a site", tuple(off), ASKED),
    )


def measure(runs, poses=tuple(POSES), **options):
    """(pose, formulation) -> (time, theta, difference); ``options``: variables of the deck."""
    keys = [(p, f, frame) for p in poses for f in FORMULATIONS for frame in FRAMES]
    columns = " ".join(f"f_move[1][{column}]" for column in (16, 17, 18, 19))
    variables = {
        "-".join(key): {"pose": key[0], "formulation": key[1], "frame": key[2], "more": columns}
        | {"steps": 4000, "every": 20, "dump": 20, "compensate": "yes"}
        | options
        for key in keys
    }
    found = runs.many("poles", variables)
    results = {}
    for pose in poses:
        for formulation in FORMULATIONS:
            straight, turned = (found[f"{pose}-{formulation}-{frame}"] for frame in FRAMES)
            positions = [run.sites.positions for run in (straight, turned)]
            thermo = straight.thermo
            angle = theta([thermo[name] for name in columns.split()])
            off = difference(*positions, rotation())
            results[pose, formulation] = (thermo["Time"], angle, off)
    return results


def run(runs):
    """Finding of the case."""
    results = measure(runs)
    text = (
        "Six sites with charges among six fixed ones, t = 20 at a step of 0.005, both formulations "
        "with compensated sums; the same scene, turned as a whole about a general axis, is turned "
        "back and compared site by site."
    )
    return Finding(judge(results), panels(results), text)


CASE = Case(
    "poles",
    "Theta = 0 and pi, and passing through",
    "Euler angles are singular there; quaternions are not, and no frame is preferred as long as they "
    "are kept at unit length.",
    8.0,
    run,
)
