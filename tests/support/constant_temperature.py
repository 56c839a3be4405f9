"""Bodies with a thermostat, and comparisons used by several tests."""

import re

from support.scenes import BEFORE, MOLECULES, one_after_the_other, placed

KINDS = ["total", "separate"]
TEMP = "temp 0.5 0.5 0.3"
END = "write_dump all custom {}.end id x y z vx vy vz modify sort id format float %.17g"
#: twice the kinetic energy of the common motion of all atoms
COMMON = "variable common equal mass(all)*(vcm(all,x)^2+vcm(all,y)^2+vcm(all,z)^2)\n"
COLUMNS = "econserve ecouple f_move f_move[9] f_move[10] f_move[11] f_move[12] f_move[13] f_move[14]"


def cluster(words, dt=0.004, time=0.8, run=None, every=None, style="", **settings):
    steps = round(time / dt)
    settings = dict(box="-60 60 -60 60 -60 60", boundary="p p p", columns=COLUMNS) | settings
    fix = f"gear/quat molecule {words}" if "rigid" not in words else words
    text = placed(
        settings.pop("bodies", MOLECULES),
        before=BEFORE + style,
        fix=fix,
        dt=dt,
        thermo=every or max(1, steps // 8),
        run=run or f"run {steps}",
        **settings,
    )
    return text.replace("fix_modify move energy yes", "")


def run(lmp, decks, ranks=1):
    return lmp.succeed(one_after_the_other(decks), ranks=ranks)


def continued(deck, file):
    """The deck with its atoms and potential from a restart file."""
    rest = re.sub("velocity all create.*", "", deck[deck.index("neigh_") :])
    return f"units lj\natom_modify sort 0 0.0\nread_restart {file}\n{rest}"
