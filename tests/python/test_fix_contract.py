"""doc/fix_contract.md names every member of LAMMPS' class Fix, in the releases whose sources are there."""

import re

import pytest

from support.running import ROOT, source_trees

PAGE = (ROOT / "doc" / "fix_contract.md").read_text()
TYPES = r"(?:static )?(?:int|unsigned int|uint64_t|bigint|double|char|ExecutionSpace)"


@pytest.fixture
def headers() -> list[str]:
    """Headers of 4 Feb 2025, which the tests have built, and of every other release on this machine."""
    return [(tree / "src" / "fix.h").read_text() for tree in source_trees()]


def members(header: str) -> tuple[set[str], set[str]]:
    """Variables and virtual functions of the class."""
    body = re.search(r"^class Fix .*?^};", header, re.DOTALL | re.MULTILINE)[0]
    body = re.sub(r"//.*", "", body)
    functions = set(re.findall(r"\bvirtual [^;({]*?(\w+)\(", body))
    variables = set()
    for names in re.findall(rf"^  {TYPES} ([^()=;]*);", body, re.MULTILINE):
        variables |= {re.sub(r"\[.*?\]", "", name).strip(" *") for name in names.split(",")}
    return variables, functions


def named(page: str) -> set[str]:
    """All members in the first columns of the tables of the page."""
    rows = [line.split("|")[1] for line in page.splitlines() if line.startswith("|")]
    return {name for row in rows for name in re.findall(r"`(\w+)`", row)}


def test_every_member_is_in_the_table(headers):
    for header in headers:
        variables, functions = members(header)
        assert len(variables) > 90 and len(functions) > 100
        missing = (variables | functions) - named(PAGE)
        assert not missing, f"doc/fix_contract.md lacks {sorted(missing)}"
        newer = header.replace("  int rigid_flag;", "  int fluid_flag;\n  int rigid_flag;")
        melting = "  virtual void init() {}\n  virtual int melt(int) { return 0; }"
        newer = newer.replace("  virtual void init() {}", melting)
        assert set.union(*members(newer)) - named(PAGE) == {"fluid_flag", "melt"}


def test_there_is_a_header_and_no_row_without_a_member(headers):
    known = set.union(*(set.union(*members(header)) for header in headers))
    optional = {"thermo_modify_colname", "get_thermo_colname", "reverse_comm_device", "eflag_only"}
    assert named(PAGE) - known <= optional | {"NO_BOX_CHANGE", "BOX_CHANGE_"}
