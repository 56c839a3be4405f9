"""paper/: the paper builds, every citation resolves, and its numbers agree with README."""

import re
import runpy

import pytest
from support.running import ROOT

PAPER = (ROOT / "paper" / "paper.md").read_text()
#: the sections that the Journal of Open Source Software requires
SECTIONS = [
    "Summary",
    "Statement of need",
    "State of the field",
    "Software design",
    "Research impact statement",
    "AI usage disclosure",
    "Acknowledgements",
    "References",
]
WORDS = range(750, 1751)


@pytest.fixture(scope="module")
def maker():
    return runpy.run_path(str(ROOT / "paper" / "make_pdf.py"))


def test_it_builds(maker, tmp_path):
    maker["make_pdf"](PAPER, tmp_path / "paper.pdf")
    assert (tmp_path / "paper.pdf").read_bytes().startswith(b"%PDF-")


def test_every_reference_is_cited_and_every_citation_has_a_reference(maker):
    maker["markup"](PAPER)
    keys = re.findall(r"^@\w+{(\w+),", (ROOT / "paper" / "paper.bib").read_text(), re.M)
    assert len(keys) > 10
    assert [key for key in keys if f"@{key}" not in PAPER] == []


def test_it_has_the_form_of_the_journal():
    body = PAPER.split("---\n", 2)[2]
    assert re.findall(r"^# (.*)$", body, re.M) == SECTIONS
    assert len(re.sub(r"^[|!:<].*$", "", body, flags=re.M).split()) in WORDS


def test_the_numbers_are_those_of_readme():
    readme = (ROOT / "README.md").read_text()
    ours, theirs = (re.findall(r"^\|.*$", text, re.M) for text in (PAPER, readme))
    assert len(ours) > 5
    assert "\n".join(ours) in "\n".join(theirs)
