"""The command ``gearquat analyze``."""

import resource
from pathlib import Path

import click

UNITS = ("lj", "real", "metal", "si", "cgs", "electron", "micro", "nano")
_FILE = click.Path(exists=True, dir_okay=False, path_type=Path)


def _frames(_context, _option, text):
    """START:STOP:STEP as a slice."""
    try:
        return slice(*(int(part) if part else None for part in (text or ":").split(":")))
    except (TypeError, ValueError) as error:
        raise click.BadParameter("START:STOP:STEP is required, such as ::10") from error


@click.command()
@click.argument("dump", type=_FILE)
@click.option(
    "--out",
    type=click.Path(file_okay=False, path_type=Path),
    default=Path("gearquat-analyze"),
    show_default=True,
    help="Folder for tables and pictures.",
)
@click.option(
    "--units",
    type=click.Choice(UNITS),
    help="LAMMPS' units, unless the dump says them (dump_modify units yes); for energies and --convert.",
)
@click.option(
    "--timestep",
    type=float,
    help="LAMMPS' time step, unless the dump has times (dump_modify time yes).  Without either, tables have"
    " numbers of steps for times.",
)
@click.option("--data", type=_FILE, help="Data file with masses and molecules, if not in the dump.")
@click.option(
    "--atom-style",
    help="Columns of the data file, such as 'id type x y z', if not those of full or molecular.",
)
@click.option(
    "--body", default="mol", show_default=True, help="Column with the ID of the body; 0: none."
)
@click.option("--select", default="all", help="Atoms, in MDAnalysis' words, such as 'resid 1-500'.")
@click.option(
    "--reference",
    default="principal",
    show_default=True,
    help="Frame of the body: 'principal', that of the fix; 'first', its first pose; or a file with x"
    " y z of the selected atoms by ID.",
)
@click.option("--potential", help="Column with potential energies of atoms.")
@click.option("--frames", callback=_frames, metavar="START:STOP:STEP", help="Frames to read.")
@click.option("--csv", "as_csv", is_flag=True, help="Also every pose as text, poses.csv.")
@click.option("--near", type=_FILE, help="File with places, x y z a line; for stays near them.")
@click.option("--radius", type=click.FloatRange(min=0, min_open=True), help="How near.")
@click.option(
    "--convert",
    "converted",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Also write the trajectory, in Å and ps: .dcd, .xtc, .trr, .nc, .xyz, .pdb, ...",
)
@click.option("--wrap", is_flag=True, help="With --convert: bodies in the box.")
@click.option("--jobs", type=click.IntRange(min=1), default=1, show_default=True, help="Processes.")
def analyze(dump, out, near, radius, frames, converted, wrap, as_csv, **options):
    """Poses, energies and correlations of the rigid bodies in a LAMMPS dump.

    DUMP is of 'dump custom', with id, mol, mass, positions (xu yu zu) and velocities, or a 'dump local' of
    the table of fix gear/quat.  Leaves poses.npy (everything, by frame and body), bodies.csv, totals.csv,
    correlations.csv and pictures of the latter two.
    """
    from .. import analysis_figures as figures
    from ..analysis import DumpError, tables

    if (near is None) != (radius is None):
        raise click.UsageError("--near and --radius belong together")
    out.mkdir(parents=True, exist_ok=True)
    try:
        poses = _run(dump, out, frames, converted, options)
        tables.write_bodies(out / "bodies.csv", poses)
        totals = tables.write_totals(out / "totals.csv", poses)
        figures.draw_totals(out / "totals.png", poses, totals)
        if as_csv:
            poses.to_csv(out / "poses.csv")
        _correlate(out, poses)
        if near:
            _stay(out, poses, near, radius)
        if converted:
            _convert(poses, converted, wrap, frames)
    except (DumpError, ValueError) as error:
        raise click.ClickException(str(error)) from error
    click.echo(tables.summary(poses, totals))
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    memory += options["jobs"] * (resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024)
    click.echo(f"At most {memory:.0f} MB of memory.  Tables and pictures are in {out.resolve()}")


def _settle(trajectory, converted, options):
    """Units and time step, from the dump or from the options, in ``options``; what is missing is named."""
    from ..analysis.convert import has_times

    style, units, timestep = trajectory.unit_style, options["units"], options["timestep"]
    if style and units and style != units:
        raise ValueError(f"--units {units}: the dump says units {style}")
    options["units"] = style or units
    if trajectory.cut_off:
        click.echo("The last frame of the dump is not whole, and is left out.")
    if converted and not options["units"]:
        raise ValueError(
            "--convert needs the units of the dump: give --units, or write the dump with dump_modify"
            " units yes"
        )
    if trajectory.timed and timestep is not None:
        click.echo("The dump has times of its own; --timestep is not used.")
    if trajectory.timed or timestep is not None:
        return
    if converted and has_times(converted):
        raise ValueError(
            f"--convert {converted} needs the times of the frames: give --timestep, or write the dump with"
            " dump_modify time yes"
        )
    click.echo("Neither the dump nor --timestep tells times: numbers of steps stand for them.")


def _run(dump, out, frames, converted, options):
    """Finished Poses or TablePoses."""
    import numpy as np
    from tqdm import tqdm

    from ..analysis import Poses, TablePoses, open_any
    from ..analysis.backends import Processes

    names = ("data", "atom_style", "body", "potential")
    timestep = 1.0 if options["timestep"] is None else options["timestep"]
    universe, local = open_any(dump, timestep, **{name: options[name] for name in names})
    _settle(universe.trajectory, converted, options)
    atoms = universe.select_atoms(options["select"])
    if not len(atoms):
        raise ValueError(f"--select {options['select']}: no such atom")
    common = {"units": options["units"], "out": out / "poses.npy"}
    if local:
        poses = TablePoses(atoms, **common)
    else:
        reference = options["reference"]
        if reference not in ("principal", "first"):
            reference = np.loadtxt(reference)
        poses = Poses(atoms, reference, potential=options["potential"], **common)
    span = {"start": frames.start, "stop": frames.stop, "step": frames.step}
    if options["jobs"] == 1:
        return poses.run(
            **span, verbose=True, progressbar_kwargs={"desc": "reading", "unit": "frame"}
        )

    def progress(parts, total):
        return tqdm(parts, total=total, desc="reading", unit="part")

    number = len(range(*frames.indices(len(universe.trajectory))))
    parts = min(max(number, 1), 50 * options["jobs"])
    backend = Processes(min(options["jobs"], parts), progress)
    return poses.run(**span, backend=backend, n_parts=parts, unsupported_backend=True)


def _correlate(out, poses):
    """correlations.csv and its picture, unless frames are too few or unevenly spaced."""
    import numpy as np
    from tqdm import tqdm

    from .. import analysis_figures as figures
    from ..analysis import correlations, tables

    def progress(functions):
        return tqdm(functions, desc="correlating", unit="function")

    if len(poses.results.time) < 3:
        return click.echo("There are fewer than three frames, so there are no correlations.")
    try:
        found, turn = correlations.all_correlations(poses, progress)
    except ValueError as error:
        return click.echo(f"There are no correlations: {error}.")
    if turn > np.pi / 2:
        click.echo(
            f"A body turned by {turn:.2g} radians from one frame to the next: the mean-square rotation is"
            " not to be trusted; dump more often."
        )
    tables.write_columns(out / "correlations.csv", found)
    figures.draw_correlations(out / "correlations.png", found)


def _stay(out, poses, near, radius):
    """stays.csv, survival.csv and a line."""
    import numpy as np

    from ..analysis import residence, tables

    places = np.loadtxt(near, ndmin=2)
    found = residence.stays(poses.results.centre, places, radius, poses.results.time)
    tables.write_stays(out / "stays.csv", found, poses.results.ids)
    lag = found.time - found.time[0]
    tables.write_columns(out / "survival.csv", {"lag": lag, "survival": found.survival()})
    spent = found.fraction().sum()
    click.echo(
        f"{len(found.body)} stays within {radius:g} of {len(places)} places: {spent:.1%} of the time."
    )


def _convert(poses, path, wrap, frames):
    from tqdm import tqdm

    from ..analysis.convert import convert, remark

    def progress(iterator):
        return tqdm(iterator, desc="writing", unit="frame")

    written = convert(poses.atoms, path, poses.units, wrap, frames, poses.results.time, progress)
    click.echo(f"The trajectory is in {' and '.join(map(str, written))}.  {remark(poses.units)}.")
