"""Paths of the input decks of the scenes."""

from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples"


def deck(scene):
    """Input deck of a scene under examples, such as "case1" or "water"."""
    return EXAMPLES / scene / f"in.{Path(scene).name}"
