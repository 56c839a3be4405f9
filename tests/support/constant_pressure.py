"""Simulations with a barostat: asymmetric trimers in a smooth potential, in a periodic box."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from support.scenes import one_after_the_other, random_rotation

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
#: repulsive, with a negligible jump at the cutoff; the first is not in the tree
GAUSS = "pair_style gauss 2.2\npair_coeff * * -4.0 8.0"
REPULSIVE = "pair_style buck 2.6\npair_coeff * * 60.0 0.08 0.0"


def trimers(
    path: Path, n: int = 2, spacing: float = 2.0, flat: bool = False, images=(0, 0, 0), change=None
) -> Path:
    """A data file of n^3 (flat: n^2) rotated trimers without total momentum, all in the first image of the box.

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
    """A deck; ``words`` follow `fix move all gear/quat molecule`; settings: as in DECK, and ``data``."""
    data = settings.pop("data", "data.trimers")
    known = dict(dimension=3, boundary="p p p", processors="* * *", box=f"read_data {data}", pair=GAUSS)
    known |= dict(before="", after="", thermo=max(1, steps // 10), run=f"run {steps}", end="end.dump")
    return DECK.format(words=words, dt=dt, **(known | settings))


def frame(path: Path) -> np.ndarray:
    """Positions, velocities and image flags of a dump, shape (atoms, 9)."""
    return np.loadtxt(path, skiprows=9)[:, 1:]


def ends(lmp, decks: list[str], ranks: int = 1):
    """Runs decks one after the other: the last table and the final atoms of each."""
    decks = [deck.replace("end.dump", f"end{k}.dump") for k, deck in enumerate(decks)]
    result = lmp.succeed(one_after_the_other(decks), ranks=ranks)
    frames = [frame(lmp.folder / f"end{k}.dump") for k in range(len(decks))]
    return result, frames


def apart(one, other):
    """Largest difference of positions and velocities of two frames; an atom may be at either face of the box."""
    changed = np.abs(one - other)[:, :6]
    wrapped = changed[:, :3] > 1.0
    assert wrapped.sum() < 4
    changed[:, :3][wrapped] = 0.0
    return changed.max()


def distances(rows: np.ndarray, box: np.ndarray) -> np.ndarray:
    """Distances between the sites of each trimer in a frame, with these edges of the box."""
    sites = (rows[:, :3] + rows[:, 6:9] * box).reshape(-1, 3, 3)
    return np.linalg.norm(sites - np.roll(sites, 1, axis=1), axis=2)


# The second derivative is discontinuous at the cutoff, which is between two shells of neighbors of small molecules.
PAIR = "pair_style lj/sf/dipole/sf 2.42\npair_coeff * * 0.3 1.2"
LENGTH, SIZE, MOMENT, TARGET, TIME = 4.0, 0.3, 0.8, -0.25, 0.2


def dipoles(factors=(1.0, 1.0, 1.0), moment=MOMENT, tilt=0.0, motion=True) -> str:
    """Commands that make eight rotated trimers with charges and a dipole each; factors scale box and centers."""
    rng = np.random.default_rng(20261126)
    factors, edges = np.array(factors), LENGTH * np.array(factors)
    sites = SIZE * (ARMS - MASSES @ ARMS / MASSES.sum())
    box = " ".join(f"0 {edge:.17g}" for edge in edges)
    shape = f"prism {box} {tilt} 0 0" if tilt else f"block {box}"
    lines = [f"region box {shape}", "create_box 3 box"]
    velocities, spins = rng.normal(size=(8, 3)) * 0.2, rng.normal(size=(8, 3)) * 1.5
    velocities -= velocities.mean(axis=0)
    for k, cell in enumerate(np.ndindex(2, 2, 2)):
        center = (np.array(cell) + 0.5 + rng.normal(size=3) * 0.02) * LENGTH / 2 * factors
        turn = random_rotation(rng)
        for n, arm in enumerate(sites @ turn.T):
            i, v = 3 * k + n + 1, velocities[k] + np.cross(spins[k], arm)
            lines.append("create_atoms {} single {:.17g} {:.17g} {:.17g}".format(n + 1, *(center + arm)))
            lines.append(f"set atom {i} mol {k + 1} mass {MASSES[n]} diameter 0 charge {(0.4, -0.4, 0.0)[n]}")
            if motion:
                lines.append("set atom {} vx {:.17g} vy {:.17g} vz {:.17g}".format(i, *v))
            if n == 2 and moment:
                lines.append("set atom {} dipole {:.17g} {:.17g} {:.17g}".format(i, *(moment * turn[:, 0])))
    return "\n".join(lines)


def dipoles_deck(words, dt=0.005, **scene):
    """A run of TIME, or without steps if the bodies are at rest."""
    steps = round(TIME / dt) if scene.get("motion", True) else 0
    text = pressed(words, dt, steps, box=dipoles(**scene), pair=PAIR)
    return text.replace("atom_style molecular", "atom_style hybrid molecular sphere dipole")
