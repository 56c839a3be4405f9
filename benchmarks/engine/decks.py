"""Where the input decks of the scenes are."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def examples_folder():
    """Folder that holds ``case1`` … and ``common``, as a Path."""
    return ROOT / "examples"


def deck_of_case(case):
    """Input deck of test case 1, 2 or 3."""
    return examples_folder() / f"case{case}" / f"in.case{case}"
