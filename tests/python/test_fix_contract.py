"""doc/fix_contract.md names every member of LAMMPS' class Fix, in the releases whose sources are there."""

import os
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "doc" / "fix_contract.md").read_text()
CACHE = Path(os.environ.get("GEARQUAT_CACHE", Path.home() / ".cache" / "gearquat"))
TYPES = r"(?:static )?(?:int|unsigned int|uint64_t|bigint|double|char|ExecutionSpace)"


def headers() -> list[Path]:
    """Of 4 Feb 2025, which the tests have built, and of every other release in the cache."""
    return sorted(CACHE.glob("lammps-*/src/fix.h"))


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


def test_the_headers_are_understood():
    assert headers(), f"no LAMMPS in {CACHE}; tests/run build fetches it"
    for header in headers():
        variables, functions = members(header.read_text())
        assert len(variables) > 90 and len(functions) > 100
        assert {
            "rigid_flag",
            "stores_ids",
            "virial",
            "cvatom",
            "id",
            "datamask_modify",
        } <= variables
        assert {"setmask", "extract", "dof", "set_molecule", "image"} <= functions


@pytest.mark.parametrize("kind", [0, 1], ids=["variables", "functions"])
def test_every_member_is_in_the_table(kind):
    for header in headers():
        missing = members(header.read_text())[kind] - named(PAGE)
        assert not missing, f"{header}: doc/fix_contract.md lacks {sorted(missing)}"


def test_a_new_member_is_noticed():
    text = headers()[0].read_text()
    newer = text.replace("  int rigid_flag;", "  int fluid_flag;\n  int rigid_flag;")
    assert members(newer)[0] - named(PAGE) == {"fluid_flag"}
    newer = text.replace(
        "  virtual void init() {}",
        "  virtual void init() {}\n  virtual int melt(int) { return 0; }",
    )
    assert members(newer)[1] - named(PAGE) == {"melt"}


def test_tests_and_members_are_there():
    """No row speaks of a test that is gone, or of a member that no header has."""
    for name in set(re.findall(r"`(test_\w+\.py)`", PAGE)):
        assert (ROOT / "tests" / "lammps" / name).exists(), name
    known = set.union(*(set.union(*members(header.read_text())) for header in headers()))
    optional = {"thermo_modify_colname", "get_thermo_colname", "reverse_comm_device", "eflag_only"}
    assert named(PAGE) - known <= optional | {"NO_BOX_CHANGE", "BOX_CHANGE_"}
