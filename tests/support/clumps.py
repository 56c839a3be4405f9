"""A deck with three bodies that was not written for the trials, and changes of it."""

# Three bodies of three sites in free space, in the style of LAMMPS' own examples of fix rigid, with the features of
# such decks: an include, a loop, an if, outputs, no atom map, and several runs.
DECK = """
variable style index rigid
variable soft index 0
units lj
atom_style atomic
boundary f f f
region box block -30 30 -30 30 -30 30
create_box 1 box
include in.sites
mass 1 1.0
pair_style lj/cut &
  100.0   # never cut
pair_coeff 1 1 1.0 1.0
variable k loop 3
label next
  group clump$k id $(3*v_k-2):$(3*v_k)
  neigh_modify exclude group clump$k clump$k
next k
jump SELF next
velocity all create 0.5 4711 loop geom
if "${soft} > 0 && a != b" then &
  "fix 0 all nve" "timestep 0.0001" "run 10" "unfix 0" &
else 'print "no soft start # here"'
fix 1 all ${style} group 3 clump1 clump2 clump3
fix average all ave/time 1 10 10 c_thermo_temp file average.txt
fix_modify 1 virial yes
compute kinetic all erotate/rigid 1
dump 1 all atom 10 dump.clumps
restart 100 clumps.restart
thermo_style custom step temp f_1 c_kinetic
thermo 10
{extra}
timestep 0.004
run 0
run 500
run 1000000
"""
SITES = """
create_atoms 1 single 0.0 0.0 0.0
create_atoms 1 single 1.0 0.1 0.0
create_atoms 1 single 0.3 0.9 0.2
create_atoms 1 single 0.1 0.2 1.8
create_atoms 1 single 1.0 0.4 2.1
create_atoms 1 single 0.2 1.2 2.3
create_atoms 1 single 2.6 0.3 0.4
create_atoms 1 single 3.1 1.2 0.6
create_atoms 1 single 2.8 0.5 1.5
"""


#: changes with which the deck contains fix gear/quat
FOR_GEAR = {"atom_style atomic": "atom_style atomic\natom_modify map yes", " c_kinetic": ""}
FOR_GEAR |= {"compute kinetic all erotate/rigid 1": ""}
FIX = "fix 1 all ${style} group 3 clump1 clump2 clump3"


def write(folder, extra="", **changes):
    """Path of the deck in ``folder``, with commands before its run and changes old=new."""
    text = DECK.replace("{extra}", extra)
    for old, new in changes.items():
        assert old in text
        text = text.replace(old, new)
    (folder / "in.sites").write_text(SITES)
    (folder / "in.clumps").write_text(text)
    return folder / "in.clumps"
