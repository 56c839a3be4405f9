"""Colors and matplotlib settings of all pictures."""

COLOR = {
    "potential": "#0072b2",
    "kinetic": "#d55e00",
    "total": "#222222",
    "translation": "#009e73",
    "rotation": "#cc79a7",
    "momentum": "#0072b2",
    "second": "#009e73",
    "first": "#d55e00",
    "rigid": "#888888",
    "x": "#0072b2",
    "y": "#d55e00",
    "z": "#009e73",
}
STYLE = {
    "figure.dpi": 110,
    "savefig.dpi": 150,
    "font.size": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.alpha": 0.25,
    "lines.linewidth": 0.9,
    "legend.frameon": False,
}
