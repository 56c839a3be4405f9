"""Every study as a whole, with short runs: runs, judgment, tables, pictures, page."""

import math
from dataclasses import replace

import pytest

from benchmarks.engine.conduct import Origin, all_studies, write
from benchmarks.engine.lab import Lab
from benchmarks.engine.store import read_data, write_data
from benchmarks.studies import coefficients
from running import ROOT


#: test_liquids.py makes its page of made-up runs, because real runs take minutes
STUDIES = [study for key, study in all_studies().items() if key != "liquids"]
#: studies of which even a quick run of all parts takes minutes; there is no page from some of the parts
PARTS = {"accuracy": ("top",), "scatter": ("conservation",)}


def beyond(bound, sign):
    """A value that exceeds a bound by one percent, or by a small number if the bound is zero."""
    return bound + sign * (0.01 * abs(bound) or 1e-12)


@pytest.mark.parametrize("study", STUDIES, ids=lambda study: study.key)
def test_from_runs_to_a_page(study, tmp_path, monkeypatch):
    # a tenth of the points of a picture, each of which is a root with 40 digits
    monkeypatch.setattr(coefficients, "RANGE", coefficients.RANGE[::10])
    parts = PARTS.get(study.key, ())
    write_data(tmp_path / "data.json", study.measure(Lab(tmp_path, quick=True, parts=parts)))
    finding = study.find(read_data(tmp_path / "data.json"))
    write(study, tmp_path, finding, Origin("It was measured in a test.", not parts))
    if not parts:
        page = (tmp_path / f"{study.page}.md").read_text()
        assert page.startswith(f"# {study.title}") and "It was measured in a test." in page
        assert not any(mark in page for mark in ("{{", "{%", "Undefined"))
    for name, table in finding.tables.items():
        assert all(len(row) == len(table.header) for row in table.rows), name
    assert (ROOT / "doc" / f"{study.page}.md").is_file()
    bounded = [one for one in finding.measurements if one.bounds]
    for one in bounded:
        wrong = [beyond(one.most, 1)] if one.most is not None else []
        wrong += [beyond(one.least, -1)] if one.least is not None else []
        assert not any(replace(one, value=value).holds for value in (*wrong, math.nan)), one.what
    assert finding.tables or finding.measurements
