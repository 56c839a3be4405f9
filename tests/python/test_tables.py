"""Numbers with their errors as text."""

import doctest

import numpy as np
import pytest

from gearquat_analysis import tables
from gearquat_analysis.tables import rounded, with_error

@pytest.mark.parametrize(
    "value, error, text",
    [
        (86.2, 10.3, "86 ± 10"),
        (86.2, 9.96, "86 ± 10"),
        (86.2, 0.0996, "86.20 ± 0.10"),
        (-4e-5, 2.5e-5, "(-4.0 ± 2.5)e-5"),
        (1234.0, 5678.0, "(1.2 ± 5.7)e3"),
        (5.0, 0.0, "5"),
        (5.0, np.nan, "5"),
        (np.nan, 1.0, "nan"),
        (1 / 3, np.inf, "0.333333"),
    ],
)
def test_with_error(value, error, text):
    assert with_error(value, error) == text
    if text.startswith("(") or value != value:
        return
    assert with_error(value, error, "Å", "+") == "+" * (value >= 0) + f"{text} Å"


@pytest.mark.parametrize("value, text", [(123.4, "120"), (0.00123, "0.0012"), (99600, "100000"), (2.4e6, "2.4e+06")])
def test_rounded(value, text):
    assert rounded(value, 2) == text


def test_examples():
    found = doctest.testmod(tables)
    assert found.attempted and not found.failed
