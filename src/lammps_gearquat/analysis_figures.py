"""The pictures of ``gearquat analyze``.  Nothing is computed here."""

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402

from .style import COLOUR, STYLE  # noqa: E402

LABELS = {"ke_translation": "translation", "ke_rotation": "rotation", "potential": "potential"}
AXES = ("#0072b2", "#d55e00", "#009e73")


def draw_totals(path, poses, totals):
    """Energies of all bodies, and how far they are from rigid, against time."""
    time = poses.results.time
    energies = [name for name in LABELS if name in totals]
    residuals = [name for name in totals if name.endswith("residual") and totals[name].any()]
    panels = [names for names in (energies, residuals) if names]
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(
            len(panels),
            1,
            figsize=(8, 2.6 * len(panels)),
            sharex=True,
            squeeze=False,
            layout="constrained",
        )
        for axis, names in zip(axes[:, 0], panels):
            for name in names:
                label = LABELS.get(name, "velocities" if "velocity" in name else "sites")
                axis.plot(time, totals[name], color=COLOUR.get(label), label=label)
            if names is residuals:
                axis.set_yscale("log")
                axis.set_ylabel("away from rigid, at most")
            else:
                axis.set_ylabel("energy" + (f" (units {poses.units})" if poses.units else ""))
            axis.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3)
        axes[-1, 0].set_xlabel("time")
        figure.savefig(path)
        plt.close(figure)


def draw_correlations(path, found):
    """Mean squares, autocorrelations of velocities and of axes, against the lag."""
    lag = found["lag"]
    # of later lags there are too few origins to look at
    kept = slice(1, max(2, 2 * len(lag) // 3))
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(1, 3, figsize=(12, 3.8), layout="constrained")
        for name, label in (("displacement", "length²"), ("rotation", "rad²")):
            values = found.get(f"mean_square_{name}")
            if values is not None:
                colour = COLOUR["translation" if name == "displacement" else "rotation"]
                axes[0].loglog(lag[kept], values[kept], color=colour, label=f"{name} ({label})")
        axes[0].set_title("mean square", fontsize=10, loc="left")
        for name, kind in (("velocity", "translation"), ("omega_space", "rotation")):
            values = found.get(f"{name}_autocorrelation")
            if values is not None and values[0] > 0:
                label = "angular velocity" if kind == "rotation" else "velocity"
                shown = slice(0, kept.stop)
                axes[1].plot(lag[shown], values[shown] / values[0], color=COLOUR[kind], label=label)
        axes[1].set_title("autocorrelation", fontsize=10, loc="left")
        for name, values in found.items():
            if name.startswith("axis"):
                order = name[-1]
                look = {"color": AXES[int(name[4]) - 1], "linestyle": "-" if order == "1" else "--"}
                axes[2].plot(
                    lag[: kept.stop], values[: kept.stop], label=f"axis {name[4]}, P{order}", **look
                )
        axes[2].set_title("orientation", fontsize=10, loc="left")
        for axis in axes:
            axis.set_xlabel("lag")
            if axis.get_legend_handles_labels()[0]:
                axis.legend(fontsize=8)
        figure.savefig(path)
        plt.close(figure)
