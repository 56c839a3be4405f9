"""Triangles of a data file in bodies: LAMMPS' frame for the corners of such a triangle is not principal, because its
moments are computed about the origin of the box. Inertia and motion must not depend on this frame."""

from __future__ import annotations

import numpy as np
import pytest
from support.extended_atoms import Atom, assert_inertia, body_deck, center, deck, equivalent_points, words
from support.scenes import last_frame, last_numbers
from scipy.spatial.transform import Rotation

OMEGA = np.array([0.7, -0.4, 1.1])
#: corners of two triangles without symmetry, in space, relative to SHIFTS; mass per area
CORNERS = np.array(
    [
        [(0.9, 0.1, -0.3), (2.6, 0.4, 0.2), (1.3, 1.9, 0.6)],
        [(-0.4, 0.8, 0.1), (0.3, 2.2, 1.4), (0.2, 0.7, 1.9)],
    ]
)
DENSITIES = 1.3, 0.4
#: a point at rest in its body, by which springs act on the body
HANDLE = Atom((0.0, 0.0, 0.0), 1.0)
SHIFTS = {"near": np.zeros(3), "far": np.array([6.0, -4.0, 3.0])}
AT = pytest.mark.parametrize("shift", SHIFTS.values(), ids=SHIFTS)
TABLE = "fix out all ave/time 1 1 1 f_move[*] mode vector file table format ' %.17g'"
SPRING = "group handle id 3\nfix pull handle spring/self 3.0\n"


def sites(shift=SHIFTS["near"], corners=CORNERS):
    """The triangles, and the handle. Midpoints of edges, with equal weights, give the exact tensor of a triangle."""
    found = []
    for own, density in zip(corners + shift, DENSITIES):
        mass = density * np.linalg.norm(np.cross(own[1] - own[0], own[2] - own[0])) / 2
        arms = (own + np.roll(own, 1, axis=0)) / 2 - own.mean(axis=0)
        tensor = mass / 3 * sum(arm @ arm * np.eye(3) - np.outer(arm, arm) for arm in arms)
        moments, turn = np.linalg.eigh(tensor)
        turn[:, 2] *= np.linalg.det(turn)
        found.append(Atom(tuple(own.mean(axis=0)), mass, moments=tuple(moments), turn=turn))
    return [*found, Atom(tuple(HANDLE.x + shift), HANDLE.mass)]


def from_data(lmp, shift, corners=CORNERS, **settings):
    """A deck of one body of the triangles and the handle, with angular velocity OMEGA; writes its data file."""
    atoms = sites(shift, corners)
    low, high = settings.setdefault("box", "-20 20 -20 20 -20 20").split()[:2]
    sections = [
        "triangles\n\n2 atoms\n2 triangles\n1 atom types",
        "\n".join(f"{low} {high} {axis}lo {axis}hi" for axis in "xyz"),
        "Atoms",
        "\n".join(f"{n} 0 1 1 {words(d, *a.x)}" for n, (a, d) in enumerate(zip(atoms, DENSITIES), 1)),
        "Triangles",
        "\n".join(f"{n} {words(*own.ravel())}" for n, own in enumerate(corners + shift, 1)),
    ]
    (lmp.folder / "data.triangles").write_text("\n\n".join(sections) + "\n")
    lines = [
        f"read_data data.triangles add append\ncreate_atoms 1 single {words(*atoms[2].x)}",
        f"set atom 3 diameter 0\nset atom 3 mass {words(atoms[2].mass)}",
    ]
    for i, a in enumerate(atoms, 1):
        vx, vy, vz = np.cross(OMEGA, a.x - center(atoms))
        lines.append(f"set atom {i} vx {words(vx)} vy {words(vy)} vz {words(vz)}")
        if any(a.moments):
            lines.append(f"set atom {i} angmom {words(*(a.inertia @ OMEGA))}")
    return deck("tri", "\n".join(lines), **settings)


def end(lmp, text, ranks=1):
    """The last frame of a run: ID, position, velocity, angular momentum, two corners."""
    lmp.succeed(text, ranks=ranks)
    return last_frame(lmp.folder / "poses.dump")


@AT
def test_inertia_and_angular_momentum_are_those_of_the_triangles(lmp_tree, shift):
    """In a rigid motion the body has the angular velocity of its triangles only if the tensors are correct."""
    result = lmp_tree.succeed(from_data(lmp_tree, shift, run="run 0", after=TABLE))
    atoms, row = sites(shift), last_numbers(lmp_tree.folder / "table", 28)
    assert_inertia(atoms, 0, result.thermo[0]["f_move[2]"][0], row, OMEGA)


@AT
def test_the_motion_is_that_of_equivalent_points(lmp_tree, shift, formulation):
    """A spring acts on the handle, so its motion depends on the whole tensor."""
    settings = dict(fix=f"single formulation {formulation}", after=SPRING)
    sized = end(lmp_tree, from_data(lmp_tree, shift, **settings))[-1, 1:7]

    def of_points(factor):
        """With the handle first, and its mass multiplied by the factor."""
        triangle, other, handle = sites(shift)
        points = [*equivalent_points(triangle), *equivalent_points(other)]
        atoms = [Atom(handle.x, factor * handle.mass), *points]
        spring = SPRING.replace("id 3", "id 1")
        text = body_deck("tri", atoms, OMEGA, fix=settings["fix"], after=spring)
        return end(lmp_tree, text)[0, 1:7]

    assert np.abs(sized - of_points(1.0)).max() < 1e-10


@AT
def test_corners_and_angular_momenta_follow_the_body(lmp_tree, shift):
    found = end(lmp_tree, from_data(lmp_tree, shift, after=SPRING + TABLE, steps=300, dt=0.01))
    row = last_numbers(lmp_tree.folder / "table", 28)
    atoms = sites(shift)
    begin = np.array([a.x for a in atoms])
    turn = Rotation.align_vectors(found[:2, 1:4] - found[2, 1:4], begin[:2] - begin[2])[0].as_matrix()
    assert np.abs(turn - np.eye(3)).max() > 0.3
    omega_space = Rotation.from_quat(row[15:19], scalar_first=True).apply(row[19:22])
    for atom, own, one in zip(atoms, CORNERS + shift, found):
        arms = one[10:16].reshape(2, 3) - one[1:4]
        expected = (own[:2] - own.mean(axis=0)) @ turn.T
        assert np.abs(arms - expected).max() < 1e-12
        momentum = turn @ atom.inertia @ turn.T @ omega_space
        assert one[7:10] == pytest.approx(momentum, abs=1e-12)


def test_a_body_continues_from_run_to_run(lmp_tree):
    """Triangles match their records, whose frame is not LAMMPS' frame, unless they were changed."""
    for command in ("", "set atom 1 quat 1 0 0 30"):
        text = from_data(lmp_tree, SHIFTS["far"], steps=5, after=SPRING, run=f"run 5\n{command}\nrun 5")
        assert ("atoms were changed since the last run" in lmp_tree.succeed(text).log) == bool(command)


#: an equilateral triangle has no preferred axes in its plane
EQUILATERAL = np.array([CORNERS[0], [(0.0, 1.0, 1.0), (1.0, 0.0, 1.0), (1.0, 1.0, 0.0)]])


@pytest.mark.parametrize("corners, ranks", [(CORNERS, 1), (EQUILATERAL, 2)], ids=["scalene", "equilateral"])
def test_restart_is_exact(lmp_tree, corners, ranks, formulation):
    fix = f"single formulation {formulation}"
    halves = "run 20\nwrite_restart half\nrun 20"
    whole = from_data(lmp_tree, SHIFTS["far"], corners, fix=fix, after=SPRING, steps=40, run=halves)
    straight = end(lmp_tree, whole, ranks)
    head, _, rest = whole.partition("fix move")
    pair = head[head.index("pair_style") :]
    again = "atom_modify map array sort 0 0.0\nread_restart half\n" + pair + "fix move" + rest
    assert (end(lmp_tree, again.replace(halves, "run 20"), ranks) == straight).all()


def test_ranks(lmp_tree):
    """The same motion on 1, 2 and 4 ranks, with triangles that migrate."""
    before = "\nvelocity all set 0.9 0.6 0.8 sum yes\ncomm_modify vel yes cutoff 6"
    box = dict(boundary="p p p", box="-5 5 -5 5 -5 5")
    text = from_data(lmp_tree, SHIFTS["near"], steps=1500, dt=0.01, before=before, columns="ix iy iz", **box)
    ends = [end(lmp_tree, text, ranks) for ranks in (1, 2, 4)]
    for other in ends:
        assert (other[:, -3:] != 0).all()  # all atoms have crossed the boundary
        assert np.abs(other - ends[0]).max() < 1e-10
