"""Functions shared by the programs that write data files: vectors, LAMMPS' format, and paths.

Standard library only, sums rounded once (``fsum``), so that files come out the same to the last digit
wherever they are written.
"""

import math
import sys
from pathlib import Path

EXAMPLES = Path(__file__).resolve().parent.parent
ONE = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
#: a general rotation, scalar first, of length sqrt(30)
QUATERNION = (4, 1, 2, 3)


# --- vectors ------------------------------------------------------------------------------------
def dot(a, b):
    """Scalar product of two sequences, rounded once."""
    return math.fsum(x * y for x, y in zip(a, b))


def matvec(m, v):
    """Product of a matrix (tuple of rows) and a vector."""
    return tuple(dot(row, v) for row in m)


def transpose(m):
    """Transposed matrix, as a tuple of rows."""
    return tuple(zip(*m))


def matmul(a, b):
    """Product of two matrices, as a tuple of rows."""
    columns = transpose(b)
    return tuple(tuple(dot(row, c) for c in columns) for row in a)


def cross(a, b):
    """Vector product of two 3-vectors."""
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


def add(a, b):
    """Sum of two vectors."""
    return tuple(x + y for x, y in zip(a, b))


def diagonal(d):
    """Diagonal 3x3 matrix of three numbers."""
    return ((d[0], 0.0, 0.0), (0.0, d[1], 0.0), (0.0, 0.0, d[2]))


def general_rotation():
    """Rotation matrix of QUATERNION; its entries are multiples of 1/15."""
    w, x, y, z = QUATERNION
    square = w * w + x * x + y * y + z * z
    rows = (
        (w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z),
    )
    return tuple(tuple(entry / square for entry in row) for row in rows)


# --- files --------------------------------------------------------------------------------------
def numbers(values):
    """Numbers with 17 significant digits, separated by blanks."""
    return " ".join("%.17g" % (v + 0.0) for v in values)


def cube(half_length):
    """Lines of a box about the origin."""
    return ["%g %g %slo %shi" % (-half_length, half_length, a, a) for a in "xyz"]


def data_text(title, box, masses, atoms, velocities):
    """Text of a LAMMPS data file, atom style full.

    ``box``: its lines; ``masses``: one of each type, a number or words; ``atoms``: (molecule, type,
    charge, position) each.
    """
    lines = ["LAMMPS data file: " + title, "", "%d atoms" % len(atoms)]
    lines += ["%d atom types" % len(masses), "", *box, "", "Masses", ""]
    lines += [
        "%d %s" % (t, m if isinstance(m, str) else "%.17g" % m) for t, m in enumerate(masses, 1)
    ]
    lines += ["", "Atoms # full", ""]
    for tag, (molecule, kind, charge, place) in enumerate(atoms, start=1):
        lines.append("%d %d %d %g %s" % (tag, molecule, kind, charge, numbers(place)))
    lines += ["", "Velocities", ""]
    lines += ["%d %s" % (tag, numbers(v)) for tag, v in enumerate(velocities, start=1)]
    return "\n".join(lines) + "\n"


def write(files):
    """Write files, path -> text, below the folder that the command line names, or below EXAMPLES."""
    for name, text in files.items():
        path = Path(sys.argv[1] if len(sys.argv) > 1 else EXAMPLES) / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="ascii")
        print(path)
