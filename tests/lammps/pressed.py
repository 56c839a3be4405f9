"""Scenes with a barostat: asymmetric trimers in a smooth potential, in a periodic box."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scenes import one_after_the_other, random_rotation

ARMS = np.array([[0.0, 0.25, 0.0], [0.3, -0.15, 0.05], [-0.2, -0.1, -0.1]])
MASSES = np.array([1.0, 0.7, 1.3])
FLAT_ARMS = ARMS * [1.0, 1.0, 0.0]

DECK = """
units lj
dimension {dimension}
atom_style molecular
atom_modify map array sort 0 0.0
boundary {boundary}
processors {processors}
{box}
{pair}
neighbor 0.4 bin
neigh_modify delay 0 every 1 check yes exclude molecule/intra all
timestep {dt}
{before}
fix move all gear/quat molecule {words}
{after}
thermo_style custom step pe ke etotal ecouple econserve press lx ly lz vol f_move[*]
thermo_modify norm no format float %.17g
thermo {thermo}
{run}
write_dump all custom {end} id x y z vx vy vz ix iy iz modify sort id format float %.17g
"""
#: repulsive, and at the cutoff rounding; the first is not in the tree
GAUSS = "pair_style gauss 2.2\npair_coeff * * -4.0 8.0"
REPULSIVE = "pair_style buck 2.6\npair_coeff * * 60.0 0.08 0.0"


def trimers(
    path: Path, n: int = 2, spacing: float = 2.0, flat: bool = False, images=(0, 0, 0), change=None
) -> Path:
    """A data file of n^3 (flat: n^2) turned trimers without total momentum, all in the first image of the box.

    ``change``: an upper triangular matrix that deforms box and centers, not molecules; the box is triclinic then.
    ``images``: flags of molecules, times -1, 0 or 1 in turn.
    """
    rng = np.random.default_rng(20261124)
    length = n * spacing
    arms = FLAT_ARMS if flat else ARMS
    arms = arms - MASSES @ arms / MASSES.sum()
    cells = [(i, j, 0.0) for i, j in np.ndindex(n, n)] if flat else list(np.ndindex(n, n, n))
    velocities = rng.normal(size=(len(cells), 3)) * 0.6
    spins = rng.normal(size=(len(cells), 3)) * 1.5
    velocities -= velocities.mean(axis=0)
    atoms, moving = [], []
    for k, cell in enumerate(cells):
        center = (np.array(cell) + 0.5 + rng.normal(size=3) * 0.06) * spacing
        turn = random_rotation(rng)
        center = center if change is None else change @ center
        if flat:
            center[2] = velocities[k, 2] = spins[k, 0] = spins[k, 1] = 0.0
            angle = rng.uniform(0, 2 * np.pi)
            turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
        for kind, arm in enumerate(arms @ turn.T, 1):
            atoms.append((k + 1, kind, *(center + arm), *(m * (k % 3 - 1) for m in images)))
            moving.append(velocities[k] + np.cross(spins[k], arm))
    across = "-0.5 0.5" if flat else f"0 {length}"
    lines = ["trimers", "", f"{len(atoms)} atoms", "3 atom types", ""]
    edges = [f"0 {length} xlo xhi", f"0 {length} ylo yhi", f"{across} zlo zhi"]
    if change is not None:
        h = length * np.array(change)
        edges = [f"0 {h[k, k]:.17g} {c}lo {c}hi" for k, c in enumerate("xyz")]
        edges.append(f"{h[0, 1]:.17g} {h[0, 2]:.17g} {h[1, 2]:.17g} xy xz yz")
    lines += [*edges, "", "Masses", ""]
    lines += [f"{k} {mass}" for k, mass in enumerate(MASSES, 1)]
    for name, rows in (("Atoms # molecular", atoms), ("Velocities", moving)):
        lines += ["", name, ""] + [" ".join(f"{w:.17g}" for w in (k, *row)) for k, row in enumerate(rows, 1)]
    path.write_text("\n".join(lines) + "\n")
    return path


def pressed(words: str, dt: float = 0.005, steps: int = 100, **settings) -> str:
    """A deck; ``words`` follow `fix move all gear/quat molecule`; settings: those of DECK, and ``data``."""
    data = settings.pop("data", "data.trimers")
    known = dict(dimension=3, boundary="p p p", processors="* * *", box=f"read_data {data}", pair=GAUSS)
    known |= dict(before="", after="", thermo=max(1, steps // 10), run=f"run {steps}", end="end.dump")
    return DECK.format(words=words, dt=dt, **(known | settings))


def frame(path: Path) -> np.ndarray:
    """Places, velocities and image flags of a written dump, shape (atoms, 9)."""
    return np.loadtxt(path, skiprows=9)[:, 1:]


def ends(lmp, decks: list[str], ranks: int = 1):
    """Runs decks one after the other: the last table of each, and where its atoms end."""
    decks = [deck.replace("end.dump", f"end{k}.dump") for k, deck in enumerate(decks)]
    result = lmp.succeed(one_after_the_other(decks), ranks=ranks)
    frames = [frame(lmp.folder / f"end{k}.dump") for k in range(len(decks))]
    return result, frames


def largest_change(table, column: str = "Econserve") -> float:
    values = np.array(table[column])
    return np.abs(values - values[0]).max()


def distances(rows: np.ndarray, box: np.ndarray) -> np.ndarray:
    """Of the sites of each trimer in a frame, with these edges of the box."""
    sites = (rows[:, :3] + rows[:, 6:9] * box).reshape(-1, 3, 3)
    return np.linalg.norm(sites - np.roll(sites, 1, axis=1), axis=2)
