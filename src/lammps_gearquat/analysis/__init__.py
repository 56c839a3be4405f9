"""Analysis of rigid bodies with MDAnalysis: poses, motion, correlations.  Nothing here draws.

``dump``: LAMMPS dumps as universes; ``poses``: Poses and TablePoses, the analyses; ``correlations``: mean
squares and autocorrelations of their results; ``residence``: stays near given places; ``convert``:
trajectories for other viewers.  Beneath them ``bodies`` (who is in which body) and ``superposition``.

    from lammps_gearquat.analysis import Poses, correlations, open_dump

    poses = Poses(open_dump("water.dump").atoms).run()
    squares = correlations.mean_square_displacement(poses.results.centre)   # (F,)
"""

from .dump import DumpError, open_any, open_dump, open_table
from .poses import Poses, TablePoses

__all__ = ["DumpError", "Poses", "TablePoses", "open_any", "open_dump", "open_table"]
