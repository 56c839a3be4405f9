"""Liquids, forces, methods, steps and durations of the runs.

Another liquid needs an entry in LIQUIDS, its files ``liquid.KEY`` and ``molecule.KEY``, and a Scene.
"""

from dataclasses import dataclass

from scipy.constants import Avogadro

from benchmarks.engine.methods import AUTOMATIC, gear, rigid

NVE_SMALL = rigid("rigid/nve/small", "rigid")
DEFAULT = AUTOMATIC
#: number of values -> the method with this keyword
VALUES = {n: gear("momentum", n) for n in (5, 7, 9)}
#: names on the page
NAMES = {
    DEFAULT: "`fix gear/quat`",
    **{method: f"`fix gear/quat`, `values {n}`" for n, method in VALUES.items()},
    NVE_SMALL: f"`{NVE_SMALL.label}`",
}
METHODS = tuple(NAMES)

CUTOFF = 9.0
PLAIN, CHECKED = f"lj/cut/coul/long {CUTOFF:g}", "every 1 delay 0 check yes"
TIP4P = f"lj/cut/tip4p/long 1 2 1 1 0.1546 {CUTOFF:g}"
#: the Lennard-Jones energy is switched to zero between two distances
SWITCHED = f"lj/charmm/coul/long 7 {CUTOFF:g}"


def power(accuracy):
    """A power of ten as text: 1e-5."""
    return f"{accuracy:.0e}".replace("e-0", "e-")


@dataclass(frozen=True)
class Forces:
    """Settings of the forces as arguments of LAMMPS' commands; see in.liquid.  ``skin`` in Angstrom."""

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
        """The lines of an input script that differ from LAMMPS' defaults."""
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
        """The lines joined to one."""
        return "; ".join(self.lines)


#: steps in fs; the last one shows whether bodies are lost
STEPS = (2.0, 2.5, 3.0, 4.0, 5.0)
#: steps at which drifts are predicted, and steps at which temperatures are compared
FORESEEN, TEMPERED = (2.0, 3.0, 4.0), (2.0, 2.5, 3.0)
#: time between samples in fs, a multiple of all steps; and the same for the short step of the floor
INTERVAL, FLOOR_INTERVAL = 60.0, 10.0


@dataclass(frozen=True)
class Liquid:
    """A liquid of ``edge``^3 rigid molecules at a ``density`` in g/cm^3 and a ``temperature`` in K.

    ``mass`` of a molecule in g/mol; ``types``: number of atom types; ``axes``: number of axes of rotation; ``pair``,
    ``kspace``: LAMMPS' styles; ``accuracy`` of kspace.
    """

    key: str
    title: str
    edge: int
    density: float
    temperature: float
    mass: float
    types: int = 2
    axes: int = 3
    pair: str = PLAIN
    kspace: str = "pppm"
    accuracy: float = 1e-5

    @property
    def molecules(self):
        """Their number."""
        return self.edge**3

    @property
    def length(self):
        """Edge of the box in Angstrom."""
        return (self.molecules * self.mass / (self.density * 1e-24 * Avogadro)) ** (1 / 3)

    @property
    def freedoms(self):
        """Degrees of freedom of translation (without the total momentum) and of rotation."""
        return 3 * self.molecules - 3, self.axes * self.molecules


SPCE = Liquid("spce", "SPC/E water", 6, 0.997, 298.15, 18.0154)
WATER4 = Liquid(
    "tip4p", "TIP4P/2005 water", 5, 0.997, 298.15, 18.0154, pair=TIP4P, kspace="pppm/tip4p"
)
CO2 = Liquid("co2", "TraPPE carbon dioxide", 5, 1.046, 250.0, 44.0098, axes=2)
# small charges: with pppm 1e-5 their real-space part is so large at the cut-off that energies jump there
BENZENE = Liquid("benzene", "OPLS-AA benzene", 4, 0.876, 298.15, 78.114, accuracy=1e-6)
NITROGEN = Liquid("nitrogen", "TraPPE nitrogen", 5, 0.807, 77.0, 28.0134, axes=2)
METHANOL = Liquid("methanol", "TraPPE-UA methanol", 5, 0.787, 298.15, 32.0419, types=3)
LIQUIDS = (SPCE, WATER4, CO2, BENZENE, NITROGEN, METHANOL)
WATERS = (SPCE, WATER4)


@dataclass(frozen=True)
class Extent:
    """Extent of the runs of a method: its ``steps`` in fs; ``many``: from all starts and for the full time."""

    steps: tuple = STEPS
    many: bool = True


@dataclass(frozen=True)
class Scene:
    """A liquid and the methods that simulate it, Method -> Extent; ``inertia``: factor of the moments of inertia.

    ``pairs``: steps in fs at which DEFAULT writes radial distribution functions.
    """

    key: str
    liquid: Liquid
    methods: dict
    inertia: float = 1.0
    pairs: tuple = ()

    @property
    def forces(self):
        """Forces of the scene."""
        liquid = self.liquid
        return Forces(liquid.pair, kspace=liquid.kspace, accuracy=liquid.accuracy)

    @property
    def title(self):
        """A heading."""
        return f"{self.liquid.title}, {self.liquid.kspace} {power(self.forces.accuracy)}"


#: step in fs, with the moments of the model, for comparison with heavier bodies
NORMAL_STEP = 2.0


def _scene(liquid):
    methods = {DEFAULT: Extent(many=liquid in WATERS), NVE_SMALL: Extent(many=liquid is SPCE)}
    methods |= {method: Extent(FORESEEN, many=False) for method in VALUES.values()}
    pairs = (NORMAL_STEP,) if liquid is SPCE else ()
    return Scene(liquid.key, liquid, {method: methods[method] for method in METHODS}, pairs=pairs)


SCENES = tuple(map(_scene, LIQUIDS))
MAIN = SCENES[0]
#: factor of the moments of inertia, with the same masses
HEAVIER = 4.0
HEAVY_STEPS = (3.0, 4.0, 5.0)
HEAVY = Scene("heavy", SPCE, {DEFAULT: Extent(HEAVY_STEPS)}, HEAVIER, HEAVY_STEPS)

#: limits from the forces: SPC/E water with a step in fs that is short enough to show them
FLOOR_STEP = 0.5
ACCURACIES = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
#: label of a curve -> forces at each accuracy; a finer mesh would not improve the first one
FAMILIES = {
    "plain cut-off": [Forces(modify="shift no", accuracy=a) for a in ACCURACIES[:-1]],
    "energy shifted": [Forces(accuracy=a) for a in ACCURACIES],
    "energy switched": [Forces(SWITCHED, "shift no", accuracy=a) for a in ACCURACIES],
}
#: further settings, each with one change of an accurate setting above
SINGLE = (
    Forces(SWITCHED, "table 0", accuracy=1e-7),
    Forces(f"{PLAIN} 12", accuracy=1e-6),
    Forces(accuracy=1e-6, order=7),
    Forces(kspace="ewald", accuracy=1e-6),
    Forces(accuracy=1e-6, skin=1.0, neighbors="every 40 delay 0 check no"),
)
#: Forces -> methods that run with them
FLOORS = {f: (DEFAULT,) for family in FAMILIES.values() for f in family}
FLOORS |= {f: (DEFAULT, NVE_SMALL) for f in (*FAMILIES["energy shifted"], *SINGLE)}


@dataclass(frozen=True)
class Plan:
    """Sizes of the runs: numbers of starts, durations in ps, steps of equilibration.

    * ``starts``, ``duration``: for an Extent with ``many``
    * ``few``, ``short``: for the others
    * ``temperatures``: duration in MAIN, with ``many``, at the steps at which temperatures are compared
    * ``floor``: duration for the limits from the forces
    * ``spectrum``: duration for the spectrum of a liquid
    * ``shrinking``: steps until a liquid has its density, before the equilibration
    """

    starts: int = 5
    few: int = 3
    duration: float = 20.0
    temperatures: float = 20.0
    short: float = 5.0
    floor: float = 1.0
    spectrum: float = 4.1
    equilibration: int = 5000
    shrinking: int = 4000

    def extent(self, scene, method, dt):
        """Number of starts, and duration in fs."""
        if not scene.methods[method].many:
            return self.few, 1000 * self.short
        long = scene.key == MAIN.key and dt in TEMPERED
        return self.starts, 1000 * (self.temperatures if long else self.duration)


QUICK = Plan(1, 1, 1.26, 1.26, 1.26, 0.3, 1.1, equilibration=500, shrinking=1000)
#: for temperatures within half a kelvin
FULL = Plan(temperatures=200.0)
