"""Check, before any flight, that the forces between the bodies vanish smoothly at the cutoff.

The bodies approach each other along a line, in several poses.  Where the force jumps, the difference of the force
between two distances does not decrease when these distances approach each other; where the force is continuous, the
difference is halved.  A jump is detected if it exceeds the usual change of the force between two distances of the first
scan.  With lj/smooth, the energy jumps but the force does not: a constant offset, which does not affect flights.
"""

import numpy as np
from scipy.spatial.transform import Rotation

from ..trials.script import DeckError

#: jumps of the force, times the cutoff, that are refused, by the energy of the flights
JUMP = 1e-3
#: number of poses, number of distances in each pose, and the smallest distance relative to the reach
POSES, DISTANCES, NEAREST = 4, 200, 0.02
#: distances with a larger repulsive energy, relative to the energy of the flights, are not tested
REPULSION = 10.0
#: number of bisections, and the least part of a difference in the larger half of its interval if there is a jump
BISECTIONS, KEPT = 30, 0.75


def check(pair, scale):
    """Raise DeckError if the bodies of a Pair exert no forces on each other, or forces that jump.

    ``scale``: kT or the energy of the flights, in units of the deck.
    """
    turns = Rotation.random(2 * POSES, random_state=np.random.default_rng(2)).as_quat(scalar_first=True)
    acting, least = False, JUMP * scale / pair.cutoff
    for pose in turns.reshape(POSES, 2, 4):
        r, force = _scanned(pair, pose, REPULSION * scale)
        acting = acting or bool(np.any(force))
        distance, size = _largest_jump(lambda x, pose=pose: pair.interaction(pose, x)[1], r, force, least)
        if size:
            raise DeckError(
                f"the force between the bodies jumps where they are {distance:.6g} apart (the cutoff is"
                f" {pair.cutoff:.6g}), by {size * pair.cutoff / scale:.1e} of the energy of the flights over the"
                " cutoff: a pair style whose forces vanish smoothly is required, such as lj/gromacs or lj/smooth"
            )
    if not acting:
        raise DeckError(
            "the bodies exert no forces on each other: a pair style whose coefficients are not zero is required"
        )


def _scanned(pair, pose, highest):
    """Distances (n,), descending until the energy reaches ``highest``, and forces (n,) there."""
    far, found = pair.interaction(pose, pair.reach)[0], []
    for distance in np.linspace(1.0, NEAREST, DISTANCES) * pair.reach:
        energy, force = pair.interaction(pose, distance)
        if not np.isfinite([energy, force]).all() or energy - far > highest:
            break
        found.append((distance, force))
    return np.array(found).reshape(-1, 2).T


def _largest_jump(function, r, values, least):
    """(distance, size) of the largest jump above ``least`` of a function with values (n,) at r (n,), or zeros."""
    jumps = [(0.0, 0.0)]
    for k in np.flatnonzero(np.abs(np.diff(values)) > least):
        jumps.append(_jump(function, r[k : k + 2], values[k : k + 2], least))
    return max(jumps, key=lambda jump: jump[1])


def _jump(function, ends, values, least):
    """(distance, size) of a jump between two ends, or zeros if the function is continuous."""
    for _ in range(BISECTIONS):
        middle = 0.5 * (ends[0] + ends[1])
        between = function(middle)
        halves = abs(between - values[0]), abs(values[1] - between)
        if not max(halves) > max(least, KEPT * abs(values[1] - values[0])):
            return 0.0, 0.0
        first = halves[0] > halves[1]
        ends, values = ((ends[0], middle), (values[0], between)) if first else ((middle, ends[1]), (between, values[1]))
    return float(ends[0]), float(abs(values[1] - values[0]))
