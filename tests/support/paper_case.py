"""The first case of the paper with other final commands."""

import numpy as np
from support.scenes import restarted, whole_deck

COLUMNS = ["c_centre[1]", "c_centre[2]", "c_centre[3]", "c_potential", "v_ketrans", "v_kerot"]


class Case1:
    """The paper's first case with other final commands."""

    def __init__(self, lmp, examples, formulation, ranks=1):
        self.lmp, self.ranks = lmp, ranks
        self.scene = whole_deck(examples / "case1" / "in.case1")
        self.variables = dict(formulation=formulation, dt=0.02, every=100, out="none")

    def run(self, ending, restart=None, scene=None, **variables):
        """With the steps in ``ending``, from the restart file if there is one."""
        text = (scene or self.scene).replace("run ${steps}", ending)
        if restart:
            text = restarted(text, restart)
        return self.lmp.succeed(text, {**self.variables, **variables}, self.ranks)


def end(result, run=-1):
    return np.array([result.thermo[run][column][-1] for column in COLUMNS])
