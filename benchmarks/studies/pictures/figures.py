"""Orbit, tumbling body and energy, 16 : 9 for a slide.  Nothing is computed here."""

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

from benchmarks.studies.cases.claims import CAGE, CAGE_CHARGES, CAGE_SPACING  # noqa: E402
from lammps_gearquat.style import COLOUR, RECONSTRUCTED, STYLE  # noqa: E402
from .view import Camera, Stage  # noqa: E402

SLIDE = (9.6, 5.4)
LOOK = STYLE | {"savefig.dpi": 160, "font.size": 11, "axes.titlesize": 12}
PLUS, MINUS, EDGE, INK = "#d55e00", "#0072b2", "#c4c4c4", "#222222"
#: radius and colour of each sphere of the body, and which are joined by rods
BODY = ((2.0, "#7d7d7d"), (2.0, "#7d7d7d"), (2.6, "#c9c9c9"), (3.6, "#f0d040"))
RODS = ((2, 0), (2, 1), (2, 3))
CAGE_RADIUS = 5.0
NOTE = f"orange: charge +1, blue: charge −1; {RECONSTRUCTED}"
AXES = ("#0072b2", "#009e73", "#cc79a7")


def add_cage(stage, width=1.1):
    """The 26 fixed spheres, joined along the edges of the cage."""
    for sign, colour in ((1, PLUS), (-1, MINUS)):
        stage.spheres(CAGE[CAGE_CHARGES == sign], CAGE_RADIUS, colour)
    for k, one in enumerate(CAGE):
        for other in CAGE[:k]:
            if np.linalg.norm(one - other) < 1.01 * CAGE_SPACING:
                stage.rod(one, other, EDGE, width, (CAGE_RADIUS, CAGE_RADIUS))


def add_body(stage, sites, width=3.0):
    """The body, its sites (4, 3)."""
    for a, b in RODS:
        stage.rod(sites[a], sites[b], "#555555", width, (BODY[a][0], BODY[b][0]))
    for site, (radius, colour) in zip(sites, BODY):
        stage.spheres(site, radius, colour)


def _title(figure, title, note, side="right"):
    figure.suptitle(title, x=0.02, ha="left", fontsize=15, fontweight="bold")
    figure.text(
        0.98 if side == "right" else 0.02, 0.015, note, ha=side, fontsize=8, color="#666666"
    )


def _time_bar(figure, axis, end):
    shades = plt.cm.ScalarMappable(plt.Normalize(0.0, end), "viridis")
    bar = figure.colorbar(
        shades, ax=axis, orientation="horizontal", fraction=0.04, pad=0.02, aspect=40
    )
    bar.set_label("time")
    bar.outline.set_visible(False)


def draw_orbit(path, scene):
    """The whole cage left; right the path about the sphere that holds the body."""
    pieces = 160
    shades = [
        matplotlib.colors.to_hex(c) for c in plt.get_cmap("viridis")(np.linspace(0, 1, pieces))
    ]
    with plt.rc_context(LOOK):
        figure, axes = plt.subplots(
            1, 2, figsize=SLIDE, width_ratios=(1, 1.25), layout="constrained"
        )
        whole = Stage(Camera((0.0, 0.0, 0.0), -58.0, 17.0, 620.0), haze=(20.0, 240.0))
        add_cage(whole)
        whole.lines(scene.centre, shades, 1.4, pieces)
        add_body(whole, scene.sites[-1], 1.5)
        whole.draw(axes[0], 160.0, 178.0)
        middle = 0.5 * (scene.centre.min(axis=0) + scene.centre.max(axis=0))
        near = Stage(Camera(tuple(middle), -62.0, 22.0, 150.0), haze=(10.0, 60.0))
        near.lines(scene.centre, shades, 1.6, pieces)
        near.spheres([[CAGE_SPACING, 0.0, 0.0]], CAGE_RADIUS, PLUS)
        add_body(near, scene.sites[-1], 4.5)
        near.draw(axes[1], 17.5, 16.0)
        axes[0].set_title("in its cage", loc="left")
        axes[1].set_title("near the sphere that holds it", loc="left")
        _time_bar(figure, axes[1], scene.time[-1])
        _title(figure, "Test case 1: the body cannot leave", NOTE, "left")
        figure.savefig(path)
        plt.close(figure)


def _snapshots(axis, scene, rows):
    """The body at some samples, side by side."""
    gap, reach = 26.0, 13.0
    for place, k in enumerate(rows):
        stage = Stage(Camera((0.0, 0.0, 0.0), -60.0, 18.0, 200.0))
        add_body(stage, scene.sites[k] - scene.centre[k], 5.0)
        inset = axis.inset_axes([place / len(rows), 0.1, 1.0 / len(rows), 0.9])
        stage.draw(inset, gap / 2, reach)
        label = f"t = {scene.time[k]:g}"
        axis.text((place + 0.5) / len(rows), 0.0, label, ha="center", transform=axis.transAxes)
    axis.set_axis_off()


def _trace(axis, scene, until):
    """Where the long axis of the body points, on a sphere."""
    camera = Camera((0.0, 0.0, 0.0), -60.0, 18.0, 12.0)
    stage = Stage(camera)
    angle = np.linspace(0.0, 2 * np.pi, 121)
    circle = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    for turn in ((0, 1, 2), (0, 2, 1), (2, 0, 1)):
        stage.lines(circle[:, turn], "#d8d8d8", 1.0, 40)
    tip = scene.axes[:until, 2]
    pieces = min(150, until - 1)
    shades = plt.get_cmap("viridis")(np.linspace(0, 1, pieces))
    stage.lines(tip, [matplotlib.colors.to_hex(c) for c in shades], 2.0, pieces)
    stage.spheres(tip[-1:], 0.06, BODY[3][1])
    stage.draw(axis, 1.15, 1.15)
    axis.set_title(
        f"where its long axis points, t = 0 to {scene.time[until - 1]:g}", loc="left", fontsize=10
    )


def draw_tumbling(path, scene, until=200.0):
    """The body at equal distances of time, its angular velocity, and the path of its long axis."""
    last = int(np.searchsorted(scene.time, until, side="right"))
    rows = np.linspace(0, int(np.searchsorted(scene.time, until / 2.5)), 8).astype(int)
    with plt.rc_context(LOOK):
        figure = plt.figure(figsize=SLIDE, layout="constrained")
        grid = figure.add_gridspec(2, 2, height_ratios=(1, 1.7), width_ratios=(1.7, 1))
        _snapshots(figure.add_subplot(grid[0, :]), scene, rows)
        axis = figure.add_subplot(grid[1, 0])
        for k, colour in enumerate(AXES):
            label = f"axis {k + 1}"
            axis.plot(
                scene.time[:last], scene.omega_body[:last, k], color=colour, lw=1.6, label=label
            )
        axis.set_xlabel("time")
        axis.set_title("angular velocity along its principal axes", loc="left", fontsize=10)
        axis.legend(ncols=3, loc="upper right", fontsize=9)
        axis.margins(x=0.0, y=0.2)
        _trace(figure.add_subplot(grid[1, 1]), scene, last)
        _title(figure, "Test case 1: the body tumbles", RECONSTRUCTED)
        figure.savefig(path)
        plt.close(figure)


def draw_energy(path, scene, until=500.0):
    """Energies of a run, and below how far the total is from its start."""
    shown = slice(0, int(np.searchsorted(scene.time, until, side="right")))
    kinds = ("potential", "translation", "rotation", "total")
    with plt.rc_context(LOOK):
        figure, axes = plt.subplots(
            2, 1, figsize=SLIDE, sharex=True, height_ratios=(2.2, 1), layout="constrained"
        )
        for kind in kinds:
            width = 2.2 if kind == "total" else 1.4
            axes[0].plot(
                scene.time[shown],
                getattr(scene, kind)[shown],
                color=COLOUR[kind],
                lw=width,
                label=kind,
            )
        axes[0].set_ylabel("energy")
        axes[0].legend(ncols=4, loc="lower right", bbox_to_anchor=(1.0, 1.0))
        error = np.abs(scene.total - scene.total[0])[shown][1:]
        axes[1].semilogy(
            scene.time[shown][1:], np.maximum(error, 1e-16), color=COLOUR["total"], lw=0.8
        )
        axes[1].set_ylabel("|error of the total|")
        axes[1].set_xlabel("time")
        axes[1].margins(x=0.0)
        _title(figure, f"Test case {scene.case}: energy", RECONSTRUCTED)
        figure.savefig(path)
        plt.close(figure)
