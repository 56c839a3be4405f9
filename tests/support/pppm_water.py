"""A deck of SPC/E water with PPPM that equilibrates before its run, for ``gearquat cost``."""

from support.running import EXAMPLES

# Molecules begin on a lattice at 0.997 g/cm3, with random orientations; a thermostat removes the energy of the
# overlaps.
DECK = """\
units real
atom_style full
lattice sc 3.1
region box block 0 {side} 0 {side} 0 {side}
create_box 2 box
mass 1 15.9994
mass 2 1.008
molecule water {template}
create_atoms 0 box mol water 4711
pair_style lj/cut/coul/long {cutoff}
pair_coeff 1 1 0.1553 3.166
pair_coeff * 2 0.0 1.0
kspace_style pppm 1.0e-5
neighbor 2.0 bin
neigh_modify every 1 delay 0 check yes exclude molecule/intra all
velocity all create 300.0 4711
fix 1 all rigid/nvt/small molecule temp 300.0 300.0 50.0
timestep 0.5
thermo 1000
run {steps}
unfix 1
fix 1 all rigid/nve/small molecule
timestep 2.0
run 5000
"""


def write(folder, side=7, steps=5000, cutoff=8.0):
    """Path of a deck of side**3 molecules, in ``folder``, that runs ``steps`` steps before its run."""
    template = EXAMPLES / "water" / "molecule.spce"
    deck = folder / "in.pppm"
    deck.write_text(DECK.format(side=side, steps=steps, cutoff=cutoff, template=template))
    return deck
