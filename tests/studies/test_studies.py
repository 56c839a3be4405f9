"""Every study as a whole, with short runs: runs, judgment, tables, pictures, blocks of pages."""

import math
from dataclasses import replace

import pytest

from benchmarks.engine.conduct import Origin, all_studies, write
from benchmarks.engine.lab import Lab
from benchmarks.engine.publish import check_places
from benchmarks.engine.store import read_data, write_data

#: test_liquids.py makes its block of made-up runs, because real runs take minutes
STUDIES = [study for key, study in all_studies().items() if key != "liquids"]


def beyond(bound, sign):
    """A value that exceeds a bound by one percent, or by a small number if the bound is zero."""
    return bound + sign * (0.01 * abs(bound) or 1e-12)


def written(study, folder, finding):
    """Page -> text of the block that a study writes for a Finding."""
    write(study, folder, finding, Origin("It was measured in a test.", True))
    return {page: (folder / name.removesuffix(".j2")).read_text() for page, name in study.blocks.items()}


@pytest.mark.parametrize("study", STUDIES, ids=lambda study: study.key)
def test_from_runs_to_a_page(study, tmp_path):
    write_data(tmp_path / "data.json", study.measure(Lab(tmp_path, quick=True)))
    finding = study.find(read_data(tmp_path / "data.json"))
    for page, text in written(study, tmp_path, finding).items():
        assert ("It was measured in a test." in text) == (page != "README.md")
        assert not any(mark in text for mark in ("{{", "{%", "Undefined"))
    for name, table in finding.tables.items():
        assert all(len(row) == len(table.header) for row in table.rows), name
    bounded = [one for one in finding.measurements if one.bounds]
    for one in bounded:
        wrong = [beyond(one.most, 1)] if one.most is not None else []
        wrong += [beyond(one.least, -1)] if one.least is not None else []
        assert not any(replace(one, value=value).holds for value in (*wrong, math.nan)), one.what


@pytest.mark.parametrize("study", all_studies().values(), ids=lambda study: study.key)
def test_pages_have_the_places_of_the_blocks(study):
    assert study.blocks
    check_places(study)
