"""What is run: liquids, forces, methods, steps, durations.

Another liquid needs an entry of LIQUIDS, its files ``liquid.KEY`` and ``molecule.KEY``, and a Scene.
"""

from dataclasses import dataclass

from benchmarks.engine.methods import DEFAULT_PASSES, DEFAULTS, GEARS, gear, rigid

NVE_SMALL = rigid("rigid/nve/small", "rigid")
SMALL = rigid("rigid/small", "rigid_verlet")
SECOND, FIRST = DEFAULTS["second"], DEFAULTS["first"]
#: what the manual recommends for liquids at long steps
LONG_STEPS = gear("second", 7, passes=DEFAULT_PASSES)
#: how the page calls them
NAMES = {
    SECOND: "second formulation, default",
    FIRST: "first formulation, default",
    LONG_STEPS: "second formulation, `values 7`",
    GEARS["second"]: "second formulation, Gear's coefficients",
    NVE_SMALL: f"`{NVE_SMALL.label}`",
    SMALL: f"`{SMALL.label}`",
}
METHODS, ALL_METHODS = (SECOND, LONG_STEPS, FIRST, NVE_SMALL), tuple(NAMES)

CUTOFF = 9.0
PLAIN, CHECKED = f"lj/cut/coul/long {CUTOFF:g}", "every 1 delay 0 check yes"
TIP4P = f"lj/cut/tip4p/long 1 2 1 1 0.1546 {CUTOFF:g}"
#: the Lennard-Jones energy goes to zero between two distances
SWITCHED = f"lj/charmm/coul/long 7 {CUTOFF:g}"


def power(accuracy):
    """A power of ten as people write it: 1e-5."""
    return f"{accuracy:.0e}".replace("e-0", "e-")


@dataclass(frozen=True)
class Forces:
    """How forces are computed, in the words of LAMMPS' commands; see in.liquid.  ``skin`` in Angstrom."""

    pair: str = PLAIN
    modify: str = "shift yes"
    kspace: str = "pppm"
    accuracy: float = 1e-5
    order: int = 5
    skin: float = 2.0
    neighbors: str = CHECKED

    @property
    def variables(self):
        """Variables of in.liquid."""
        words = {"pair": self.pair, "modify": self.modify, "order": self.order, "skin": self.skin}
        return words | {"kspace": f"{self.kspace} {power(self.accuracy)}", "neighbors": self.neighbors}

    @property
    def lines(self):
        """What a user writes, where it is not LAMMPS' default."""
        lines = [f"pair_style {self.pair}", f"kspace_style {self.kspace} {power(self.accuracy)}"]
        if self.modify != "shift no":
            lines.insert(1, f"pair_modify {self.modify}")
        if self.order != 5:
            lines.append(f"kspace_modify order {self.order}")
        if self.neighbors != CHECKED:
            lines += [f"neighbor {self.skin:g} bin", f"neigh_modify {self.neighbors}"]
        return lines

    @property
    def text(self):
        """The lines in one."""
        return "; ".join(self.lines)


@dataclass(frozen=True)
class Liquid:
    """A liquid of ``edge``^3 rigid molecules at a ``density`` in g/cm^3 and a ``temperature`` in K.

    ``mass`` of a molecule in g/mol; ``axes``: about how many it rotates; ``pair``, ``kspace``: words of
    LAMMPS.  Its runs have ``steps`` in fs and samples every ``interval`` fs, a multiple of all of them.
    """

    key: str
    title: str
    edge: int
    density: float
    temperature: float
    mass: float
    axes: int = 3
    pair: str = PLAIN
    kspace: str = "pppm"
    steps: tuple = (1.0, 2.0, 2.5, 3.0)
    interval: float = 30.0

    @property
    def molecules(self):
        """Their number."""
        return self.edge**3

    @property
    def freedoms(self):
        """Degrees of freedom of translation, without total momentum, and of rotation."""
        return 3 * self.molecules - 3, self.axes * self.molecules


_SLOW = {"steps": (2.0, 4.0, 6.0, 8.0), "interval": 24.0}
SPCE = Liquid("spce", "SPC/E water", 6, 0.997, 298.15, 18.0154)
WATER4 = Liquid(
    "tip4p", "TIP4P/2005 water", 6, 0.997, 298.15, 18.0154, pair=TIP4P, kspace="pppm/tip4p"
)
CO2 = Liquid("co2", "TraPPE carbon dioxide", 6, 1.046, 250.0, 44.0098, axes=2, **_SLOW)
BENZENE = Liquid("benzene", "OPLS-AA benzene", 4, 0.876, 298.15, 78.114, **_SLOW)
LIQUIDS = (SPCE, WATER4, CO2, BENZENE)


@dataclass(frozen=True)
class Scene:
    """A liquid with forces, followed by ``methods`` at the steps of the liquid."""

    key: str
    liquid: Liquid
    accuracy: float = 1e-5
    methods: tuple = METHODS

    @property
    def forces(self):
        """Forces of the scene."""
        return Forces(self.liquid.pair, kspace=self.liquid.kspace, accuracy=self.accuracy)

    @property
    def title(self):
        """A heading."""
        return f"{self.liquid.title}, {self.liquid.kspace} {power(self.accuracy)}"


MAIN = Scene("spce", SPCE, methods=ALL_METHODS)
SCENES = (
    MAIN,
    Scene("spce_coarse", SPCE, 1e-4),
    Scene("spce_fine", SPCE, 1e-6),
    Scene("tip4p", WATER4),
    Scene("co2", CO2),
    Scene("benzene", BENZENE),
)

#: what limits accuracy, with SPC/E water at a step in fs that is short enough to see it
FLOOR_STEP = 0.5
ACCURACIES = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
#: words of a curve -> forces at each accuracy; a finer mesh would not lower the floor of the first one
FAMILIES = {
    "plain cut-off": [Forces(modify="shift no", accuracy=a) for a in ACCURACIES[:-1]],
    "energy shifted": [Forces(accuracy=a) for a in ACCURACIES],
    "energy switched": [Forces(SWITCHED, "shift no", accuracy=a) for a in ACCURACIES],
}
#: further settings, each a change of a fine one above
SINGLE = (
    Forces(SWITCHED, "table 0", accuracy=1e-7),
    Forces(f"{PLAIN} 12", accuracy=1e-6),
    Forces(accuracy=1e-6, order=7),
    Forces(kspace="ewald", accuracy=1e-6),
    Forces(accuracy=1e-6, skin=1.0, neighbors="every 40 delay 0 check no"),
)
#: Forces -> methods that are run with them
FLOORS = {f: (SECOND,) for family in FAMILIES.values() for f in family}
FLOORS |= {f: (SECOND, NVE_SMALL) for f in (*FAMILIES["energy shifted"], *SINGLE)}


@dataclass(frozen=True)
class Plan:
    """Durations: those of the main scene, the others and the floor in ps, steps of equilibration."""

    main: float = 20.0
    others: float = 5.0
    floor: float = 2.0
    equilibration: int = 10_000

    def duration(self, scene):
        """Duration of the runs of a scene, fs."""
        return 1000 * (self.main if scene is MAIN else self.others)


QUICK = Plan(main=0.6, others=0.6, floor=0.6, equilibration=500)
