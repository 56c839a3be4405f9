"""Bodies with larger moments of inertia and the same masses, written to an ``infile``.

Other masses of the sites cannot do this for SPC/E water: with the same total mass, the moment about the axis from
hydrogen to hydrogen is at most 2.5 times larger, if the oxygen has half of the mass.
The angular momenta are larger by the square root of the factor, which keeps the kinetic energy and the equilibrium:
positions and momenta follow the Boltzmann distribution with both inertias.
"""

import numpy as np

HEADER = "# ID mass x y z ixx iyy izz ixy ixz iyz vx vy vz lx ly lz ix iy iz"


def tensors(masses, positions):
    """Inertia tensors (n, 3, 3) of bodies about their centers of mass; ``positions`` (n, sites, 3) relative to these."""
    squares = np.einsum("s,nsi,nsi->n", masses, positions, positions)
    products = np.einsum("s,nsi,nsj->nij", masses, positions, positions)
    return squares[:, None, None] * np.eye(3) - products


def bodies(sites, scene):
    """Rows (n, 20) of an infile for the molecules in the first frame of Sites, in the box of the Scene."""
    liquid = scene.liquid
    count, masses = liquid.molecules, sites.masses.reshape(liquid.molecules, -1)[0]
    positions, velocities = (
        x[0].reshape(count, len(masses), 3) for x in (sites.positions, sites.velocities)
    )
    centers, drifts = (np.average(x, axis=1, weights=masses) for x in (positions, velocities))
    positions, velocities = positions - centers[:, None], velocities - drifts[:, None]
    momenta = np.einsum("s,nsi->ni", masses, np.cross(positions, velocities))
    inertia = scene.inertia * tensors(masses, positions)
    diagonal = inertia[:, [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    images = np.floor(centers / liquid.length)
    return np.column_stack(
        [
            np.arange(1, count + 1),
            np.full(count, masses.sum()),
            centers - images * liquid.length,
            diagonal,
            drifts,
            np.sqrt(scene.inertia) * momenta,
            images,
        ]
    )


def write_bodies(path, sites, scene):
    """Write the infile of the molecules of ``sites`` (engine/sites.py) with the inertia of the Scene."""
    rows = bodies(sites, scene)
    formats = ["%d", *["%.17g"] * 16, *["%d"] * 3]
    np.savetxt(path, rows, fmt=formats, header=f"{len(rows)}\n{HEADER}", comments="")
