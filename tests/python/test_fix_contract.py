"""doc/fix_contract.md names every member of LAMMPS' class Fix, in the releases whose sources are there."""

import os
import re
from pathlib import Path

import pytest

from running import ROOT

PAGE = (ROOT / "doc" / "fix_contract.md").read_text()
CACHE = Path(os.environ.get("GEARQUAT_CACHE", Path.home() / ".cache" / "gearquat"))
TYPES = r"(?:static )?(?:int|unsigned int|uint64_t|bigint|double|char|ExecutionSpace)"
#: of 4 Feb 2025, which the tests have built, and of every other release in the cache
HEADERS = sorted(CACHE.glob("lammps-*/src/fix.h"))


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
    """All that the page has in its tables' first columns."""
    rows = [line.split("|")[1] for line in page.splitlines() if line.startswith("|")]
    return {name for row in rows for name in re.findall(r"`(\w+)`", row)}


@pytest.mark.parametrize("header", HEADERS, ids=lambda path: path.parts[-3])
def test_every_member_is_in_the_table(header):
    text = header.read_text()
    variables, functions = members(text)
    assert len(variables) > 90 and len(functions) > 100
    missing = (variables | functions) - named(PAGE)
    assert not missing, f"doc/fix_contract.md lacks {sorted(missing)}"
    newer = text.replace("  int rigid_flag;", "  int fluid_flag;\n  int rigid_flag;")
    melting = "  virtual void init() {}\n  virtual int melt(int) { return 0; }"
    newer = newer.replace("  virtual void init() {}", melting)
    assert set.union(*members(newer)) - named(PAGE) == {"fluid_flag", "melt"}


def test_there_is_a_header_and_no_row_without_a_member():
    known = set.union(*(set.union(*members(header.read_text())) for header in HEADERS))
    optional = {"thermo_modify_colname", "get_thermo_colname", "reverse_comm_device", "eflag_only"}
    assert named(PAGE) - known <= optional | {"NO_BOX_CHANGE", "BOX_CHANGE_"}
