"""Numbers with their errors as text."""

import doctest
import re

import numpy as np
import pytest

from gearquat_analysis import tables
from gearquat_analysis.tables import error_cells, rounded, with_error

NUMBER = r"-?\d+(?:\.\d+)?"


@pytest.mark.parametrize("seed", range(200))
def test_number_and_error_end_at_the_same_digit(seed):
    """The error has two digits, and both agree with the arguments, over 40 powers of ten."""
    random = np.random.default_rng(seed)
    value, error = random.choice([-1, 1]) * 10 ** random.uniform(-20, 20), 10 ** random.uniform(-20, 20)
    if error < 1e-12 * abs(value):
        error = 1e-12 * abs(value)
    text = with_error(value, error)
    both = re.fullmatch(rf"\(?({NUMBER}) ± ({NUMBER})\)?(?:e(-?\d+))?", text)
    assert both, text
    power = 10.0 ** int(both[3] or 0)
    assert len(both[1].partition(".")[2]) == len(both[2].partition(".")[2])
    digits = both[2].replace(".", "").strip("0")
    assert 1 <= len(digits) <= 2
    last = 10 ** (np.floor(np.log10(error)) - 1)
    assert abs(float(both[1]) * power - value) < 5.1 * last and abs(float(both[2]) * power - error) < 0.51 * last
    cells = [float(cell) for cell in error_cells(value, error)]
    assert cells == pytest.approx([float(both[1]) * power, float(both[2]) * power])


@pytest.mark.parametrize(
    "value, error, text",
    [
        (86.2, 10.3, "86 ± 10"),
        (86.2, 9.96, "86 ± 10"),
        (86.2, 0.0996, "86.20 ± 0.10"),
        (-2.5, 4e5, "0 ± 400000"),
        (0.0, 3e-9, "(0.0 ± 3.0)e-9"),
        (1234.0, 5678.0, "1200 ± 5700"),
        (5.0, 0.0, "5"),
        (5.0, np.nan, "5"),
        (np.nan, 1.0, "nan"),
        (1 / 3, np.inf, "0.333333"),
    ],
)
def test_with_error(value, error, text):
    assert with_error(value, error) == text
    assert with_error(value, error, "Å", "+") == "+" * (value >= 0) + f"{text} Å"


def test_cells():
    assert error_cells(86.2, 10.3) == ("86", "10")
    assert error_cells(-2.744e-4, 1.9e-5) == ("-2.74e-4", "0.19e-4")
    assert error_cells(5.0, 0.0) == ("5", "0") and error_cells(5.0, np.nan) == ("5", "")


@pytest.mark.parametrize("value, text", [(123.4, "120"), (0.00123, "0.0012"), (99600, "100000"), (2.4e6, "2.4e+06")])
def test_rounded(value, text):
    assert rounded(value, 2) == text


def test_examples():
    found = doctest.testmod(tables)
    assert found.attempted and not found.failed
