"""The state of the atoms after a run, so that trials need not repeat the run.

``save`` and ``restore`` are called by every rank, in a process that runs LAMMPS.  These functions keep the time step,
the box, and the arrays of ATOM_DATA to the last bit; most runs change nothing else.  Other state, such as the variables
of a thermostat, is not kept; ``Deck`` compares the first steps after a restored state with the steps of the unchanged
deck.
"""

import ctypes
import glob
import os

import numpy as np

from gearquat_analysis.bodies import places

from .script import DeckError

#: arrays of atoms that a run may change, as far as the atom style has them
ATOM_DATA = ("x", "v", "image", "omega", "angmom", "mu", "q", "radius", "rmass")


def save(lammps, prefix):
    """Write the atoms of this rank to a separate file, whose name begins with ``prefix``."""
    extract = lammps.numpy.extract_atom
    data = {name: extract(name) for name in ("id", *ATOM_DATA)}
    local = lammps.extract_global("nlocal")
    arrays = {name: array[:local] for name, array in data.items() if array is not None}
    low, high, xy, yz, xz, *_ = lammps.extract_box()
    box = np.array([*low, *high, xy, yz, xz])
    step = lammps.extract_global("ntimestep")
    np.savez(f"{prefix}.{os.getpid()}.npz", box=box, step=step, **arrays)


def restore(lammps, prefix):
    """Put all atoms back into the state that was saved with ``prefix``.

    Forces, neighbor lists and the bodies of fixes follow from it: one ``run 0`` sets them up, then the state is
    restored once more.  Raises DeckError if the atoms differ.
    """
    parts = [np.load(path) for path in sorted(glob.glob(f"{glob.escape(str(prefix))}.*.npz"))]
    names = set(parts[0]) - {"box", "step"}
    state = {name: np.concatenate([part[name] for part in parts]) for name in names}
    extract = lammps.lib.lammps_extract_global
    extract.restype = ctypes.POINTER(ctypes.c_int64)
    extract(lammps.lmp, b"ntimestep")[0] = int(parts[0]["step"])
    _restore_box(lammps, parts[0]["box"])
    _restore_atoms(lammps, state)
    if lammps.extract_setting("world_size") > 1:
        # atoms that have moved far change their ranks here, because the set-up of a run does not expect this
        lammps.command("displace_atoms all move 0 0 0")
    lammps.command("run 0 post no")
    _restore_atoms(lammps, state)


def _restore_atoms(lammps, state):
    """Overwrite the arrays of the local atoms, which are found by their IDs."""
    local = lammps.extract_global("nlocal")
    ids = lammps.numpy.extract_atom("id")
    ids = np.empty(0, dtype=int) if ids is None else ids[:local]
    place = places(state["id"], ids)
    if lammps.get_natoms() != len(state["id"]) or (place < 0).any():
        raise DeckError("the atoms have changed")
    for name, values in state.items():
        if name != "id" and local:
            lammps.numpy.extract_atom(name)[:local] = values[place]


def _restore_box(lammps, box):
    """Give the periodic directions of the box their size at that time."""
    low, high, xy, yz, xz, periodic, _ = lammps.extract_box()
    words = []
    for k, axis in enumerate("xyz"):
        if periodic[k] and (low[k], high[k]) != (box[k], box[3 + k]):
            words += [axis, "final", f"{box[k]:.17g}", f"{box[3 + k]:.17g}"]
    for name, now, then in zip(("xy", "yz", "xz"), (xy, yz, xz), box[6:]):
        if now != then:
            words += [name, "final", f"{then:.17g}"]
    if words:
        lammps.command(f"change_box all {' '.join(words)} units box")
