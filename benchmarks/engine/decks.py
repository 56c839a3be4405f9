"""Paths of the input decks of the scenes."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES, SCENES = ROOT / "examples", ROOT / "benchmarks" / "scenes"


def deck(scene):
    """Input deck of a scene with many variables, such as "case1" or "top"."""
    return SCENES / f"in.{scene}"
