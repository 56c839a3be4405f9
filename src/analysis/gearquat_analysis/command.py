"""The command ``gearquat analyze``, also ``python -m gearquat_analysis`` where there is no LAMMPS."""

import warnings
from contextlib import contextmanager

import cloup
from tqdm import tqdm

from .options import COUNT, FILE, POSITIVE, command, failing_clearly, out_option
from .units import UNITS


#: files that the command writes in addition to poses.npy
LEAVES = ("bodies.csv", "totals.csv", "totals.png", "poses.csv", "correlations.csv", "correlations.png")
LEAVES += ("averages.csv", "averages.png", "spectra.csv")
#: options that determine the results; a folder with results is identified by them
DECIDE = ("data", "atom_style", "body", "select", "reference", "potential", "units", "timestep")


def _frames(_context, _option, text):
    """START:STOP:STEP as a slice."""
    try:
        return slice(*(int(part) if part else None for part in (text or ":").split(":")))
    except (TypeError, ValueError) as error:
        raise cloup.BadParameter("START:STOP:STEP is required, such as ::10") from error


@contextmanager
def _telling_warnings():
    """Decorator that prints warnings as lines of the command."""
    with warnings.catch_warnings():
        warnings.showwarning = lambda message, *_: cloup.echo(f"Warning: {message}", err=True)
        yield


@command(
    "cd examples/water",
    "lmp -in in.water -var dump 10",
    "gearquat analyze out.water.dump --units real --timestep 1.0",
)
@cloup.argument("dump", type=FILE, help="Trajectory written by LAMMPS.")
@cloup.option_group(
    "Atoms and bodies",
    cloup.option("--body", default="mol", help="Column with the ID of the body; atoms with 0 are in none."),
    cloup.option(
        "--select",
        default="all",
        show_default=False,
        help="Atoms to analyze, in the selection language of MDAnalysis, such as 'resid 1-500'.",
    ),
    cloup.option(
        "--reference",
        default="principal",
        help="Frame of the body: 'principal', as in the fix; 'first', its first pose; or a file with x"
        " y z of the selected atoms by ID.",
    ),
    cloup.option("--data", type=FILE, help="Data file with masses and molecules, if not in the dump."),
    cloup.option(
        "--atom-style",
        help="Columns of the data file, such as 'id type x y z', if its atom style is not full or molecular.",
    ),
    cloup.option("--potential", help="Column with potential energies of atoms."),
)
@cloup.option_group(
    "Units and times",
    cloup.option(
        "--units",
        type=cloup.Choice(UNITS),
        help="LAMMPS' units, for energies; not needed if the dump has them (dump_modify units yes).",
    ),
    cloup.option(
        "--timestep",
        type=POSITIVE,
        help="LAMMPS' time step, not needed if the dump has times (dump_modify time yes).  Without either,"
        " tables have numbers of steps instead of times.",
    ),
    cloup.option("--frames", callback=_frames, metavar="START:STOP:STEP", help="Frames to read."),
)
@cloup.option_group(
    "Output and processes",
    out_option("gearquat-analyze", "tables and pictures"),
    cloup.option("--csv", "as_csv", is_flag=True, help="Also write every pose as text, poses.csv."),
    cloup.option("--jobs", type=COUNT, default=1, metavar="N", help="Number of processes that read the dump."),
)
@failing_clearly(ValueError)
@_telling_warnings()
def analyze(dump, out, frames, as_csv, **options):
    """Analyze rigid bodies in a LAMMPS dump.

    DUMP is a 'dump custom' with id, mol, mass, positions (xu yu zu) and velocities.  The command writes poses.npy (poses
    and energies, by frame and body), bodies.csv, totals.csv, correlations.csv, and averages.csv: temperatures, diffusion
    and rotational correlation times with standard errors, which it also prints.  It draws pictures of the last three
    files.
    """
    from . import pictures, report
    from .folder import Folder

    asked = {name: options[name] for name in DECIDE}
    asked["frames"] = [frames.start, frames.stop, frames.step]
    folder = Folder(out, dump, asked, LEAVES)
    poses = _run(dump, out, frames, options)
    folder.fill(cloup.echo)
    report.write_bodies(out / "bodies.csv", poses)
    totals = report.write_totals(out / "totals.csv", poses)
    pictures.draw_totals(poses, totals, out / "totals.png")
    if as_csv:
        poses.to_csv(out / "poses.csv", _bar("writing poses.csv", "frame"))
    _correlate(out, poses)
    cloup.echo(report.summary(poses, totals))
    cloup.echo(f"Tables and pictures are in {out.resolve()}")


def _bar(what, unit):
    return lambda iterable, total=None: tqdm(iterable, total=total, desc=what, unit=unit, disable=None)


def _tell_times(trajectory, timestep):
    """Report an unused --timestep and missing times."""
    if trajectory.timed and timestep is not None:
        cloup.echo("The dump has times of its own; --timestep is not used.")
    if not trajectory.timed and timestep is None:
        cloup.echo("Neither the dump nor --timestep gives times: numbers of steps are used instead.")


def _points(option, path, others=""):
    """The rows (n, 3) of the file that an option names; ``others`` lists the other values of the option, for the message."""
    import numpy as np

    try:
        points = np.loadtxt(path, ndmin=2)
        if points.shape[1] != 3:
            raise ValueError(f"it has {points.shape[1]} columns")
        return points
    except (OSError, ValueError) as error:
        required = f"{others}a file with x y z in each line is required"
        raise ValueError(f"{option} {path}: {required}: {error}") from error


def _run(dump, out, frames, options):
    from MDAnalysis.exceptions import SelectionError

    from . import Poses, open_dump

    names = ("data", "atom_style", "body", "potential")
    universe = open_dump(dump, timestep=options["timestep"], **{name: options[name] for name in names})
    _tell_times(universe.trajectory, options["timestep"])
    try:
        atoms = universe.select_atoms(options["select"])
    except SelectionError as error:
        raise ValueError(f"--select '{options['select']}': {error}") from error
    if not len(atoms):
        raise ValueError(f"--select '{options['select']}' selects no atom")
    out.mkdir(parents=True, exist_ok=True)
    draft = out / "poses.part.npy"
    reference = options["reference"]
    if reference not in ("principal", "first"):
        reference = _points("--reference", reference, "'principal', 'first' or ")
    poses = Poses(atoms, reference, potential=options["potential"], units=options["units"], out=draft)
    try:
        _read(poses, frames, options["jobs"])
        draft.replace(out / "poses.npy")
    finally:
        draft.unlink(missing_ok=True)
    return poses


def _read(poses, frames, jobs):
    """Run the analysis of these frames."""
    if jobs == 1:
        run = {"verbose": True, "progressbar_kwargs": {"desc": "reading", "unit": "frame", "disable": None}}
    else:
        run = {"backend": "multiprocessing", "n_workers": jobs}
    poses.run(start=frames.start, stop=frames.stop, step=frames.step, **run)


def _correlate(out, poses):
    """Write correlations and averages with their pictures, if there are enough frames and they are evenly spaced."""
    import numpy as np

    from . import averages, correlations, pictures, report
    from .tables import write_columns

    if len(poses.results.time) < 3:
        return cloup.echo("There are fewer than three frames, so there are no correlations.")
    try:
        found = correlations.all_correlations(poses, _bar("correlating", "function"))
    except ValueError:  # uneven times; averages() warns of them
        found = None
    if found and found.largest_turn > np.pi / 2:
        cloup.echo(
            f"A body turned by {found.largest_turn:.2g} radians from one frame to the next: the mean-square rotation is not"
            " reliable; dump more often."
        )
    known = averages.averages(poses)
    report.write_averages(out / "averages.csv", known)
    if found:
        write_columns(out / "correlations.csv", found.functions)
        if len(found.functions["lag"]) > 3 and (of_motion := correlations.spectra(found)):
            write_columns(out / "spectra.csv", of_motion)
        pictures.draw_correlations(found, known, out / "correlations.png")
    pictures.draw_averages(known, out / "averages.png")
    return cloup.echo(report.average_lines(known))
