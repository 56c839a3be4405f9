"""The flow of commands of an input script, followed up to the run that moves its rigid bodies.

Only commands that decide which command comes next are executed here: include, jump, label, next, if, run.  LAMMPS
handles everything else, including variables: every other command is passed on to ``lammps`` with its variables
substituted.  Commands that only write or print are left out, except for restart and data files that the deck reads
again.  The commands passed on are kept, so that they can be replayed without any control flow.
"""

import re
from collections import deque
from dataclasses import dataclass, field
from pathlib import Path

from . import script
from .script import DeckError

#: commands that only write, print or time
SILENT = set("""dump dump_modify undump restart write_dump write_coeff
    thermo log echo info print timer bond_write angle_write dihedral_write
    pair_write processors balance label""".split())
SILENT_FIXES = ("ave/", "print", "vector", "halt", "balance")
SILENT_COMPUTES = ("ke/rigid", "erotate/rigid", "rigid/local")
#: commands other than runs that move atoms
OTHER_MOTION = set("""rerun temper temper/grem temper/npt neb neb/spin tad prd hyper mdi
    dynamical_matrix third_order partition""".split())
#: commands that do not depend on the positions of atoms
BLIND = set("""next variable timestep thermo_style thermo_modify neighbor neigh_modify comm_modify
    suffix package shell label jump unfix uncompute""".split())
#: commands that change or end a fix or compute, and the prefix of its ID in the set of omitted IDs
CHANGES = {"fix_modify": "f_", "unfix": "f_", "compute_modify": "c_", "uncompute": "c_"}
#: keywords of thermo_modify that decide whether a run continues
RUNS_ON = ("temp", "press", "lost", "lost/bond")
MARK = "gearquat_branch"


@dataclass
class Command:
    """A command passed on to LAMMPS.

    ``mover`` is the FixLine if it defines a fix that moves bodies, and ``in_use`` whether later
    commands needed that very fix; ``modifies`` is the ID of such a fix in a fix_modify command.
    If the command moves atoms, ``state`` is the prefix of the files with the state after it, which is
    ``superseded`` if the next command that moves atoms comes before any that uses this state.
    """

    text: str
    mover: script.FixLine = None
    in_use: bool = False
    modifies: str = ""
    state: str = ""
    superseded: bool = False


@dataclass
class LeadIn:
    """The state of a deck at the run that moves its bodies.

    ``commands`` lead there; commands with a ``mover`` define the fixes that move bodies now.  ``steps`` is the length
    of the run; ``fixes`` maps IDs to styles; ``box`` is the index of the command that makes the box; ``lost`` holds
    the thermo_modify settings for lost atoms and bonds; ``checkpoints`` is True if a replay can continue from saved
    states.
    """

    commands: list = field(default_factory=list)
    steps: int = 0
    fixes: dict = field(default_factory=dict)
    pair_style: list = field(default_factory=list)
    box: int = 0
    lost: list = field(default_factory=list)
    notes: list = field(default_factory=list)
    checkpoints: bool = False

    @property
    def movers(self):
        """FixLines of the fixes that move bodies."""
        return [command.mover for command in self.commands if command.mover]


#: references to a variable in the text of a deck
_NAMES = re.compile(r"\bvariable\s+(\w+)|\$\{(\w+)\}|\$(\w)|\bv_(\w+)")
#: without any of these words a deck cannot define a fix that moves rigid bodies
_HOPE = re.compile(r"rigid|gear/quat|\binclude\b|\bjump\s+(?!SELF)")
#: commands that may cause a further run
_LATER = re.compile(r"^\s*(run|include|jump)\b")


class _Reached(Exception):
    """Raised when the run has been reached."""


class _Quit(Exception):
    """Raised when the deck has ended itself."""


class Interpreter:
    """Follows one deck.  ``lammps`` needs the methods command, expand and has_id.

    ``folder`` is for files that the deck writes; ``say`` is called before slow commands.

    ``without`` are the IDs of fixes to leave out; ``which`` counts the runs that move bodies, None is
    the first that can be measured; ``variables`` are those that LAMMPS was given, tuples (name, value, ...).
    """

    def __init__(self, lammps, folder, without=(), which=None, variables=(), say=print):
        self.lammps, self.folder, self.say = lammps, Path(folder), say
        self.without, self.variables = set(without), {name for name, *_ in variables}
        self.hope = any(_HOPE.search(value) for _, *values in variables for value in values)
        self.which, self.runs = which, 0
        self.names = set()  # of variables, in the files read so far
        self.start = LeadIn()
        self.movers = {}  # ID -> Command
        self.silenced = set()  # fixes and computes that were left out, as f_ID and c_ID
        self.written = set()  # names of files
        self.seen = set()
        self.files = []
        self.label = None
        self.skip_jump = False
        self.save = lambda prefix: None  # called with the names of checkpoints
        self.moved = None  # the last Command that moved atoms, unless its state has been saved

    def follow(self, path):
        """LeadIn of the deck ``path``, relative to the current folder.  Raises DeckError."""
        quits = ""
        try:
            self._file(path)
        except _Reached:
            self._check_options()
            return self.start
        except _Quit:
            quits = " before it quits"
        self._check_options()
        if self.runs:
            runs = f"{self.runs} run" + "s" * (self.runs > 1)
            raise DeckError(f"--run {self.which}: the deck moves rigid bodies in {runs} only{quits}")
        raise self._no_movers(quits)

    def _no_movers(self, quits=""):
        return DeckError(
            f"no fix that moves rigid bodies is in use at any run of this deck{quits}: it needs fix"
            f" gear/quat or one of fix {', '.join(script.RIGID)}, and a run of one step or more"
        )

    def _check_options(self):
        """Refuse options with names that the deck does not contain."""
        fixes, variables = sorted(self.without - self.seen), sorted(self.variables - self.names)
        if fixes:
            raise DeckError(f"--without: no fix {', '.join(fixes)} in the deck up to its run")
        if variables:
            known = ", ".join(sorted(self.names)) or "none"
            raise DeckError(f"--var: no variable {', '.join(variables)} in the deck up to its run; it has {known}")

    # --- which command comes next -----------------------------------------------------------------
    def _file(self, path):
        self.files.append(self._open(path))
        while True:
            lines = self.files[-1][1]
            if not lines:
                break
            self.execute(lines.popleft())
        if self.label:
            raise DeckError(f"label {self.label} was not found in {self.files[-1][0]}")
        self.files.pop()

    def _open(self, path):
        try:
            text = Path(path).read_text(encoding="utf-8", errors="replace")
        except OSError as error:
            raise DeckError(f"cannot read {path}: {error.strerror}") from error
        path = str(Path(path).absolute())  # the deck may change the folder
        lines = script.logical_lines(text)
        for line in lines:
            command = script.strip_comment(line)
            self.names |= {name for names in _NAMES.findall(command) for name in names if name}
            self.hope = self.hope or bool(_HOPE.search(command))
        return path, deque(lines)

    def execute(self, line):
        line = script.strip_comment(line)
        if self.label:
            words = script.split(line)
            if words[:1] == ["label"] and words[1:2] == [self.label]:
                self.label = None
            return
        if (line.split() or [""])[0] in SILENT:  # commands that only print
            return
        line = self._lammps("expand", line) if line.strip() else None
        words = script.split(line or "")  # None if nothing is left
        if not words:
            return
        name = words[0]
        handler = getattr(self, "_do_" + name, None)
        left_out = CHANGES.get(name, "") + "".join(words[1:2])
        if name in CHANGES and left_out in self.silenced:
            self.silenced -= {left_out} if name.startswith("un") else set()
        elif handler:
            handler(words, line)
        elif name in OTHER_MOTION:
            raise DeckError(f"the deck uses the command {name}; only run can be measured")
        elif name not in SILENT:
            self._pass(line)

    def _lammps(self, method, line, shown=None):
        """LAMMPS' result for a line; ``shown`` describes the line in the message if LAMMPS refuses it."""
        try:
            return getattr(self.lammps, method)(line)
        except Exception as error:  # the only class LAMMPS' module raises
            text, said = " ".join((shown or line).split()), str(error).split("\nLast input line")[0]
            raise DeckError(f"LAMMPS refuses the command\n  {text}\n  {said}") from error

    def _pass(self, line, **facts):
        if line.split()[0] not in BLIND:
            self._save()
        self._lammps("command", line)
        self.start.commands.append(Command(line, **facts))

    def _pass_and_move(self, line):
        if self.moved:
            self.moved.superseded = True
        self._lammps("command", line)
        self.moved = Command(line)
        self.start.commands.append(self.moved)

    def _save(self):
        """Save the state after the last run, unless it is already saved."""
        if self.moved:
            self.moved.state = f"state{len(self.start.commands)}"
            self.save(self.moved.state)
            self.start.checkpoints, self.moved = True, None

    def _do_include(self, words, line):
        self._file(self._lammps("expand", words[1]))

    def _do_jump(self, words, line):
        if self.skip_jump:
            self.skip_jump = False
            return
        self.files[-1] = self._open(self.files[-1][0] if words[1] == "SELF" else words[1])
        self.label = words[2] if len(words) > 2 else None

    def _do_next(self, words, line):
        self._pass(line)
        self.skip_jump = not self.lammps.has_id("variable", words[1])

    def _do_if(self, words, line):
        for condition, commands in script.branches(words):
            if condition is None or self._holds(condition):
                for command in commands:
                    self.execute(command)
                return

    def _holds(self, condition):
        self.lammps.command(f"variable {MARK} string 0")
        test = f'if {script.quote(condition)} then "variable {MARK} string 1"'
        self._lammps("command", test, shown=f"if {condition}")
        return self.lammps.expand(f"${{{MARK}}}") == "1"

    def _do_quit(self, words, line):
        raise _Quit

    def _do_shell(self, words, line):
        """Run programs once; the replay repeats only commands that change this process."""
        if words[1:2] and words[1] in ("cd", "putenv"):
            self._pass(line)
        else:
            self._lammps("command", line)

    # --- what is in the scene -----------------------------------------------------------------------
    def _do_clear(self, words, line):
        for id_ in list(self.movers):
            self._retire(id_)
        self.silenced.clear()
        self.start.fixes.clear()
        self.start.pair_style = []
        self._pass(line)

    def _do_create_box(self, words, line):
        self.start.box = len(self.start.commands)
        self._pass(line)

    def _do_read_data(self, words, line):
        """Also read restart files, whether they existed before or were written by this deck."""
        own = self.folder / script.file_name(words[1])
        self._do_create_box(words, script.with_file(line, own) if own in self.written else line)

    _do_read_restart = _do_read_data

    def _do_write_data(self, words, line):
        """Write to a folder where a later command can find the file, not to the deck's own path."""
        own = self.folder / script.file_name(words[1])
        self.written.add(own)
        self._pass(script.with_file(line, own))

    _do_write_restart = _do_write_data

    def _do_pair_style(self, words, line):
        self.start.pair_style = words[1:]
        self._pass(line)

    def _do_fix(self, words, line):
        id_, style = words[1], words[3] if len(words) > 3 else ""
        if id_ in self.without or style.startswith(SILENT_FIXES):
            self.seen.add(id_)
            self.silenced.add("f_" + id_)
            return
        self._retire(id_)
        self._pass(line)
        if script.moves_bodies(style):
            self.movers[id_] = self.start.commands[-1]
            self.movers[id_].mover = script.parse_fix(words)
        self.start.fixes[id_] = style

    def _retire(self, id_):
        """After a fix that moved bodies is deleted, its definition is an ordinary command."""
        mover = self.movers.pop(id_, None)
        if mover:
            mover.mover = None

    def _do_compute(self, words, line):
        """A definition that depends on an omitted one is omitted as well."""
        used = {word.partition("[")[0] for word in words[3:]}
        if set(words[3:4]) & set(SILENT_COMPUTES) or used & self.silenced:
            self.silenced.add("c_" + words[1])
        else:
            self._pass(line)

    def _do_thermo_style(self, words, line):
        """Drop omitted items, items of fixes that are replaced, and variables."""
        gone = self.silenced | {"f_" + id_ for id_ in self.movers}
        kept = [w for w in words if w[:2] != "v_" and w.partition("[")[0] not in gone]
        self._pass(" ".join(kept))

    def _do_thermo_modify(self, words, line):
        """Causes that may end a run: lost atoms, and temperatures with a negative number of degrees of freedom."""
        for before, key, value in zip(words, words[1:], words[2:]):
            if key in RUNS_ON and before not in ("format", "colname"):
                self._pass(f"thermo_modify {key} {value}")
                self.start.lost += [key, value] if key.startswith("lost") else []

    def _do_fix_modify(self, words, line):
        self._pass(line, modifies=words[1] if words[1] in self.movers else "")
        if words[1] in self.movers and "early" in words:
            self.start.notes.append(
                f"fix_modify {words[1]} bodyforces early is left out: fix gear/quat takes all forces,"
                " also of fixes that come after it"
            )

    def _do_unfix(self, words, line):
        self._retire(words[1])
        self.start.fixes.pop(words[1], None)
        self._pass(line)

    def _do_velocity(self, words, line):
        """Some depend on the fix: on its bodies, or on the degrees of freedom that it removes at this time."""
        if "rigid" in words[2:] or words[2] in ("create", "scale"):
            self._use_movers()
        self._pass(line)

    def _use_movers(self):
        for mover in self.movers.values():
            mover.in_use = True

    # --- runs -----------------------------------------------------------------------------------------
    def _do_run_style(self, words, line):
        if words[1:] != ["verlet"]:
            raise DeckError(f"run_style {' '.join(words[1:])}: only verlet can be measured")
        self._pass(line)

    def _do_minimize(self, words, line):
        if self.movers:
            raise DeckError(
                "the deck minimizes the energy while a rigid fix is in use, which fix gear/quat"
                " refuses: define that fix after minimize"
            )
        self._pass_and_move(line)

    def _is_to_be_measured(self):
        """True if ``which`` selects the present run.  Raises DeckError if no run can be selected."""
        if self.which not in (None, self.runs):
            return False
        try:
            script.check_scene(self.start.fixes, self.start.pair_style)
            for command in self.movers.values():
                script.translate(command.mover)
        except DeckError:
            if self.which or not any(_LATER.search(line) for lines in self.files for line in lines[1]):
                raise
            return False
        return True

    def _do_run(self, words, line):
        if not self.hope:
            raise self._no_movers()
        now = self.lammps.extract_global("ntimestep")
        steps = script.run_steps(words, now) if self.movers else 0
        # run 0 moves nothing, but bodies take over the velocities of their atoms
        self.runs += steps > 0
        if steps > 0 and self._is_to_be_measured():
            self.start.steps = steps
            self._save()
            raise _Reached
        self._use_movers()
        self.say(f"'{' '.join(words)}' comes before the trials and is executed first")
        if words[1] != "0":
            self._pass_and_move(line)
        else:
            self._pass(line)
