"""Orbit, tumbling body and energy, 16 : 9 for a slide.  Nothing is computed here."""

from contextlib import contextmanager

import matplotlib.pyplot as plt
import numpy as np

from benchmarks.engine import floor
from benchmarks.engine.panels import RECONSTRUCTED
from benchmarks.reference import Cage
from gearquat_analysis.style import COLOR, STYLE

from .view import Camera, Stage

SLIDE = (9.6, 5.4)
LOOK = STYLE | {"savefig.dpi": 160, "font.size": 11, "axes.titlesize": 12}
PLUS, MINUS, EDGE = "#d55e00", "#0072b2", "#c4c4c4"
CAGE, SPACING, CAGE_RADIUS = Cage(float), 100.0, 5.0
#: radius and color of each sphere of the body, and which are joined by rods
BODY = ((2.0, "#7d7d7d"), (2.0, "#7d7d7d"), (2.6, "#c9c9c9"), (3.6, "#f0d040"))
RODS = ((2, 0), (2, 1), (2, 3))
NOTE = f"orange: charge +1, blue: charge −1; {RECONSTRUCTED}"
AXES = ("#0072b2", "#009e73", "#cc79a7")


def add_cage(stage, width=1.1):
    """The 26 fixed spheres, joined along the edges of the cage."""
    for sign, color in ((1, PLUS), (-1, MINUS)):
        stage.spheres(CAGE.positions[CAGE.charges == sign], CAGE_RADIUS, color)
    for k, one in enumerate(CAGE.positions):
        for other in CAGE.positions[:k]:
            if np.linalg.norm(one - other) < 1.01 * SPACING:
                stage.rod(one, other, EDGE, width, (CAGE_RADIUS, CAGE_RADIUS))


def add_body(stage, sites, width=3.0):
    """The body, its sites (4, 3)."""
    for a, b in RODS:
        stage.rod(sites[a], sites[b], "#555555", width, (BODY[a][0], BODY[b][0]))
    for site, (radius, color) in zip(sites, BODY):
        stage.spheres(site, radius, color)


def _shades(pieces):
    """Colors of a path in so many pieces, from its begin to its end."""
    return plt.get_cmap("viridis")(np.linspace(0, 1, pieces))[:, :3]


@contextmanager
def _slide(path, title, note, side="right"):
    """A figure that is finished and saved at the end of the context."""
    with plt.rc_context(LOOK):
        figure = plt.figure(figsize=SLIDE, layout="constrained")
        yield figure
        figure.suptitle(title, x=0.02, ha="left", fontsize=15, fontweight="bold")
        x = 0.98 if side == "right" else 0.02
        figure.text(x, 0.015, note, ha=side, fontsize=8, color="#666666")
        figure.savefig(path)
        plt.close(figure)


def _time_bar(figure, axis, end):
    shades = plt.cm.ScalarMappable(plt.Normalize(0.0, end), "viridis")
    place = {"orientation": "horizontal", "fraction": 0.04, "pad": 0.02, "aspect": 40}
    bar = figure.colorbar(shades, ax=axis, **place)
    bar.set_label("time")
    bar.outline.set_visible(False)


def draw_orbit(path, scene, pieces=160):
    """The whole cage left; right the path about the sphere that holds the body."""
    with _slide(path, "Test case 1: the body cannot leave", NOTE, "left") as figure:
        left, right = figure.subplots(1, 2, width_ratios=(1, 1.25))
        whole = Stage(Camera((0.0, 0.0, 0.0), -58.0, 17.0, 620.0), haze=(20.0, 240.0))
        add_cage(whole)
        whole.lines(scene.center, _shades(pieces), 1.4, pieces)
        add_body(whole, scene.sites[-1], 1.5)
        whole.draw(left, 160.0, 178.0)
        middle = 0.5 * (scene.center.min(axis=0) + scene.center.max(axis=0))
        near = Stage(Camera(tuple(middle), -62.0, 22.0, 150.0), haze=(10.0, 60.0))
        near.lines(scene.center, _shades(pieces), 1.6, pieces)
        near.spheres([[SPACING, 0.0, 0.0]], CAGE_RADIUS, PLUS)
        add_body(near, scene.sites[-1], 4.5)
        near.draw(right, 17.5, 16.0)
        left.set_title("in its cage", loc="left")
        right.set_title("near the sphere that holds it", loc="left")
        _time_bar(figure, right, scene.time[-1])


def _snapshots(axis, scene, rows):
    """The body at some samples, side by side."""
    gap, reach = 26.0, 13.0
    for place, k in enumerate(rows):
        stage = Stage(Camera((0.0, 0.0, 0.0), -60.0, 18.0, 200.0))
        add_body(stage, scene.sites[k] - scene.center[k], 5.0)
        inset = axis.inset_axes([place / len(rows), 0.1, 1.0 / len(rows), 0.9])
        stage.draw(inset, gap / 2, reach)
        label = f"t = {scene.time[k]:g}"
        axis.text((place + 0.5) / len(rows), 0.0, label, ha="center", transform=axis.transAxes)
    axis.set_axis_off()


def _trace(axis, scene, until):
    """The direction of the long axis of the body, on a sphere."""
    stage = Stage(Camera((0.0, 0.0, 0.0), -60.0, 18.0, 12.0))
    angle = np.linspace(0.0, 2 * np.pi, 121)
    circle = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    for turn in ((0, 1, 2), (0, 2, 1), (2, 0, 1)):
        stage.lines(circle[:, turn], "#d8d8d8", 1.0, 40)
    tip, pieces = scene.axes[:until, 2], min(150, until - 1)
    stage.lines(tip, _shades(pieces), 2.0, pieces)
    stage.spheres(tip[-1:], 0.06, BODY[3][1])
    stage.draw(axis, 1.15, 1.15)
    title = f"direction of its long axis, t = 0 to {scene.time[until - 1]:g}"
    axis.set_title(title, loc="left", fontsize=10)


def draw_tumbling(path, scene, until=200.0):
    """The body at equal distances of time, its angular velocity, and the path of its long axis."""
    last = int(np.searchsorted(scene.time, until, side="right"))
    rows = np.linspace(0, int(np.searchsorted(scene.time, until / 2.5)), 8).astype(int)
    with _slide(path, "Test case 1: the body tumbles", RECONSTRUCTED) as figure:
        grid = figure.add_gridspec(2, 2, height_ratios=(1, 1.7), width_ratios=(1.7, 1))
        _snapshots(figure.add_subplot(grid[0, :]), scene, rows)
        axis = figure.add_subplot(grid[1, 0])
        for k, color in enumerate(AXES):
            omega = scene.omega_body[:last, k]
            axis.plot(scene.time[:last], omega, color=color, lw=1.6, label=f"axis {k + 1}")
        axis.set_xlabel("time")
        axis.set_title("angular velocity along its principal axes", loc="left", fontsize=10)
        axis.legend(ncols=3, loc="upper right", fontsize=9)
        axis.margins(x=0.0, y=0.2)
        _trace(figure.add_subplot(grid[1, 1]), scene, last)


def draw_energy(path, scene, until=500.0):
    """Energies of a run, and below how far the total is from its start."""
    shown = slice(0, int(np.searchsorted(scene.time, until, side="right")))
    time = scene.time[shown]
    with _slide(path, "Test case 1: energy", RECONSTRUCTED) as figure:
        axes = figure.subplots(2, 1, sharex=True, height_ratios=(2.2, 1))
        for kind, values in scene.energies.items():
            width = 2.2 if kind == "total" else 1.4
            axes[0].plot(time, values[shown], color=COLOR[kind], lw=width, label=kind)
        axes[0].set_ylabel("energy")
        axes[0].legend(ncols=4, loc="lower right", bbox_to_anchor=(1.0, 1.0))
        error = floor(scene.energies["total"] - scene.energies["total"][0])[shown]
        axes[1].semilogy(time[1:], error[1:], color=COLOR["total"], lw=0.8)
        axes[1].set_ylabel("error of the total")
        axes[1].set_xlabel("time")
        axes[1].margins(x=0.0)
