"""Blocks of pages from Jinja2 templates, in which the prose can be read and corrected as prose."""

import jinja2

from .decks import ROOT

TEMPLATES = ROOT / "benchmarks" / "templates"


def _row(cells):
    return "| " + " | ".join(str(cell).replace("|", "\\|") for cell in cells) + " |"


def markdown_table(header, rows):
    """A table in Markdown."""
    return "\n".join([_row(header), "|" + "---|" * len(header), *map(_row, rows)])


def file_of(picture):
    """File name of a picture: a PNG unless its name says otherwise."""
    return picture if "." in picture else f"{picture}.png"


def grouped(number):
    """A whole number in groups of thousands."""
    return f"{number:,.0f}".replace(",", " ")


def rounded(number):
    """Two significant digits of a large number, in groups of thousands."""
    return grouped(float(f"{number:.1e}"))


def _environment(folder, finding):
    """Jinja2 with the filters and functions of the templates; undefined names are errors.

    ``x | to(".1e")`` formats a number, ``n | grouped`` a large one, and ``n | rounded`` keeps two digits of it.
    ``table(name)`` shows a table of the finding, ``picture(name, caption)`` a picture with its caption.  Pictures are in a ``folder`` beside the page.
    """
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(TEMPLATES),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )

    def table(name):
        return markdown_table(finding.tables[name].header, finding.tables[name].rows)

    def picture(name, caption):
        if name not in finding.pictures:
            raise KeyError(f"the study draws no picture {name}")
        return f"![{caption}]({folder}/{file_of(name)})\n\n*{caption}*"

    environment.filters |= {"to": format, "grouped": grouped, "rounded": rounded}
    environment.globals |= {"table": table, "picture": picture}
    return environment


def render(template, study, finding, provenance):
    """Text of a template of a study; ``provenance``: a sentence on the origin of the measurement."""
    environment = _environment(study.key, finding)
    names = {"provenance": provenance}
    return environment.get_template(template).render(**names, **finding.context).strip()
