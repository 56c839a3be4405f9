"""Contents of the data files of the scenes for tests."""

import numpy as np


def read_atoms(path):
    """Sections Atoms (n, columns) and Velocities (n, 3) of a data file, by atom ID."""
    sections = path.read_text().partition("Atoms # full")[2].split("Velocities")
    tables = [np.loadtxt(section.splitlines()) for section in sections]
    atoms, velocities = (table[table[:, 0].argsort()] for table in tables)
    return atoms, velocities[:, 1:4]
