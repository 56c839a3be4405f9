"""The two bodies of a deck, and one flight of them in LAMMPS.

Lengths, times and energies are in the units of the deck, angular momenta in mass x length^2 / time.  In arrays of
both bodies, the body with the smaller ID comes first.  Poses are rotations of the pose that
a body has in the deck.
"""

import os
import re
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from gearquat_analysis.bodies import Bodies
from gearquat_analysis.superposition import superpose
from gearquat_analysis.units import UNITS

from ..trials import process
from ..trials.interpreter import Interpreter
from ..trials.script import DeckError

#: a flight begins and ends this factor beyond the range of the forces: several first steps, because the derivatives at
#: the start do not include a force that sets in within the step
MARGIN = 1.05
#: limits of the first step: fraction of the distance to the encounter, and angle in radians
FIRST_STEP, FIRST_TURN = 0.01, 0.05
#: parts of the sum of all forces that count as rounding, if the force on a body should be zero
ROUNDING = 1e-12
#: keywords of the fix for positions of bodies and forces on them, which the command sets itself, and for thermostats
REFUSED_KEYWORDS = ("infile", "mol", "force", "torque", "temp")
#: fixes that neither move atoms nor exert forces
IDLE = re.compile(r"property/atom|store/.*|dt/reset")
#: properties of atoms that turn with a body and that a flight would have to place
EXTENDED = ("radius", "mu", "ellipsoid", "line", "tri", "body")
UNTURNED = (1.0, 0.0, 0.0, 0.0)
#: steps between two looks at the distance of the bodies
STEPS = 15
#: number of poses, number of distances and highest energy of the envelope of the potential
POSES, DISTANCES, HIGHEST = 4, 200, 1e100
_CUTOFF = re.compile(r"master list distance cutoff = (\S+)")


@dataclass(frozen=True)
class Start:
    """Both bodies: ``center`` and ``velocity`` (2, 3), ``quaternion`` (2, 4), scalar first, from the pose in
    the deck, and ``momentum`` (2, 3), angular momenta about the centers of the bodies, along the axes of space."""

    center: np.ndarray
    velocity: np.ndarray
    quaternion: np.ndarray
    momentum: np.ndarray


@dataclass(frozen=True)
class End(Start):
    """The bodies after a flight, and a summary of the flight.

    ``time`` since the start; number of ``steps``.  ``fate`` is "parted", or "unparted" after the allowed number of
    steps, or "lost" if LAMMPS ended the flight with ``message``.
    """

    time: float
    steps: int
    fate: str = "parted"
    message: str = ""


def cross(a, b):
    """Vector products (..., 3); NumPy's function takes several times as long for so few vectors."""
    first, second = [1, 2, 0], [2, 0, 1]
    return a[..., first] * b[..., second] - a[..., second] * b[..., first]


class Pair:
    """Two rigid bodies of a deck in a LAMMPS of this process.

    ``bodies``, a Bodies in the body frame of the deck; ``cutoff``, the largest distance at which two
    sites act on each other; ``extent`` (2,), the largest distance of a site from its center; ``reach``, the distance
    of the centers at which flights begin and end. ``units``, a row of UNITS, and ``style``, its name;
    ``freedoms`` (2,), of rotation; ``turning``, whether bodies have more than one site; ``charge`` (2,) if atoms
    have one, else None.

    ``variables``, ``without``, ``which`` and ``say`` as in ``trials.measure.Deck``.  Use it in a with statement.  Raises
    DeckError.
    """

    def __init__(self, path, variables=(), without=(), which=None, say=lambda text: None):
        self.path = Path(path).resolve()
        self.variables = [tuple(map(str, variable)) for variable in variables]
        self.without, self.which, self.say = tuple(without), which, say
        self.lammps = None
        self._open()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        """End LAMMPS."""
        if self.lammps:
            self.lammps.close()
        self.lammps = None

    # --- the deck -------------------------------------------------------------------------------
    def _open(self):
        """Read the deck, in its own folder, and leave LAMMPS ready for flights."""
        here = os.getcwd()
        with tempfile.TemporaryDirectory(prefix="gearquat-") as folder:
            try:
                log = Path(folder) / "log"
                self.lammps = process.open_lammps(self.path, self.variables, log)
                follower = Interpreter(self.lammps, Path(folder), self.without, self.which, self.variables, self.say)
                start = follower.follow(self.path.name)
                self._check(start)
                self._bodies()
                self._prepare(log)
                self._check_forces()
            except BaseException:
                self.close()
                raise
            finally:
                os.chdir(here)

    def _check(self, start):
        """Refuse decks in which anything else acts on the two bodies; sets ``line``, the line of the fix that moves
        them."""
        movers = [command.mover for command in start.commands if command.mover]
        if len(movers) != 1 or movers[0].style != "gear/quat":
            found = ", ".join(f"{line.id} {line.style}" for line in movers)
            raise DeckError(f"one fix gear/quat that moves both bodies is required, and no other; the deck has {found}")
        line = movers[0]
        given = dict(line.keywords)
        who = f"fix {line.id} {line.style}"
        if "tolerance" not in given:
            raise DeckError(
                f"{who}: keyword tolerance is required, such as 'tolerance 1e-9 energy': only with it does the step"
                " follow an encounter"
            )
        for key in REFUSED_KEYWORDS:
            if key in given:
                raise DeckError(
                    f"{who}: keyword {key} has to be left out: the command places the bodies, and nothing else acts on them"
                )
        for id_, style in start.fixes.items():
            if id_ != line.id and not IDLE.fullmatch(style):
                raise DeckError(
                    f"fix {id_} {style} acts beside the two bodies: the pair has to be alone; --without {id_} leaves it out"
                )
        if not start.pair_style or start.pair_style[0] == "none":
            raise DeckError("the deck has no forces between atoms: a pair style with a cutoff is required")
        self._check_box()
        self.line = line

    def _check_box(self):
        lammps = self.lammps
        if lammps.extract_setting("dimension") != 3:
            raise DeckError("dimension 3 is required")
        if any(lammps.extract_box()[5]):
            raise DeckError("the box is periodic: boundary s s s is required, so that bodies meet once and part")
        extended = [name for name in EXTENDED if lammps.extract_atom(name)]
        if extended:
            raise DeckError(
                f"atoms with the property {extended[0]}: atoms have to be points; a molecule can have several of them"
            )

    def _bodies(self):
        """Set ``bodies`` and the members derived from them."""
        lammps = self.lammps
        labels = process.body_labels(lammps, [self.line])
        if (labels[:, 0] < 0).any():
            outside = (labels[:, 0] < 0).sum()
            raise DeckError(f"{outside} atoms are in no body of fix {self.line.id}: the two bodies have to be alone")
        values = np.unique(labels[:, 1])
        if len(values) != 2:
            raise DeckError(f"two bodies are required: fix {self.line.id} has {len(values)}")
        self.bodies = Bodies(np.searchsorted(values, labels[:, 1]) + 1, process.of_atoms(lammps, "mass"))
        bodies, self._tags = (self.bodies, lammps.numpy.extract_atom("id")[: len(labels)].copy())
        positions = lammps.numpy.extract_atom("x")[bodies.index].copy()
        bodies.set_shape(positions)
        self.extent = bodies.largest(np.linalg.norm(bodies.shape, axis=1))
        self.reduced_mass = float(np.prod(bodies.mass) / bodies.mass.sum())
        self.freedoms = np.where(bodies.point, 0, np.where(bodies.linear, 2, 3))
        self.turning = len(bodies.index) > 2
        self.style = lammps.extract_global("units")
        self.units = UNITS[self.style]
        charges = lammps.numpy.extract_atom("q")
        self.charge = None if charges is None else bodies.sum(charges[bodies.index])
        types = lammps.numpy.extract_atom("type")
        self._kinds = np.column_stack([types if charges is None else charges, types])[bodies.index]
        self.weights = np.zeros((2, len(bodies.index)))
        self.weights[bodies.of, bodies.index] = bodies.masses / bodies.mass[bodies.of]

    @property
    def identical(self):
        """True if both bodies are the same, so that the pair represents a gas of one species."""
        mass, moments = self.bodies.mass, self.bodies.moments
        first, second = (sorted(self._kinds[self.bodies.of == k].tolist()) for k in range(2))
        same = np.allclose(mass[0], mass[1], rtol=1e-9) and np.allclose(moments[0], moments[1], rtol=1e-6)
        return bool(same) and first == second

    def _prepare(self, log):
        """Sets ``cutoff`` and ``reach``, and turns off features that only cost time."""
        lammps = self.lammps
        lammps.commands_list(
            [
                "thermo 0",
                "thermo_style custom step",
                "thermo_modify lost ignore",
                "timer off",
                # neighbor lists of the styles of a hybrid would keep the skin of the first run
                "pair_modify neigh/trim no",
                "atom_modify sort 0 0.0",
                "change_box all boundary s s s",
                "neighbor 0.0 nsq",  # the skin may be many times the cutoff, as in units si
                "neigh_modify delay 0 every 1 check yes",
            ]
        )
        self._command("run 0 post no")
        lammps.command("log none")
        *_, listed = _CUTOFF.findall(log.read_text(encoding="utf-8", errors="replace"))
        self.cutoff = float(listed)
        self.reach = MARGIN * (self.cutoff + self.extent.sum())
        # neighbor lists are never rebuilt, because they contain all pairs of sites
        lammps.command(f"neighbor {6.0 * self.reach:.17g} nsq")
        self._command_of_fix = replace(
            self.line, keywords=(*(pair for pair in self.line.keywords if pair[0] != "report"), ("report", ("no",)))
        ).text()

    def _command(self, text):
        """Pass a command to LAMMPS, whose errors become a DeckError."""
        try:
            self.lammps.command(text)
        except Exception as error:  # the only exception class that LAMMPS' module raises
            raise DeckError(f"LAMMPS refuses '{text}': {str(error).split(chr(10) + 'Last input line')[0]}") from error

    def _check_forces(self):
        """Refuse forces that act where a flight begins."""
        turns = Rotation.random(16, random_state=np.random.default_rng(1)).as_quat(scalar_first=True)
        apart = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, self.reach]])
        for pair in turns.reshape(8, 2, 4):
            self._place(Start(apart, np.zeros((2, 3)), pair, np.zeros((2, 3))))
            self._command("run 0 post no")
            forces = self.lammps.numpy.extract_atom("f")[self.bodies.index]
            on_bodies = np.abs(self.bodies.sum(forces)).max()
            if on_bodies > ROUNDING * np.abs(forces).sum():
                raise DeckError(
                    f"forces do not vanish: {on_bodies:.3g} acts on a body at a distance of {self.reach:.6g}, beyond"
                    f" the cutoff of {self.cutoff:.6g}; a pair style with a cutoff is required, and nothing else may act"
                )

    def envelope(self):
        """Distances (n,), falling, and the largest potential energy (n,) beyond each of bodies at rest: the root of the
        mean square over poses."""
        turns = Rotation.random(2 * POSES, random_state=np.random.default_rng(2)).as_quat(scalar_first=True)
        distances, still, squares = (np.linspace(self.reach, 0.0, DISTANCES, endpoint=False), np.zeros((2, 3)), 0.0)
        for pose in turns.reshape(POSES, 2, 4):
            energies = []
            for distance in distances:
                self._place(Start(np.array([[0.0, 0.0, 0.0], [0.0, 0.0, distance]]), still, pose, still))
                self._command("run 0 post no")
                energies.append(self.lammps.extract_compute("thermo_pe", 0, 0))
            energies = np.abs(np.array(energies) - energies[0])
            squares = squares + np.maximum.accumulate(np.nan_to_num(energies, nan=np.inf)).clip(max=HIGHEST) ** 2
        if not squares[-1]:
            raise DeckError(
                "the bodies exert no forces on each other: a pair style whose coefficients are not zero is required"
            )
        return distances, np.sqrt(squares / POSES)

    # --- flights ----------------------------------------------------------------------------------
    def turned(self, quaternion, vectors):
        """Vectors (n, 3) of sites, turned by the quaternion (2, 4) of their body."""
        turns = Rotation.from_quat(quaternion, scalar_first=True).as_matrix()
        return np.einsum("nij,nj->ni", turns[self.bodies.of], vectors)

    def _place(self, state):
        """Place the sites as in a Start; returns angular velocities (2, 3) along the axes of space."""
        bodies, omega = self.bodies, np.zeros((2, 3))
        positions, velocities = (self.lammps.numpy.extract_atom(name) for name in "xv")
        positions[bodies.index] = state.center[bodies.of]
        velocities[bodies.index] = state.velocity[bodies.of]
        if self.turning:
            arms = self.turned(state.quaternion, bodies.shape)
            omega = bodies.divided_by_inertia(state.quaternion, state.momentum)
            positions[bodies.index] += arms
            velocities[bodies.index] += cross(omega[bodies.of], arms)
        return omega

    def _first_step(self, state, omega):
        """Length of the first step, which the fix shortens if necessary."""
        speed = np.linalg.norm(state.velocity[1] - state.velocity[0])
        turning = np.linalg.norm(omega, axis=1).max()
        return 1.0 / (speed / (FIRST_STEP * self.reach) + turning / FIRST_TURN)

    def fly(self, start, most_steps=1_000_000):
        """End of the flight from ``start``; it has parted when the bodies move apart beyond ``reach``."""
        if not self.lammps:
            self._open()
        try:
            return self._fly(start, most_steps)
        except DeckError as error:
            self.close()
            return End(start.center, start.velocity, start.quaternion, start.momentum, 0.0, 0, "lost", str(error))

    def _fly(self, start, most_steps):
        command = self.lammps.command
        command(f"unfix {self.line.id}")
        command("reset_timestep 0 time 0.0")
        omega = self._place(start)
        command(f"timestep {self._first_step(start, omega):.17g}")
        self._command(self._command_of_fix)
        run = f"run {STEPS} post no"
        positions, velocities = (self.lammps.numpy.extract_atom(name)[: len(self._tags)] for name in "xv")
        steps, beyond = 0, self.reach**2
        while True:
            self._command(run)
            steps += STEPS
            (one, two), (v_one, v_two) = (self.weights @ positions, self.weights @ velocities)
            away = two - one
            apart = away @ away >= beyond
            if apart and away @ (v_two - v_one) > 0.0 or steps >= most_steps:
                return self._end(positions, velocities, steps, bool(apart))
            run = f"run {STEPS} pre no post no"

    def _end(self, positions, velocities, steps, parted):
        """The End of the current flight."""
        bodies = self.bodies
        x, v = positions[bodies.index], velocities[bodies.index]
        center, velocity = x, v
        quaternion, momentum = np.tile(UNTURNED, (2, 1)), np.zeros((2, 3))
        if self.turning:
            center, velocity = bodies.center(x), bodies.center(v)
            arms, rest = x - center[bodies.of], v - velocity[bodies.of]
            quaternion, _ = superpose(bodies, arms)
            momentum = bodies.sum(bodies.masses[:, None] * cross(arms, rest))
        time, fate = self.lammps.get_thermo("time"), "parted" if parted else "unparted"
        return End(center, velocity, quaternion, momentum, time, steps, fate)

    def rotational_energy(self, quaternion, momentum):
        """Kinetic energy (2,) of the rotation of both bodies."""
        if not self.turning:
            return np.zeros(2)
        omega = self.bodies.divided_by_inertia(quaternion, momentum)
        return 0.5 * self.units.energy * np.einsum("ij,ij->i", omega, momentum)
