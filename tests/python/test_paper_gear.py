"""The fix with the choices of the paper compared with the paper's equations in plain numpy.

Unprojected, the motion depends on how the principal axes are labeled (see paper_gear.py).  LAMMPS does not know the
labeling of the paper, so the fix has to agree with one of the 24 labelings, to rounding.
"""

import numpy as np
import pytest
from support.paper_gear import FRAMES, PaperGear, eq_8

DT, STEPS = 0.125, 40


def test_rotation_does_not_depend_on_the_frame_while_q_is_of_length_one():
    """All 24 start from the same sites."""
    sites = []
    for turn in FRAMES:
        gear = PaperGear("consistent", 1, DT, turn)
        sites.append(gear.sites @ eq_8(gear.q))
    assert len(sites) == 24
    assert all(each == pytest.approx(sites[0], abs=1e-12) for each in sites)


@pytest.mark.parametrize("body", ["consistent", "unrotated"])
@pytest.mark.parametrize(
    "formulation, momentum",
    [("first", "predicted"), ("first", "corrected"), ("second", "predicted")],
)
def test_fix_moves_as_the_paper(run_case, body, formulation, momentum):
    keywords = "preset paper" + f" momentum {momentum}" * (formulation == "first")
    variables = {"body": body, "keywords": keywords, "formulation": formulation}
    found = run_case(1, dt=DT, steps=STEPS, every=STEPS, **variables).center[-1]

    def distances(h):
        gears = [PaperGear(body, 1, h, turn, momentum == "predicted") for turn in FRAMES]
        return [np.linalg.norm(found - getattr(gear, formulation)(STEPS)) for gear in gears]

    of_frames = distances(DT)
    assert min(of_frames) < 1e-11
    assert formulation == "first" or max(of_frames) > 1e-9  # the frame does matter
