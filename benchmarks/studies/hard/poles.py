"""Theta = 0 and pi, at the start and passing through: a trajectory knows no preferred frame."""

import numpy as np

from benchmarks.engine import FORMULATIONS, Curve, Finding, Measurement, Panel, deck, floor

TITLE, SECONDS = "Theta = 0 and pi, and passing through", 8.0
MOST = 1e-12
POSES = {"upright": "theta = 0", "inverted": "theta = pi", "passing": "passing through both"}
FRAMES = ("straight", "turned")
#: the rotation of examples/common/data_files.py: a quaternion, scalar first
TURN = (4, 1, 2, 3)
COLUMNS = " ".join(f"f_move[1][{column}]" for column in (16, 17, 18, 19))


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


def measure(lab, poses=tuple(POSES), **options):
    """(pose, formulation) -> (time, theta, difference), each (F,); ``options``: variables of the deck."""
    axes = {"pose": poses, "formulation": FORMULATIONS, "frame": FRAMES}
    settings = {"steps": 4000, "every": 20, "dump": 20, "compensate": "yes", "more": COLUMNS}
    runs = lab.sweep("poles", deck("hard/poles"), axes, lambda run: run, settings | options)
    results = {}
    for pose, formulation, _ in list(runs)[::2]:
        straight, turned = (runs[pose, formulation, frame] for frame in FRAMES)
        angle = theta([straight.thermo[name] for name in COLUMNS.split()])
        off = difference(straight.sites.positions, turned.sites.positions, rotation())
        results[pose, formulation] = (straight.thermo["Time"], angle, off)
    return results


def find(results):
    """Finding of what ``measure`` returns."""
    measurements, angles, off = [], [], []
    for pose in dict.fromkeys(pose for pose, _ in results):
        worst = max(results[pose, formulation][2].max() for formulation in FORMULATIONS)
        what = f"{POSES[pose]}: largest distance of a site from the turned scene"
        measurements.append(Measurement(what, worst, most=MOST))
    for (pose, formulation), (time, angle, distance) in results.items():
        color = dict(zip(POSES, "xyz"))[pose]
        if formulation == "second":
            angles.append(Curve(POSES[pose], time, angle / np.pi, color))
        line = "-" if formulation == "second" else ":"
        off.append(Curve(f"{pose}, {formulation}", time, floor(distance), color, line))
    panels = (
        Panel("Euler angle", "time", "theta / pi", tuple(angles), log=""),
        Panel("against the turned scene", "time", "distance of a site", tuple(off)),
    )
    return Finding(measurements, pictures={"poles": panels})
