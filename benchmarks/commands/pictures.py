"""The command ``benchmarks/run pictures``."""

import click

from .measuring import lmp_option, measurement, out_option, publish_option, shares


@click.command()
@out_option("pictures", "pictures, dumps and logs")
@lmp_option()
@publish_option("doc/pictures, doc/pictures.md and README.md are to show them")
def pictures(out, lmp, publish_to):
    """Pictures of the paper's test cases for a talk, and a film.

    Runs test cases 1 and 3 and leaves orbit.png, tumbling.png, energy.png and leaving.gif.
    """
    from tqdm import tqdm

    from benchmarks.studies.pictures import figures, film, page, scenes

    with measurement(out, publish_to) as out:
        with shares() as progress:
            found = scenes.run(out, lmp, progress)
        figures.draw_orbit(out / "orbit.png", found[1])
        figures.draw_tumbling(out / "tumbling.png", found[1])
        figures.draw_energy(out / "energy.png", found[1])
        film.draw_film(
            out / "leaving.gif", found[3], progress=lambda rows: tqdm(rows, desc="drawing")
        )
    if publish_to:
        page.publish(publish_to, out)
    click.echo(f"Pictures are in {out}")
