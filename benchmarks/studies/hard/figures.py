"""Draw the picture of a case from its Finding.  Nothing is computed here."""

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402

from lammps_gearquat.style import COLOUR, STYLE  # noqa: E402


def _panel(axis, panel):
    for curve in panel.curves:
        axis.plot(
            curve.x,
            curve.y,
            linestyle=curve.line,
            marker=curve.marker,
            markersize=3.5,
            color=COLOUR[curve.colour],
            label=curve.label,
        )
    if panel.limit is not None:
        axis.axhline(panel.limit, color="#999999", linestyle="--", linewidth=0.8, label="asked")
    axis.set(xlabel=panel.xlabel, ylabel=panel.ylabel)
    axis.set_title(panel.title, loc="left", fontsize=9)
    if "x" in panel.log:
        axis.set_xscale("log")
    if "y" in panel.log:
        axis.set_yscale("log")
    if panel.ticks:
        axis.set_xticks(range(len(panel.ticks)), panel.ticks)
        axis.margins(x=0.15)
    if any(curve.label for curve in panel.curves) or panel.limit is not None:
        place = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.2), "ncols": 3}
        axis.legend(fontsize=7, **place)


def draw(path, finding):
    """One row of small panels."""
    path.parent.mkdir(parents=True, exist_ok=True)
    panels = finding.panels
    with plt.rc_context(STYLE | {"font.size": 8.5}):
        width = 4.2 * len(panels) + 0.4
        figure, axes = plt.subplots(
            1, len(panels), figsize=(width, 3.4), layout="constrained", squeeze=False
        )
        for axis, panel in zip(axes[0], panels):
            _panel(axis, panel)
        figure.savefig(path)
        plt.close(figure)
