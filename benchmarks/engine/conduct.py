"""From a study to its results: measure or read, find, draw, write, publish, check."""

import importlib
import json
import pkgutil
from dataclasses import dataclass
from pathlib import Path

from benchmarks import studies

from . import panels, provenance
from .lab import Lab
from .page import file_of, render
from .publish import PublishError, check_places, publish
from .store import read_data, write_csv, write_data

ORIGIN, DATA = "origin.json", "data.json"


def all_studies():
    """Key -> Study of all modules and packages of ``benchmarks.studies``."""
    names = sorted(module.name for module in pkgutil.iter_modules(studies.__path__))
    modules = [importlib.import_module(f"{studies.__name__}.{name}") for name in names]
    return {module.STUDY.key: module.STUDY for module in modules if hasattr(module, "STUDY")}


@dataclass(frozen=True)
class Origin:
    """The origin of data: a sentence for the page, and ``whole``, False if they are from a quick run."""

    sentence: str
    whole: bool


def measure(study, out, **options):
    """Measure and keep data and their origin in ``out``; ``options`` are passed to Lab."""
    out.mkdir(parents=True, exist_ok=True)
    at = provenance.commit("src", "benchmarks", "examples")
    data = study.measure(Lab(out, **options))
    origin = {"sentence": provenance.sentence(out, at), "whole": not options.get("quick")}
    write_data(out / DATA, data)
    (out / ORIGIN).write_text(json.dumps(origin, indent=1), encoding="utf-8")


def results(study, out):
    """Finding and Origin of the data that were kept in ``out``."""
    if not (out / DATA).is_file():
        raise FileNotFoundError(f"{out} has no {DATA}: measure first, without --render")
    origin = json.loads((out / ORIGIN).read_text(encoding="utf-8"))
    return study.find(read_data(out / DATA)), Origin(**origin)


def write(study, out, finding, origin):
    """Write tables, pictures and the blocks of pages to ``out``."""
    rows = [(m.what, m.value, m.error, m.unit, m.remark) for m in finding.measurements]
    header = ("measurement", "value", "standard error", "unit", "remark")
    write_csv(out / "measurements.csv", header, rows)
    for name, table in finding.tables.items():
        write_csv(out / f"{name}.csv", table.header, table.rows)
    folder = out / study.key
    folder.mkdir(parents=True, exist_ok=True)
    for name, picture in finding.pictures.items():
        path = folder / file_of(name)
        picture(path) if callable(picture) else panels.draw(path, picture)
    for template in study.blocks.values():
        text = render(template, study, finding, origin.sentence)
        (out / template.removesuffix(".j2")).write_text(text, encoding="utf-8")


def conduct(study, out, render_only=False, publish_it=False, **options):
    """Do all these steps; returns the Finding."""
    out = Path(out).resolve()
    if publish_it:
        if options.get("quick"):
            raise PublishError("--publish needs the whole study: leave out --quick")
        check_places(study)
    if not render_only:
        measure(study, out, **options)
    finding, origin = results(study, out)
    write(study, out, finding, origin)
    if publish_it:
        if not origin.whole:
            raise PublishError(f"{out} has no results of the whole study")
        publish(study, finding, origin.sentence, out)
    return finding
