"""Analysis of rigid bodies with MDAnalysis: poses, motion, correlations.

``dump`` reads LAMMPS dumps as universes.  ``poses`` has the analysis Poses, and ``correlations`` the mean squares and
autocorrelations of its results.  They use ``bodies`` (assignment of sites to bodies) and ``superposition``.

    from gearquat_analysis import Poses, correlations, open_dump

    poses = Poses(open_dump("water.dump").atoms).run()
    squares = correlations.mean_square_displacement(poses.results.center)   # (F,)
"""

import importlib.util

_HOME = {"DumpError": ".dump", "open_dump": ".dump", "Poses": ".poses"}
__all__ = list(_HOME)


def __getattr__(name):
    """Import the names above on first use: ``bodies`` and ``superposition`` do not need MDAnalysis."""
    if name in _HOME:
        return getattr(importlib.import_module(_HOME[name], __name__), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
