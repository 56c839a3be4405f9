"""The same numbers from other programs: MDAnalysis, its kit waterdynamics, and freud."""

import warnings

from support import dumps
import freud
import MDAnalysis
import numpy as np
import pytest
from MDAnalysis.analysis.msd import EinsteinMSD
from MDAnalysis.coordinates.memory import MemoryReader
from scipy.spatial.transform import Rotation

from gearquat_analysis import Poses, correlations, open_dump

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    from waterdynamics.waterdynamics import WaterOrientationalRelaxation

FRAMES, BODIES = 15, 20
#: MDAnalysis and freud hold positions in single precision
SINGLE = 2e-5


def refuses_one_percent(found, expected, rel):
    assert found == pytest.approx(expected, rel=rel, abs=rel)


@pytest.fixture
def walk():
    """Centers (F, B, 3) of random walks."""
    return np.random.default_rng(4).normal(size=(FRAMES, BODIES, 3)).cumsum(axis=0)


def test_displacement_of_mdanalysis(walk):
    universe = MDAnalysis.Universe.empty(BODIES, n_residues=BODIES, atom_resindex=range(BODIES), trajectory=True)
    universe.load_new(walk, format=MemoryReader)
    peer = EinsteinMSD(universe, fft=False).run().results.timeseries
    refuses_one_percent(correlations.mean_square_displacement(walk), peer, SINGLE)


def test_displacement_of_freud(walk):
    peer = freud.msd.MSD(mode="window").compute(walk).msd
    refuses_one_percent(correlations.mean_square_displacement(walk), peer, SINGLE)


def test_orientations_of_freud():
    """Its hyperspherical harmonics of order 2 are the mean of P1 over three perpendicular axes."""
    rng = np.random.default_rng(6)
    steps = [Rotation.random(BODIES, rng)]
    for _ in range(FRAMES - 1):
        steps.append(steps[-1] * Rotation.from_rotvec(0.3 * rng.normal(size=(BODIES, 3))))
    q = np.array([turn.as_quat(scalar_first=True) for turn in steps])
    peer, harmonics = np.zeros(FRAMES), freud.order.RotationalAutocorrelation(2)
    for lag in range(FRAMES):
        values = [harmonics.compute(q[k], q[k + lag]).order for k in range(FRAMES - lag)]
        peer[lag] = np.mean(values)
    found = np.mean([correlations.orientation_correlation(q, axis) for axis in np.eye(3)], axis=0)
    assert peer[1] < 0.95
    refuses_one_percent(found, peer, SINGLE)


@pytest.mark.parametrize("order", [1, 2])
def test_orientations_of_waterdynamics(tmp_path, order):
    """The kit leaves out origins that overlap; therefore bodies turn uniformly here, so that every origin gives the
    same result."""
    motion = dumps.Motion([3] * BODIES, omega=0.1)
    poses = Poses(open_dump(dumps.write(tmp_path / "even.dump", motion, np.arange(float(FRAMES)))).atoms).run()
    peer = WaterOrientationalRelaxation(poses.atoms.universe, "all", 0, FRAMES, FRAMES // 2 - 1, order=order)
    peer.run()
    first, second, third = poses.bodies.shape.reshape(BODIES, 3, 3).swapaxes(0, 1)
    for k, vector in enumerate((second - first, second - third, (second + third) / 2 - first)):
        found = correlations.orientation_correlation(poses.results.q, vector, order)[1 : FRAMES // 2]
        refuses_one_percent(found, [values[k] for values in peer.timeseries], SINGLE)
