#!/usr/bin/env python3
"""Write data.<distance>.consistent: the body of test case 1 aimed at a cage sphere of charge +1.

    python make_encounter.py [FOLDER]

At t = 4 sphere 3 (charge -1/2, no Lennard-Jones term) passes the sphere at (100, 0, 0) at a distance of
0.02 or 0.002.  There the state is stated: the site moves across the line to the sphere, with the
total energy of test case 1, as if the body had been struck at that site.  An integration backwards in
time (SciPy, DOP853) gives the start.  Needs numpy and scipy.
"""

import sys
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

sys.path.append(str(Path(__file__).resolve().parents[2] / "common"))
import make_scenes as scenes  # noqa: E402
from data_files import numbers, transpose, write  # noqa: E402

DISTANCES = ("0.02", "0.002")
TIME = 4.0  # from the start to the closest approach
SITE, SPHERE = 2, np.array([100.0, 0.0, 0.0])
ENERGY = -0.72360304
SIGMA = np.array([1.0, 1.0, 4.0, 10.0])
EPSILON = np.array([0.0, 0.0, 0.0, 10.0])

charges, spheres = (np.array(column) for column in zip(*scenes.cage()))
site_charge, site_mass = np.array(scenes.SITE_CHARGE), np.array(scenes.SITE_MASS)
moments, axes = scenes.principal_moments_and_axes()
moments, sites_body = np.array(moments), np.array(scenes.sites_about_center()) @ np.array(axes).T


def potential_and_forces(sites):
    """Potential energy, and forces on the four sites (Eq. 19)."""
    d = sites[:, None] - spheres[None]
    r2 = (d**2).sum(axis=2)
    s6 = (((SIGMA[:, None] + 10.0) / 2) ** 2 / r2) ** 3
    four = 4.0 * np.sqrt(EPSILON * 10.0)[:, None]
    coulomb = site_charge[:, None] * charges / np.sqrt(r2)
    over_r = (6 * four * (2 * s6 * s6 - s6) + coulomb) / r2
    return (four * (s6 * s6 - s6) + coulomb).sum(), (over_r[:, :, None] * d).sum(axis=1)


def rate(_, y):
    """Center, velocity, rotation body -> space (nine), angular momentum in space."""
    turn, spin = y[6:15].reshape(3, 3), y[15:]
    arms = sites_body @ turn.T
    _, forces = potential_and_forces(y[:3] + arms)
    omega = turn @ ((turn.T @ spin) / moments)
    cross = np.array([[0, -omega[2], omega[1]], [omega[2], 0, -omega[0]], [-omega[1], omega[0], 0]])
    return np.concatenate(
        [y[3:6], forces.sum(0) / 64.0, (cross @ turn).ravel(), np.cross(arms, forces).sum(0)]
    )


def closest(distance):
    """The state at the closest approach."""
    turn = np.array(transpose(scenes.rotation_space_to_site())) @ np.array(axes).T
    arms = sites_body @ turn.T
    towards = arms[SITE] / np.linalg.norm(arms[SITE])
    across = np.cross(towards, [0.0, 0.0, 1.0])
    line = across / np.linalg.norm(across)  # from the sphere to the site
    center = SPHERE + distance * line - arms[SITE]
    inverse_inertia = turn @ np.diag(1 / moments) @ turn.T
    matrix = np.array(
        [[0, -arms[SITE][2], arms[SITE][1]], [arms[SITE][2], 0, -arms[SITE][0]],
         [-arms[SITE][1], arms[SITE][0], 0]]
    )  # fmt: skip
    response = (
        np.eye(3) / 64.0 - matrix @ inverse_inertia @ matrix
    )  # velocity of the site by an impulse
    impulse = np.cross(response @ line, towards)  # so that the site moves across the line
    potential, _ = potential_and_forces(center + arms)
    impulse *= np.sqrt(2 * (ENERGY - potential) / (impulse @ response @ impulse))
    return np.concatenate([center, impulse / 64.0, turn.ravel(), np.cross(arms[SITE], impulse)])


def data(distance):
    """Text of the data file."""
    end = closest(float(distance))
    y = solve_ivp(rate, (0, -TIME), end, method="DOP853", rtol=1e-13, atol=1e-13).y[:, -1]
    turn, _, other = np.linalg.svd(y[6:15].reshape(3, 3))
    turn = turn @ other
    arms = sites_body @ turn.T
    omega = turn @ ((turn.T @ y[15:]) / moments)
    positions = [tuple(row) for row in y[:3] + arms]
    velocities = [tuple(row) for row in y[3:6] + np.cross(omega, arms)]
    text = scenes.data_file("case1", "consistent").splitlines()
    text[0] = (
        f"LAMMPS data file: encounter at {distance}; cage charges are reconstructed (make_encounter.py)"
    )
    for title, rows in (("Atoms # full", positions), ("Velocities", velocities)):
        first = text.index(title) + 2
        for k, row in enumerate(rows):
            words = text[first + k].split()[: 4 if title != "Velocities" else 1]
            text[first + k] = " ".join(words) + " " + numbers(row)
    return "\n".join(text) + "\n"


def scene_files():
    """All files as a dictionary: path below the examples folder -> text."""
    return {
        "hard/encounter/data.%s.consistent" % distance: data(distance) for distance in DISTANCES
    }


if __name__ == "__main__":
    write(scene_files())
