"""Tables as CSV files and as aligned text for a terminal, and numbers with their errors."""

import csv
import math

import numpy as np
from uncertainties import ufloat


def write_rows(path, header, rows):
    """Write rows of numbers and words as CSV; floats keep all their digits."""
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(header)
        writer.writerows(rows)


def flat(columns):
    """Split ``columns``, name -> (n,), (n, 3) or (n, 4), into columns (n,), named with suffixes x, y, z or 0 to 3."""
    parts = {}
    for name, values in columns.items():
        values = np.asarray(values)
        letters = {3: "xyz", 4: "0123"}[values.shape[1]] if values.ndim == 2 else ""
        parts |= {f"{name}_{letter}": part for letter, part in zip(letters, values.T)} or {name: values}
    return parts


def write_columns(path, columns):
    """Write columns of equal length as CSV, split by ``flat``."""
    columns = flat(columns)
    write_rows(path, columns, zip(*columns.values()))


def aligned(header, rows):
    """Text with aligned columns; ``rows`` are lists of strings."""
    lines = [header, *rows]
    widths = [max(map(len, column)) for column in zip(*lines)]
    return "\n".join(
        "  " + "  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip() for line in lines
    )


def rounded(value, digits=3):
    """Text of a number with ``digits`` significant digits; powers of ten only for very small or large numbers.

    >>> rounded(123.4, 2), rounded(0.00123456), rounded(1234567)
    ('120', '0.00123', '1.23e+06')
    """
    return f"{float(f'{value:.{digits}g}'):g}"


def with_error(value, error, unit="", sign=""):
    """Text of a number and its standard error: the error has two digits, and the number has the same decimals.

    ``sign``: "+" in front of numbers that are not negative.  Six digits of the number if the error is not above zero.

    >>> with_error(86.2, 10.3), with_error(0.3124, 0.0153, "Å"), with_error(-4e-5, 2.5e-5)
    ('86 ± 10', '0.312 ± 0.015 Å', '(-4.0 ± 2.5)e-5')
    """
    if math.isfinite(value) and math.isfinite(error) and error > 0.0:
        text = f"{ufloat(value, error):{sign}.2u}".replace("+/-", " ± ").replace("e-0", "e-").replace("e+0", "e")
    else:
        text = f"{value:{sign}.6g}"
    return f"{text} {unit}" if unit else text
