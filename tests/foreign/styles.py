"""The arguments of each fix and compute style of LAMMPS for a test in the deck of scene.py.

If `lmp -h` lists a style that is neither in FIXES or COMPUTES nor matched by NOT_TRIED, the
run fails: new styles are detected.  In arguments <N> is a number of steps; it is multiplied when the
time step is divided.
"""

import re
from dataclasses import dataclass
from functools import partial

from . import scene

#: effect of another style on atoms
PASSIVE = "passive"  # nothing
FORCE = "force"  # adds forces that depend on the present state only
CHANCE = "chance"  # draws random numbers in each step
COUNT = "count"  # acts only in certain steps, so it is compared with fix rigid at the same step
MOVES = "moves"  # changes velocities, positions or masses of bodies' atoms without informing the fix
RIGID_ONLY = "rigid only"  # recognizes a rigid fix by the beginning of its style
INTEGRATES = "integrates"  # a second fix that integrates time
BOX = "box"  # changes the box


@dataclass(frozen=True)
class Try:
    """One scene: ``kind``, arguments, group, atom style, commands before the style."""

    kind: str
    args: str = ""
    group: str = "all"
    atoms: str = "full"
    before: tuple = ()
    modify: str = ""
    #: commands that a restart does not repeat
    once: tuple = ()
    #: the reference, fix rigid, is run in parts of this number of steps (of the longest length), because it adopts
    #: velocities only at the beginning of a run
    pieces: int = 0
    #: whether its outputs are compared
    outputs: bool = True
    #: whether a rigid fix is defined before it in the reference, too
    behind: bool = False
    #: permitted difference from the reference if forces jump
    floor: float = 1e-7
    #: whether a run from a restart file is compared
    restarts: bool = True
    #: only the sum of the per-atom values has a meaning
    sums: bool = False


SPHERES = "hybrid full sphere"
CHUNKS = ("compute cc all chunk/atom molecule",)
KE = ("compute kk all ke",)
WALLS = ("change_box all boundary p p f",)
WHOLE = ("region whole block 0.1 9.5 0.1 9.5 0.1 9.5",)
NO_DIHEDRALS = ("dihedral_style none", "improper_style none")
SLAB = ("region slab block INF INF INF INF 0 3",)


def _one(kind, args="", group="all", **words):
    return (Try(kind, args, group, **words),)


passive, force, chance, count, integrates, box = (
    partial(_one, kind) for kind in (PASSIVE, FORCE, CHANCE, COUNT, INTEGRATES, BOX)
)


def force_or_none(args, none, **words):
    """A force, and the same fix with arguments that make the force zero."""
    return force(args, **words) + passive(none)


def moves(args="", free=COUNT, pieces=0, **words):
    """On all atoms, and (as another kind) only on atoms outside of bodies."""
    both = _one(MOVES, args, pieces=pieces, **words)
    return both + (_one(free, args, "free", **words) if free else ())


ENERGY = "energy yes virial yes"

FIXES = {
    # --- looks on ---
    "ave/atom": passive("<5> 2 <20> x vx"),
    "ave/chunk": passive("<10> 2 <20> cc vx density/number", before=CHUNKS),
    "ave/correlate": passive("<5> 3 <20> c_kk", before=KE),
    "ave/correlate/long": passive("<5> <20> c_kk", before=KE),
    "ave/grid": passive("<10> 2 <20> 2 2 2 vx density/number"),
    "ave/histo": passive("<10> 2 <20> -5 5 10 vx kind peratom mode vector"),
    "ave/histo/weight": passive("<10> 2 <20> -5 5 10 vx x kind peratom mode vector"),
    "ave/moments": passive("<10> 2 <20> c_kk mean", before=KE),
    "ave/time": passive("<10> 2 <20> c_kk", before=KE),
    "controller": passive(
        "<10> 1.0 0.5 0.0 0.0 c_kk 1.5 cv", before=(*KE, "variable cv internal 0.1")
    ),
    "external": passive("pf/array 1"),
    "halt": passive("<10> v_one > 5.0", before=("variable one equal 1.0",)),
    "nonaffine/displacement": passive("<10> d2min type offset <10>"),
    "numdiff": passive("<20> 0.0001"),
    "numdiff/virial": passive("<20> 0.0001"),
    "print": passive('<10> "step"'),
    "property/atom": passive("i_flag d_value ghost yes"),
    "store/force": passive(),
    "store/state": passive("0 xu yu zu vx"),
    "vector": passive("<10> c_kk", before=KE),
    "widom": passive("<10> 5 4 1234 1.0", group="free"),
    # its outputs are of ranks and rounds; a rigid fix has to be defined first
    "balance": passive("<10> 1.0 shift xyz 5 1.05", outputs=False, behind=True),
    # --- adds forces ---
    "accelerate/cos": force("0.3", group="free"),
    "adapt": force("<1> atom charge v_charge", before=("variable charge equal 0.1+0.3*time",)),
    "addforce": force_or_none(
        "0.1 0.05 v_fz energy v_e",
        "0 0 0",
        before=("variable fz atom 0.2*z", "variable e atom -0.1*x-0.05*y-0.1*z*z"),
        modify=ENERGY,
    ),
    "addtorque": force("0.1 0.2 0.1"),
    "aveforce": force("NULL 0.1 NULL"),
    "damping/cundall": force("0.05 0.05", atoms=SPHERES, floor=5e-3),
    "drag": force("1 1 1 0.5 0.1"),
    "efield": force("0.5 0.2 0.1", modify=ENERGY),
    "efield/lepton": force("0.2*z"),
    "flow/gauss": force("1 0 0", group="bodies", modify="energy yes"),
    "freeze": force(atoms=SPHERES, group="free"),
    "gravity": force("1.0 vector 0 0 -1", modify="energy yes"),
    "indent": force("2.0 sphere 5 5 5 1.5", modify="energy yes"),
    "lineforce": force("1 0 0"),
    "planeforce": force("1 0 0"),
    "propel/self": force("velocity 0.5"),
    "restrain": force("bond 1 5 0.5 0.5 1.0", modify="energy yes"),
    "rhok": force("1 1 1 0.5 0.1"),
    "setforce": force_or_none("NULL 0.0 NULL", "NULL NULL NULL"),
    "smd": force("cfor 0.2 tether NULL 10 10 0.0"),
    "spring": force("tether 1.0 5 5 5 0.1", modify="energy yes"),
    "spring/chunk": force("1.0 cc cm", before=(*CHUNKS, "compute cm all com/chunk cc")),
    "spring/rg": force("1.0 3.0"),
    "spring/self": force("2.0", modify="energy yes"),
    "ti/spring": force("100.0 <100> <5>"),
    "viscous": force_or_none("0.3", "0"),
    "viscous/sphere": force("0.3", atoms=SPHERES),
    "wall/colloid": force("zlo -1.0 1.0 1.0 2.5", atoms=SPHERES, once=WALLS),
    "wall/gran": force(
        "hooke 100.0 NULL 1.0 NULL 0.5 0 zplane 1.0 NULL", atoms=SPHERES, once=WALLS
    ),
    "wall/gran/region": force(
        "hooke 100.0 NULL 1.0 NULL 0.5 0 region slab",
        atoms=SPHERES,
        before=("region slab block -20 20 -20 20 1.0 20",),
    ),
    **{
        f"wall/{name}": force("zlo -1.0 1.0 1.0 2.5", once=WALLS, modify=ENERGY)
        for name in ("harmonic", "lj1043", "lj126", "lj93")
    },
    "wall/morse": force("zlo -1.0 1.0 1.0 1.0 2.5", once=WALLS, modify=ENERGY),
    "wall/lepton": force('zlo -1.0 "(r-2.5)^2" 2.5', once=WALLS, modify=ENERGY),
    "wall/region": force(
        "slab harmonic 1.0 1.0 2.5",
        before=("region slab sphere 5 5 5 8",),
        modify=ENERGY,
    ),
    # --- random forces ---
    "langevin": chance("1.0 1.0 1.0 1234"),
    "ttm": chance("1234 1.0 1.0 1.0 0.1 0.0 2.0 1 1 1 set 1.0"),
    # --- comes, goes, acts now and then ---
    "deposit": count("2 4 5 1234 region whole near 0.8", group="free", before=WHOLE),
    "dt/reset": count("5 0.001 0.006 0.01"),
    "evaporate": (
        Try(COUNT, "5 1 whole 1234", "free", before=WHOLE),
        Try(COUNT, "5 1 whole 1234 molecule yes", "bodies", before=WHOLE),
    ),
    # atoms are inserted, removed and moved, so forces jump; with tuned coefficients the errors last for some steps
    "gcmc": count("10 2 2 4 1234 1.0 -0.5 0.2", group="free", floor=2e-4),
    "bond/break": (Try(COUNT, "5 1 10.0"), Try(COUNT, "5 1 0.51")),
    "bond/create": count("5 4 4 0.5 1"),
    "bond/create/angle": count("5 4 4 0.5 1 aconstrain 90 120"),
    "bond/swap": count("10 0.5 1.3 1234", before=("special_bonds lj/coul 0 1 1", *NO_DIHEDRALS)),
    # --- changes velocities, places, masses ---
    "atom/swap": moves("5 5 1234 1.0 types 2 3", free=None),
    "mol/swap": moves("5 5 1 2 1234 1.0", free=None),
    "ehex": moves("1 0.1"),
    "hmc": moves("10 1234 1.0 rigid m", free=None),
    "tmd": moves("0.0 target 10 NULL", free=None),
    "wall/piston": moves("zlo pos 4.0 vel 0.1", once=("change_box all boundary p p s",), free=None),
    "neighbor/swap": moves(
        "5 5 1234 1.0 2.0 vv types 2 3",
        before=("compute vv all voronoi/atom neighbors yes",),
        free=None,
    ),
    "ffl": moves("1.0 1.0 1.0 1234", free=None),
    "heat": moves("<5> 0.1", pieces=5),
    "set": moves("10 0 type 4 vx v_less", before=("variable less atom 0.1+0*x",), free=None),
    "momentum": moves("<5> linear 1 1 1", pieces=5),
    "momentum/chunk": (Try(MOVES, "<5> cc linear 1 1 1", before=CHUNKS, pieces=5),),
    "oneway": moves("1 whole -x", before=WHOLE),
    "rattle": moves("0.0001 20 0 b 1", free=None),
    "recenter": moves("INIT INIT INIT", free=None),
    "shake": moves("0.0001 20 0 b 1", free=None),
    "temp/berendsen": moves("1 1 0.5", pieces=1),
    "temp/csld": moves("1 1 0.5 1234", free=CHANCE),
    "temp/csvr": moves("1 1 0.5 1234", free=CHANCE),
    "temp/rescale": moves("<5> 1 1 0.01 1.0", pieces=5),
    "thermal/conductivity": moves("5 z 4"),
    "viscosity": moves("5 x z 4"),
    "wall/flow": moves("x 1.0 1.0 1234 2 2.0 5.0", free=None),
    "wall/reflect": moves("zlo 4.0 zhi 9.0", once=WALLS),
    "wall/reflect/stochastic": moves("diffusive 1234 zlo 2.5 1.0 0 0 0", once=WALLS, free=CHANCE),
    # --- integrates time as well ---
    "brownian": integrates("1.0 1234 gamma_t 1.0"),
    "brownian/sphere": integrates(
        "1.0 1234 gamma_r 1.0 gamma_t 1.0", atoms="hybrid full sphere dipole"
    ),
    "gjf": integrates("1.0 1.0 1.0 1234"),
    "gld": integrates("1.0 1.0 2 1234 pprony 0.5 1.0 1.0 2.0"),
    "move": integrates("linear 0.1 0 0"),
    "nve": integrates(),
    "nve/limit": integrates("0.1"),
    "nve/noforce": integrates(),
    "nve/sphere": integrates(atoms=SPHERES),
    "nvk": integrates(),
    "nvt": integrates("temp 1 1 1"),
    "nvt/sphere": integrates("temp 1 1 1", atoms=SPHERES),
    "poems": integrates("molecule", group="bodies"),
    "tfmc": integrates("0.1 1.0 1234"),
    # --- changes the box; those that integrate time are refused on atoms of bodies ---
    "box/relax": passive("iso 0.0", behind=True),
    "deform": force("1 x erate 0.01", behind=True),
    "deform/pressure": force("1 x erate 0.01", behind=True),
    "msst": box("z 1.0 q 1 mu 1"),
    "nph": box("iso 1 1 1"),
    "npt": box("temp 1 1 1 iso 1 1 1"),
    "nph/sphere": box("iso 1 1 1", atoms=SPHERES),
    "npt/sphere": box("temp 1 1 1 iso 1 1 1", atoms=SPHERES),
    "nphug": box("temp 1 1 1 iso 1 1 1"),
    "append/atoms": box("zhi freq 10", once=("change_box all boundary p p m", "lattice sc 1.0")),
    "nvt/sllod": integrates("temp 1 1 1"),
    "press/berendsen": force("iso 1 1 1", behind=True),
    # neither its random numbers nor the velocity of its box are in restart files
    "press/langevin": chance("iso 1 1 1 temp 1 1 1234", behind=True, restarts=False),
    # --- rigid fixes ---
    **{
        f"rigid{name}{small}": found
        for small in ("", "/small")
        for name, found in (
            ("", integrates("molecule", "bodies")),
            ("/nve", integrates("molecule", "bodies")),
            ("/nvt", integrates("molecule temp 1 1 1", "bodies")),
            ("/nph", box("molecule iso 1 1 1", "bodies")),
            ("/npt", box("molecule temp 1 1 1 iso 1 1 1", "bodies")),
        )
    },
}

#: compute styles that differ only in their names
WITHOUT_ARGUMENTS = """
    ackland/atom com dipole displace/atom fragment/atom gyration hexorder/atom ke ke/atom
    momentum msd/nongauss orientorder/atom pe pe/atom temp temp/com temp/deform temp/rotate
    vacf voronoi/atom
""".split()
OF_CHUNKS = """
    angmom/chunk com/chunk dipole/chunk gyration/chunk inertia/chunk msd/chunk omega/chunk
    torque/chunk vacf/chunk vcm/chunk
""".split()
OF_SPHERES = """
    contact/atom erotate/sphere erotate/sphere/atom temp/sphere
""".split()
OF_A_GROUP = """
    force/tally group/group pe/tally stress/tally
""".split()
COMPUTES = {
    **dict.fromkeys(WITHOUT_ARGUMENTS, passive()),
    **dict.fromkeys(OF_CHUNKS, passive("cc", before=CHUNKS)),
    **dict.fromkeys(OF_SPHERES, passive(atoms=SPHERES)),
    **dict.fromkeys(OF_A_GROUP, passive("free")),
    "adf": passive("10 1 1 1 0 3 0 3"),
    "aggregate/atom": passive("1.0"),
    "angle/local": passive("theta eng"),
    "ave/sphere/atom": passive("cutoff 2.5"),
    "bond/local": passive("dist engpot force velvib omega"),
    "born/matrix": passive("numdiff 0.0001 vv", before=("compute vv all pressure NULL virial",)),
    "centro/atom": passive("12"),
    "centroid/stress/atom": tuple(
        Try(PASSIVE, args) for args in ("NULL virial", "NULL fix", "NULL")
    ),
    "chunk/atom": passive("molecule"),
    "chunk/spread/atom": passive("cc c_cm[*]", before=(*CHUNKS, "compute cm all com/chunk cc")),
    "cluster/atom": passive("1.0"),
    "cna/atom": passive("1.5"),
    "cnp/atom": passive("1.5"),
    "coord/atom": passive("cutoff 1.5"),
    "count/type": passive("atom"),
    "dihedral/local": passive("phi"),
    "efield/wolf/atom": passive("0.2"),
    "entropy/atom": passive("0.25 3.0"),
    "event/displace": passive("0.5"),
    "fabric": passive("type contact", atoms=SPHERES),
    "gaussian/grid/local": passive("grid 2 2 2 2.0 0.5 0.5 0.5 0.5 1 1 1 1"),
    "global/atom": passive(
        "c_ch c_cm[1]",
        before=(
            *CHUNKS,
            "compute ch all chunk/atom type",
            "compute cm all com/chunk cc",
        ),
    ),
    "gyration/shape": passive("gg", before=("compute gg all gyration",)),
    "gyration/shape/chunk": passive(
        "gg", before=(*CHUNKS, "compute gg all gyration/chunk cc tensor")
    ),
    "heat/flux": tuple(
        Try(
            PASSIVE,
            "ka pa sa",
            before=(
                "compute ka all ke/atom",
                "compute pa all pe/atom",
                f"compute sa all {style} NULL virial",
            ),
        )
        for style in ("stress/atom", "centroid/stress/atom")
    ),
    "heat/flux/tally": passive("all"),
    "heat/flux/virial/tally": passive("free", group="bodies"),
    "improper/local": passive("chi"),
    "msd": (Try(PASSIVE), Try(PASSIVE, "com yes")),
    "pair": passive(scene.PAIR),
    "pair/local": passive("dist eng force"),
    "pe/mol/tally": passive("all"),
    "pressure": tuple(
        Try(PASSIVE, args) for args in ("thermo_temp", "NULL virial", "NULL fix")
    ),
    "property/atom": passive("xu yu zu vx fx"),
    "property/chunk": passive(
        "cc count id", before=("compute cc all chunk/atom molecule compress yes",)
    ),
    "property/grid": passive("2 2 2 id"),
    "property/local": passive("batom1 btype"),
    "rattlers/atom": passive("type 0 3", atoms=SPHERES),
    "rdf": passive("20"),
    "reduce": passive("sum x vx fx"),
    "reduce/region": passive("slab sum vx", before=SLAB),
    "slice": passive("1 3 1 c_vv", before=("compute vv all com",)),
    "stress/atom": tuple(
        Try(PASSIVE, args, sums=True) for args in ("NULL", "NULL virial", "NULL fix")
    ),
    "stress/cartesian": passive("z 1.0 NULL 0"),
    "stress/cylinder": passive("0 9 4.0 0.5"),
    "stress/mop": passive("x 4.8 kin conf", before=NO_DIHEDRALS),
    "stress/mop/profile": passive("x 0 2.4 kin conf", before=NO_DIHEDRALS),
    "stress/spherical": passive("5 5 5 0.5 4.0"),
    "temp/chunk": passive("cc temp com yes", before=CHUNKS),
    "temp/partial": passive("1 1 0"),
    "temp/profile": passive("1 1 1 z 4"),
    "temp/ramp": passive("vx 0 1 z 0 9"),
    "temp/region": passive("slab", before=SLAB),
    "viscosity/cos": passive(before=("fix ac free accelerate/cos 0.0",)),
    "xrd": passive("1.5 C C C C 2Theta 10 100 c 4 4 4 LP 1"),
    "fep/ta": passive("1.0 xy 1.0001 tail no"),
    "erotate/rigid": _one(RIGID_ONLY, "m"),
    "ke/rigid": _one(RIGID_ONLY, "m"),
    "rigid/local": _one(RIGID_ONLY, "m x y z"),
}
#: styles that are not tried: pattern and reason
_REAX = "reads or needs a reactive or charge-equilibration force field"
_DPD = "belongs to atoms with internal energy (DPD-REACT, DPD-MESO)"
_SMD = "belongs to the atoms of smoothed particles (MACHDYN, SPH, RHEO, PERI)"
_SPIN = "belongs to atoms with spins"
_EFF = "belongs to the electron force field"
_SHAPE = "needs ellipsoids, lines, triangles or bodies, which the plug-in does not move"
_ML = "needs a machine-learned potential's coefficients"
_REPLICAS = "needs several replicas (partitions)"
_OUTSIDE = "needs another program or library"
_DATA = "needs a table, coefficients or topology of a certain material"
_ALIAS = "an old name"
_HYBRID = "needs bond styles of hybrid; reads energies only"
_DECKS = "only LAMMPS' own decks have it, as far as those were run"
NOT_TRIED = {
    "fix": (
        (r".*/(omp|kk|gpu|intel|opt)", "a variant of another package, with the same contract"),
        (r"ave/spatial.*|lb/(pc|rigid.*)|reax/c/.*|qeq/reax|pimd|rigid/meso|meso/move", _ALIAS),
        (r"(acks2|qtpie|qeq|reaxff)/.*|charge/regulation|bond/react|amoeba/.*|efield/tip4p", _REAX),
        (r"dpd/energy|eos/.*|rx|shardlow|mvv/.*|[et]dpd/.*|grem|heat/flow|add/heat", _DPD),
        (r"smd/.*|sph(/.*)?|rheo(/.*)?|nve/bpm/.*", _SMD),
        (r".*/spin|neb(/spin)?|pafi", _SPIN + ", or needs several replicas"),
        (r".*/eff", _EFF),
        (
            r".*/(asphere|body|line|tri|dot|dotc/langevin)(/.*)?|wall/body/.*|wall/(region/)?ees",
            _SHAPE,
        ),
        (r"alchemy|hyper/.*|pimd/.*|phonon", _REPLICAS),
        (r"colvars|imd|ipi|saed/vtk", _OUTSIDE),
        (r"cmap|electrode/.*|polarize/.*|electron/.*|orient/.*|ttm/.*|sgcmc|wall/table|gle", _DATA),
        (r"(.*/)?drude(/.*)?|srd|wall/srd|pour|lb/(fluid|momentum|viscous)", _DECKS),
        (r"adapt/fep", "fix adapt by another name"),
        (r"pair|tune/kspace", "reads a certain pair or kspace style, no atoms"),
        (r"enforce2d", "needs a 2d scene; only LAMMPS' own decks have it, as far as those were run"),
        (r"filter/corotate", "needs r-RESPA, and refuses rigid bodies itself"),
        (
            r"bocs|.*/uef|npt/cauchy",
            "a barostat that needs a table or a box of its own; npt is tried",
        ),
        (r"temp/rescale/eff", _EFF),
    ),
    "compute": (
        (r".*/(omp|kk|gpu|intel|opt)", "a variant of another package, with the same contract"),
        (r"angle|bond|dihedral|improper|nbond/atom|ti|fep|hma|pressure/alchemy", _HYBRID),
        (r"(.*/)?(damage|dilatation|plasticity)/atom|(smd|sph|rheo)/.*", _SMD),
        (r"(edpd|tdpd)/.*|dpd(/atom)?", _DPD),
        (r"spin|efield/atom", _SPIN + ", or to charges of certain pair styles"),
        (r".*/eff", _EFF),
        (r".*/(asphere|body)|body/local", _SHAPE),
        (r"(mliap|snap|sna.*|podd?/.*|slcsa/atom|gaussian/grid/local)", _ML),
        (r"reaxff/atom|dipole/tip4p.*|mesont|temp/(cs|drude|uef)|pressure/uef", _DATA),
        (r"pressure/cylinder", _ALIAS),
        (r"saed", "needs a table of scattering factors; xrd is tried"),
        (
            r"basal/atom|composition/atom|reduce/chunk",
            "reads memory that it has not set, with fix rigid as well",
        ),
    ),
}


def known(kind, style):
    """The Try entries of a style; a reason (text) if it is not tried; None if it is not known."""
    reasons = (why for pattern, why in NOT_TRIED[kind] if re.fullmatch(pattern, style))
    return {"fix": FIXES, "compute": COMPUTES}[kind].get(style) or next(reasons, None)


def scaled(text, divide):
    """Text with every <N> replaced by N times ``divide``."""
    return re.sub(r"<(\d+)>", lambda found: str(int(found[1]) * divide), text)
