"""Bodies and their sites: masses, shapes, principal axes."""

import numpy as np

#: a principal moment below this fraction of the largest counts as zero, as in the fix
LINEAR_FRACTION = 1.0e-7
#: a site nearer to a plane than this fraction of the body's size is on neither side, as in the fix
ON_AXIS = 1.0e-6
#: principal moments that differ by less than this fraction of the largest count as equal.  With six digits, the sites of a
#: molecule are uncertain by about 1e-4 of its size, and its axes by about 1e-4 over the relative difference of moments
EQUAL = 1.0e-3
#: directions in a plane, and in space (the diagonals of an icosahedron), over which P1 or P2 has the same mean as over all
#: directions
PLANE = np.column_stack([np.cos(np.pi / 3.0 * np.arange(3)), np.sin(np.pi / 3.0 * np.arange(3))])
_GOLDEN = (1.0 + np.sqrt(5.0)) / 2.0
SPACE = np.array([np.roll([0.0, 1.0, sign * _GOLDEN], k) for k in range(3) for sign in (1, -1)]) / np.hypot(1.0, _GOLDEN)


def places(ids, wanted):
    """Index (m,) of each of the ``wanted`` (m,) among ``ids`` (n,), which are integers; -1 if it is not among them."""
    order = np.argsort(ids)
    nearest = np.append(order, -1)[np.searchsorted(ids, wanted, sorter=order)]
    return np.where(np.append(ids, -1)[nearest] == wanted, nearest, -1)


def equal_moments(moments):
    """True (B, 3, 3) where principal moments k and l of a body are equal; ``moments`` (B, 3), the largest first.

    Axes with equal moments are arbitrary: two equal moments allow any axes in a plane, three any axes in space.

    >>> from gearquat_analysis.bodies import equal_moments
    >>> equal_moments([[3.0, 2.0001, 2.0]])[0].astype(int).tolist()
    [[1, 0, 0], [0, 1, 1], [0, 1, 1]]
    """
    moments = np.asarray(moments, dtype=float)
    near = moments[:, :2] - moments[:, 1:] <= EQUAL * moments[:, :1]
    equal = np.zeros((len(moments), 3, 3), dtype=bool)
    equal[:, [0, 1, 2], [0, 1, 2]] = True
    for k, l, both in ((0, 1, near[:, 0]), (1, 2, near[:, 1]), (0, 2, near.all(axis=1))):
        equal[:, k, l] = equal[:, l, k] = both
    return equal


def axis_groups(moments):
    """Principal axes, counted from 0, in tuples; axes of a tuple have equal moments in all bodies; ``moments`` (B, 3)."""
    equal = equal_moments(moments).all(axis=0)
    return sorted({tuple(np.flatnonzero(row).tolist()) for row in equal})


def axes_named(axes):
    """ "axis 3" of (2,), "axes 2 and 3" of (1, 2), "axes 1, 2 and 3" of (0, 1, 2)."""
    *first, last = (str(k + 1) for k in axes)
    return f"axes {', '.join(first)} and {last}" if first else f"axis {last}"


def directions(moments, axes, k):
    """Unit vectors (N, B, 3) in the body frame over which P1 or P2 is averaged for principal axis ``k`` (0 to 2).

    ``moments`` (B, 3) and ``axes`` (B, 3, 3) as in Bodies.  N is 1 if the axis is unique in all bodies.  If its moment is
    equal to others in some bodies, the vectors represent all directions in the plane (or space) of their axes.
    """
    equal = equal_moments(moments)[:, k]
    count = equal.sum(axis=1)
    number = {1: 1, 2: len(PLANE), 3: len(SPACE)}[count.max(initial=1)]
    parts = np.zeros((number, len(count), 3))
    parts[:, count == 1, k] = 1.0
    pairs = np.flatnonzero(count == 2)
    both = np.nonzero(equal[pairs])[1].reshape(-1, 2)
    parts[:, pairs[:, None], both] = np.resize(PLANE, (number, 2))[:, None]
    if number == len(SPACE):
        parts[:, count == 3] = SPACE[:, None]
    return np.einsum("nbk,bkj->nbj", parts, axes)


class Bodies:
    """B bodies of n sites, each with a reference shape.

    * ``ids`` (B,): IDs of the bodies
    * ``index`` (n,): indices of the sites among the atoms, body by body, ascending within a body
    * ``of`` (n,): the number of each site's body
    * ``masses`` (n,) of the sites, ``mass`` (B,) of the bodies
    * ``shape`` (n, 3): sites in the body frame, relative to the center of mass
    * ``moments`` (B, 3): principal moments of inertia of the sites as points, the largest first, vanishing ones exactly 0
    * ``axes`` (B, 3, 3): principal axes as rows, in the body frame
    * ``point``, ``linear`` (B,): True for a point, and for a linear body

    Units are the units of the run; moments have mass x length squared.

    >>> from gearquat_analysis import Poses, open_dump
    >>> bodies = Poses(open_dump("nitrogen.dump").atoms).bodies
    >>> len(bodies), bool(bodies.linear.all()), bodies.shape.shape
    (64, True, (128, 3))
    """

    def __init__(self, numbers, masses):
        """``numbers`` (n,): ID of each atom's body, 0 for none; ``masses`` (n,)."""
        numbers, masses = np.asarray(numbers), np.asarray(masses, dtype=float)
        order = np.argsort(numbers, kind="stable")
        self.index = order[numbers[order] != 0]
        if not len(self.index):
            raise ValueError("no atom is in a body: the ID of the body is 0 for all of them")
        self.ids, self._starts, self.counts = np.unique(numbers[self.index], return_index=True, return_counts=True)
        self.of = np.repeat(np.arange(len(self.ids)), self.counts)
        self.masses = masses[self.index]
        self.mass = self.sum(self.masses)
        bad = self.ids[~(self.mass > 0.0)]
        if len(bad):
            raise ValueError(f"body {bad[0]} has no mass; the masses of its atoms must add up to more than zero")

    def __len__(self):
        return len(self.ids)

    def sum(self, values):
        """Sum of values (n, ...) over the sites of each body, (B, ...)."""
        return np.add.reduceat(values, self._starts, axis=0)

    def largest(self, values):
        """Largest of values (n,) in each body, (B,)."""
        return np.maximum.reduceat(values, self._starts)

    def center(self, vectors):
        """Mass-weighted mean (B, 3) of vectors (n, 3)."""
        # relative to the first site, so that no digits are lost far from the origin
        first = vectors[self._starts]
        rest = self.sum(self.masses[:, None] * (vectors - first[self.of]))
        return first + rest / self.mass[:, None]

    def whole(self, positions, box, periodic=(True, True, True)):
        """Positions (n, 3) at the image nearest to the first site of their body.

        ``box`` (3, 3): edges as rows.  Correct for bodies smaller than half the box.
        """
        away = positions - positions[self._starts][self.of]
        images = np.round(away @ np.linalg.inv(box)) * np.asarray(periodic)
        return positions - images @ box

    def set_shape(self, positions, principal=False):
        """Set the shape from the sites at ``positions`` (n, 3); the body frame has the axes of the positions.

        ``principal``: the body frame has the principal axes, sorted and directed as in the fix, so that quaternions agree
        with the fix's array, except for bodies with equal moments, whose axes are arbitrary.
        """
        arms = positions - self.center(positions)[self.of]
        square = np.einsum("ij,ij->i", arms, arms)
        tensor = square[:, None, None] * np.eye(3) - arms[:, :, None] * arms[:, None, :]
        moments, axes = np.linalg.eigh(self.sum(self.masses[:, None, None] * tensor))
        moments, axes = moments[:, ::-1], np.swapaxes(axes, 1, 2)[:, ::-1].copy()
        moments[self.counts == 1] = 0.0
        moments[moments <= LINEAR_FRACTION * moments[:, :1]] = 0.0
        self.moments = moments
        self.point = moments[:, 0] == 0.0
        self.linear = ~self.point & (moments[:, 2] == 0.0)
        axes[np.linalg.det(axes) < 0.0, 1] *= -1.0  # right-handed
        axes[self.point] = np.eye(3)
        if principal:
            for b, begin in enumerate(self._starts):
                own = slice(begin, begin + self.counts[b])
                _direct(axes[b], arms[own], self.masses[own])
            axes[self.point] = np.eye(3)
            arms = np.einsum("nij,nj->ni", axes[self.of], arms)
            axes = np.broadcast_to(np.eye(3), axes.shape).copy()
        self.shape, self.axes = arms, axes

    def divided_by_inertia(self, q, vectors):
        """Vectors (B, 3) in space divided by the inertia tensor of bodies turned by q (B, 4).

        The component about an axis without inertia is 0.
        """
        axes = self.axes_space(q)
        along = np.einsum("bij,bj->bi", axes, vectors)
        divided = np.divide(along, self.moments, out=np.zeros_like(along), where=self.moments > 0.0)
        return np.einsum("bij,bi->bj", axes, divided)

    def axes_space(self, q):
        """Principal axes (B, 3, 3) as rows, in space, of bodies turned by q (B, 4)."""
        # imported here because it takes long, and processes that only need masses and shapes start for every trial
        from scipy.spatial.transform import Rotation

        turn = Rotation.from_quat(q, scalar_first=True).as_matrix()
        return np.einsum("bij,bkj->bki", turn, self.axes)


def _direct(axes, arms, masses):
    """Choose the directions of the principal axes (3, 3) of one body, in place, from its sites (see the fix's manual).

    The first and the third axis point to the side of the heaviest site that is off the plane perpendicular to the axis
    (of equally heavy sites, the first).  The second axis completes a right-handed frame.  If all sites are in the plane
    perpendicular to the first or the third axis, the second axis is directed by sites, and that axis completes the
    frame.
    """
    along = arms @ axes.T
    size = np.abs(along).max()

    def direct(k):
        sided = np.abs(along[:, k]) >= ON_AXIS * size
        if size == 0.0 or not sided.any():
            return False
        heaviest = np.argmax(np.where(sided, masses, -1.0))
        if along[heaviest, k] < 0.0:
            axes[k] = -axes[k]
        return True

    first, third = direct(0), direct(2)
    last = 1 if first == third else 2 if first else 0
    if last != 1:
        direct(1)
    axes[last] = np.cross(axes[(last + 1) % 3], axes[(last + 2) % 3])
