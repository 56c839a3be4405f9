"""LAMMPS dumps as MDAnalysis universes, in double precision.

``open_dump`` returns a Universe whose residues are the bodies: ``resids`` are the IDs of the bodies, and residue 0, if
there is one, contains the atoms outside of bodies.

MDAnalysis stores positions and boxes in single precision.  ``DumpFrames`` therefore also stores them in double
precision, in ``Timestep.data``.  It reads a whole frame at once, not atom by atom.
"""

import re
import warnings
from dataclasses import dataclass
from pathlib import Path

import MDAnalysis
import numpy as np
from MDAnalysis.coordinates.LAMMPS import DumpReader
from MDAnalysis.exceptions import NoDataError
from MDAnalysis.guesser.tables import masses as MASSES
from MDAnalysis.lib.mdamath import triclinic_box
from MDAnalysis.lib.util import anyopen
from MDAnalysis.topology.LAMMPSParser import DATAParser

from .bodies import places

#: columns of positions, in descending order of preference
POSITIONS = {
    "unwrapped": ("xu", "yu", "zu"),
    "scaled unwrapped": ("xsu", "ysu", "zsu"),
    "wrapped": ("x", "y", "z"),
    "scaled": ("xs", "ys", "zs"),
}
VELOCITIES = ("vx", "vy", "vz")
IMAGES = ("ix", "iy", "iz")
HEADER_LINES = 9
#: first bytes of gzip and bzip2 files
PACKED = b"\x1f\x8b", b"BZh"


class DumpError(ValueError):
    """Raised for a dump that cannot be used; the message says what is required.

    >>> from gearquat_analysis import DumpError, open_dump
    >>> try:
    ...     open_dump("in.nitrogen")
    ... except DumpError as error:
    ...     print(error)
    in.nitrogen: the header of a frame of a LAMMPS dump is required
    """


@dataclass(frozen=True)
class Header:
    """The header of a frame.

    ``units`` (``dump_modify units yes``, written once in a file) and ``time`` (``dump_modify time yes``) are None unless
    written; ``box`` (3, 3) has the edges as rows.
    """

    step: int
    rows: int
    origin: np.ndarray
    box: np.ndarray
    periodic: np.ndarray
    columns: list
    units: str = None
    time: float = None


def read_header(file, name, line=None):
    """Header of the frame that begins here, or with a ``line`` already read.  Raises DumpError if no frame begins here."""
    line, extra = file.readline() if line is None else line, {}
    for item, read in (("units", str.strip), ("time", float)):
        if line == f"ITEM: {item.upper()}\n":
            extra[item] = read(file.readline())
            line = file.readline()
    lines = [line] + [file.readline() for _ in range(HEADER_LINES - 1)]
    if lines[0].startswith("ITEM: TIMESTEP") and not lines[-1].endswith("\n"):
        raise DumpError(f"{name}: the dump ends within the header of a frame; a whole frame is required")
    expected = "ITEM: TIMESTEP", "ITEM: NUMBER OF", "ITEM: BOX BOUNDS"
    if not all(line.startswith(word) for line, word in zip(lines[0:5:2], expected)):
        raise DumpError(f"{name}: the header of a frame of a LAMMPS dump is required")
    kind, *columns = lines[8].split()[1:]
    if kind != "ATOMS":
        raise DumpError(f"{name}: a dump custom is required, not 'ITEM: {kind}'")
    box = _box(lines[4], lines[5:8], name)
    return Header(int(lines[1]), int(lines[3]), *box, columns, **extra)


def _box(title, bounds, name):
    """Origin, edges and periodicity of a box of LAMMPS."""
    flags = [word for word in title.split() if re.fullmatch(r"[pfsm]{2}", word)]
    periodic = np.array([flag == "pp" for flag in flags])
    try:
        numbers = np.array([line.split() for line in bounds], dtype=float)
    except ValueError:
        numbers = np.empty((0, 0))
    if len(periodic) != 3 or numbers.shape not in ((3, 2), (3, 3)):
        raise DumpError(f"{name}: an orthogonal or restricted triclinic box is required")
    low, high = numbers[:, 0].copy(), numbers[:, 1].copy()
    xy, xz, yz = numbers[:, 2] if numbers.shape == (3, 3) else (0.0, 0.0, 0.0)
    # the bounds of a triclinic box are the bounds of the orthogonal box around it (LAMMPS, Howto_triclinic)
    low[:2] -= min(0.0, xy, xz, xy + xz), min(0.0, yz)
    high[:2] -= max(0.0, xy, xz, xy + xz), max(0.0, yz)
    box = np.diag(high - low)
    box[1, 0], box[2, 0], box[2, 1] = xy, xz, yz
    return low, box, periodic


def columns_of(path):
    """Names of the columns of a dump."""
    if not Path(path).is_file():
        raise DumpError(f"{path}: no such file")
    if not Path(path).stat().st_size:
        raise DumpError(f"{path}: the dump is empty")
    try:
        with anyopen(str(path)) as file:
            return read_header(file, path).columns
    except UnicodeDecodeError:
        raise DumpError(f"{path}: this is a binary file; a text dump is required") from None


class DumpFrames(DumpReader):
    """MDAnalysis' reader of LAMMPS dumps, changed to read a frame at once and in double precision.

    ``Timestep.positions`` follow MDAnalysis' convention (single precision, box moved to the origin); they are unwrapped
    if the dump has the columns for it.  ``Timestep.data`` contains

    * ``step``; ``time``: the time in the dump, or else the step times ``dt``
    * ``x`` (n, 3): positions in LAMMPS' coordinates, unwrapped if the dump has the columns for it
    * ``whole``: True if positions are unwrapped or no direction is periodic
    * ``v`` (n, 3): velocities, if the dump has them
    * ``box`` (3, 3): edges as rows; ``origin`` (3,); ``periodic`` (3,)
    * each of ``additional_columns`` (n,)

    The attribute ``dt`` is the (mean) time between two frames, and ``totaltime`` the time from the first to the last
    frame, both in units of ``Timestep.time``.  Further attributes describe the dump:

    * ``unit_style``: LAMMPS' units or None
    * ``timed``: True if the dump has times
    * ``counted``: True if numbers of steps replace times, because neither the dump nor ``dt`` gives them
    * ``cut_off``: True if the last frame is incomplete; it is left out with a warning

    Rows are sorted by ID; the order of columns may change from frame to frame.  Raises DumpError if IDs are missing,
    occur twice or change, if positions are missing, if the number of rows or the set of the columns that are read
    changes, or if the first frame is incomplete.
    """

    _auxs = {}  # MDAnalysis closes these, even if the reader raised an error

    def __init__(self, filename, additional_columns=(), dt=None, **kwargs):
        self._ids = self._groups = None
        self._timestep = 1.0 if dt is None else dt
        self._scan(filename)
        self.counted = dt is None and not self.timed
        if len(self._offsets) > 1:
            kwargs["dt"] = self.totaltime / (len(self._offsets) - 1)
        super().__init__(filename, additional_columns=list(additional_columns), **kwargs)

    def _scan(self, filename):
        """Find the offsets of complete frames, and take units and times from the headers."""
        with open(filename, "rb") as file:
            self.packed = file.read(3).startswith(PACKED)
        self._offsets, first, self.cut_off = [], None, False
        with anyopen(filename) as file:
            while True:
                here, line = file.tell(), file.readline()  # never seek back, see _read_frame
                if not line:
                    break
                try:
                    header = read_header(file, filename, line)
                    end = "\n"
                    for _ in range(header.rows):
                        end = file.readline()
                    self.cut_off = not end.endswith("\n")
                except (ValueError, IndexError):
                    # the run was killed, or the file is not a dump
                    if first is None or file.readline():
                        raise
                    self.cut_off = True
                if self.cut_off and first:
                    warnings.warn(f"{filename}: the last frame is incomplete and is left out", stacklevel=2)
                    break
                if self.cut_off:
                    raise DumpError(f"{filename}: the dump ends within its first frame; a whole frame is required")
                first, last = first or header, header
                self._offsets.append(here)
        self._rows, self.unit_style, self.timed = first.rows, first.units, first.time is not None
        self._total = self._time(last) - self._time(first)

    def _time(self, header):
        return header.step * self._timestep if header.time is None else header.time

    def _reopen(self):
        self._next = 0
        super()._reopen()

    def _read_frame(self, frame):
        # in a compressed file, avoid seek: it may unpack the file again from its beginning
        if frame < self._next or not self.packed:
            self._file.seek(self._offsets[frame])
        else:
            for _ in range(self._next, frame):
                for _ in range(read_header(self._file, self.filename).rows):
                    self._file.readline()
        self.ts.frame = frame - 1
        return self._read_next_timestep()

    n_atoms = property(lambda self: self._rows)
    n_frames = property(lambda self: len(self._offsets))
    totaltime = property(lambda self: self._total)

    def _columns(self, header):
        """Index of each column that is read, and the kind of positions."""
        where = f"{self.filename}, step {header.step}"
        index = {name: k for k, name in enumerate(header.columns)}
        kind = next((k for k, names in POSITIONS.items() if set(names) <= set(index)), None)
        if "id" not in index:
            raise DumpError(f"{where}: no column id; it is required to identify atoms in all frames")
        if kind is None:
            raise DumpError(f"{where}: no positions; columns xu yu zu or x y z are required")
        missing = [name for name in self._additional_columns if name not in index]
        if missing:
            raise DumpError(f"{where}: no column {' '.join(missing)}")
        groups = [*POSITIONS[kind]]
        for group in (VELOCITIES, IMAGES):
            groups += group if set(group) <= set(index) else ()
        self._groups = self._groups or groups
        if groups != self._groups:
            raise DumpError(
                f"{where}: columns {' '.join(groups)}, in the first frame {' '.join(self._groups)}: all frames must"
                " have the same columns"
            )
        return {name: index[name] for name in ["id", *groups, *self._additional_columns]}, kind

    def _read_next_timestep(self):
        ts = self.ts
        ts.frame += 1
        if ts.frame >= len(self):
            raise EOFError
        self._next = len(self) + 1  # the file is within a frame until the frame is read
        header = read_header(self._file, self.filename)
        if header.rows != self.n_atoms:
            raise DumpError(
                f"{self.filename}: {header.rows} rows at step {header.step}, {self.n_atoms} in the first"
                " frame; the number must not change: dump a group whose atoms stay"
            )
        columns, kind = self._columns(header)
        # readline, not iteration: tell() fails during iteration
        lines = [self._file.readline() for _ in range(header.rows)]
        try:
            table = np.loadtxt(lines, usecols=list(columns.values()), ndmin=2)
        except ValueError as error:
            number = len(header.columns)
            short = next((len(line.split()) for line in lines if len(line.split()) < number), None)
            cause = f"a row with {short} columns; {number} are required" if short else error
            raise DumpError(f"{self.filename}, step {header.step}: {cause}") from error
        self._fill(dict(zip(columns, table.T)), kind, header)
        self._next = ts.frame + 1
        return ts

    def _fill(self, table, kind, frame):
        ts, step, origin, box, periodic = self.ts, frame.step, frame.origin, frame.box, frame.periodic
        order = np.argsort(table["id"], kind="stable")
        table = {name: column[order] for name, column in table.items()}
        self._check_ids(table["id"], step)
        x = np.column_stack([table[name] for name in POSITIONS[kind]])
        if kind.startswith("scaled"):
            x = origin + x @ box
        whole = kind.endswith("unwrapped") or not periodic.any()
        if not whole and all(name in table for name in IMAGES):
            x = x + np.column_stack([table[name] for name in IMAGES]) @ box
            whole = True
        ts.data.update(step=step, time=self._time(frame), x=x, whole=whole)
        ts.data.update(box=box, origin=origin, periodic=periodic)
        ts.dimensions = triclinic_box(*box)
        ts.positions = x - origin
        if VELOCITIES[0] in table:
            ts.data["v"] = np.column_stack([table[name] for name in VELOCITIES])
            ts.velocities = ts.data["v"]
        for name in self._additional_columns:
            ts.data[name] = table[name]

    def _check_ids(self, ids, step):
        if self._ids is None:
            if len(np.unique(ids)) < len(ids):
                raise DumpError(f"{self.filename}: an ID occurs twice at step {step}")
            self._ids = ids
        if not np.array_equal(ids, self._ids):
            raise DumpError(
                f"{self.filename}: other IDs at step {step} than in the first frame: dump a group whose"
                " atoms stay"
            )

    def pop_columns(self, names):
        """Return the additional columns with these names, name -> (n,), and stop reading them."""
        self._additional_columns = [name for name in self._additional_columns if name not in names]
        return {name: self.ts.data.pop(name) for name in names}

    @property
    def ids(self):
        """IDs (n,) of the rows, ascending."""
        return self._ids.astype(int)


def _names(masses, types):
    """Names and elements (n,) for viewers if all masses are masses of elements; else names T1 ... and None."""
    symbols = np.array(list(MASSES))
    weights = np.array([MASSES[symbol] for symbol in symbols])
    kinds, which = np.unique(masses, return_inverse=True)
    nearest = np.abs(kinds[:, None] - weights).argmin(axis=1)
    if (np.abs(weights[nearest] - kinds) < 0.005).all():
        return (symbols[nearest][which].astype(object),) * 2
    return np.array([f"T{kind}" for kind in types], dtype=object), None


def _universe(reader, bodies, masses, types, charges=None):
    """A Universe with the trajectory of ``reader``; its residues are the bodies."""
    numbers, residue = np.unique(bodies, return_inverse=True)
    universe = MDAnalysis.Universe.empty(len(residue), len(numbers), atom_resindex=residue)
    names, elements = _names(masses, types)
    attributes = {
        "ids": reader.ids,
        "resids": numbers,
        "masses": masses,
        "types": types.astype(str),
        "names": names,
    }
    attributes |= {} if elements is None else {"elements": elements}
    attributes |= {} if charges is None else {"charges": charges}
    for name, values in attributes.items():
        universe.add_TopologyAttr(name, values)
    universe.trajectory = reader
    return universe


def _from_data_file(data, atom_style, ids, whole):
    """Masses, bodies (molecule IDs, or None) and types of the atoms ``ids``, from a LAMMPS data file.

    ``whole``: raise DumpError if the file has other atoms of these bodies.
    """
    style = {"atom_style": atom_style} if atom_style else {}
    try:
        # only the topology is read: velocities are not needed, and MDAnalysis would read on to the next section that it
        # recognizes
        with DATAParser(str(data)) as parser, warnings.catch_warnings():
            warnings.simplefilter("ignore")
            known = MDAnalysis.Universe(parser.parse(**style), to_guess=()).atoms
        known.masses
    except (ValueError, LookupError, OSError, NoDataError) as error:
        raise DumpError(
            f"{data}: MDAnalysis cannot read this data file ({error}); sections Masses and Atoms are required, with the"
            " columns of atom style full or molecular unless others are named (--atom-style), and no sections of fixes"
            " (write_data ... nofix)"
        ) from error
    place = places(known.ids, ids)
    if (place < 0).any():
        raise DumpError(f"{data}: atom {ids[place < 0][0]} of the dump is missing")
    molecules = not atom_style or "resid" in atom_style.split()
    other = np.setdiff1d(np.arange(len(known)), place)
    other = other[np.isin(known.resids[other], np.setdiff1d(known.resids[place], [0]))]
    if whole and molecules and len(other):
        raise DumpError(
            f"{data}: the dump lacks {len(other)} atoms of its bodies, such as atom {known.ids[other[0]]} of body"
            f" {known.resids[other[0]]}; a dump of whole bodies is required"
        )
    known = known[place]
    return known.masses, known.resids if molecules else None, known.types


def _check_same(what, found, dumped, ids):
    """Raises DumpError if numbers (n,) of a data file differ from the numbers of the dump, which may have only six
    digits, or be None."""
    other = np.zeros(0, int) if dumped is None else np.flatnonzero(~np.isclose(found, dumped, rtol=1e-5, atol=0.0))
    if len(other):
        k = other[0]
        raise DumpError(
            f"{what} {found[k]:g} of atom {ids[k]}, but {dumped[k]:g} in the dump: the data file of the dumped run is"
            " required"
        )


def open_dump(path, data=None, body="mol", potential=None, timestep=None, atom_style=None):
    """Universe of a ``dump custom``.

    The dump needs the columns ``id``, positions (``xu yu zu``, or ``x y z`` with ``ix iy iz`` in a periodic box; scaled
    ones as well), ``vx vy vz`` for energies, and ``mol`` and ``mass`` unless ``data`` is given.  Atoms may be in any
    order.  ``dump_modify ... format float %.17g`` keeps all digits.

    * ``data``: LAMMPS data file with masses and molecules
    * ``body``: column with the ID of an atom's body (0: in none), such as ``i_body``
    * ``potential``: column with energies of atoms, such as ``c_energy``
    * ``timestep``: LAMMPS' time step; not needed if the dump has times
    * ``atom_style``: columns of the data file in MDAnalysis' notation, such as "id type x y z", if its atom style is not
      full or molecular

    Raises DumpError if a column is missing, or if a data file cannot be read or its types or masses differ from
    the dump.

    >>> from gearquat_analysis import open_dump
    >>> universe = open_dump("nitrogen.dump")
    >>> len(universe.trajectory), len(universe.atoms), len(universe.residues)
    (801, 128, 64)
    >>> universe.trajectory[0].data["x"].dtype
    dtype('float64')
    """
    columns = columns_of(path)
    extra = [name for name in dict.fromkeys((body, "mass", "type", "q")) if name in columns]
    potentials = [potential] if potential else []
    reader = DumpFrames(str(path), additional_columns=extra + potentials, dt=timestep)
    known = reader.pop_columns(extra)
    if data is not None:
        masses, bodies, types = _from_data_file(data, atom_style, reader.ids, body == "mol" and body not in known)
        if np.char.isdigit(types.astype(str)).all():  # not labels
            _check_same(f"{data}: type", types.astype(int), known.get("type"), reader.ids)
        _check_same(f"{data}: mass", masses, known.get("mass"), reader.ids)
    else:
        masses, bodies, types = known.get("mass"), None, np.ones(reader.n_atoms, int)
    if masses is None:
        raise DumpError(f"{path}: no column mass; dump it, or give a data file (--data)")
    if body not in known and (bodies is None or body != "mol"):
        raise DumpError(
            f"{path}: no column {body}, which has the IDs of bodies: dump it, name another column"
            " (--body), or give a data file with molecules (--data)"
        )
    bodies = known.get(body, bodies).astype(int)
    types = known["type"].astype(int) if "type" in known else types
    return _universe(reader, bodies, masses, types, known.get("q"))
