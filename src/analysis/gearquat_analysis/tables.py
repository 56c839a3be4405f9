"""Tables as CSV files and as aligned text for a terminal, and numbers with their errors."""

import csv
import math

import numpy as np


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

    ``sign``: "+" in front of numbers that are not negative.

    >>> with_error(86.2, 10.3), with_error(0.3124, 0.0153, "Å"), with_error(2.744e-4, 1.9e-5)
    ('86 ± 10', '0.312 ± 0.015 Å', '(2.74 ± 0.19)e-4')
    """
    both, power = _decimals(value, error)
    joined = " ± ".join(both)
    return sign * bool(value >= 0) + (f"({joined})e{power}" if power else joined) + f" {unit}" * bool(unit)


def error_cells(value, error):
    """Number and error as two cells of a table, rounded as in ``with_error``.

    >>> error_cells(86.2, 10.3), error_cells(2.744e-4, 1.9e-5), error_cells(1.5, float("nan"))
    (('86', '10'), ('2.74e-4', '0.19e-4'), ('1.5', ''))
    """
    both, power = _decimals(value, error)
    if len(both) == 1:
        return (*both, "0" if error == 0.0 else "")
    return tuple(f"{text}e{power}" if power else text for text in both)


def _decimals(value, error):
    """((number, error) as text, power of ten); if the error is not positive, the number has six digits and no error."""
    if not (math.isfinite(value) and math.isfinite(error) and error > 0.0):
        return (rounded(value, 6),), 0
    last = _power(error, 2) - 1
    power = max(_power(value, 6), _power(error, 2)) if value else _power(error, 2)
    power = power if not -4 < power < 6 else 0
    return tuple(f"{round(x, -last) / 10.0**power + 0.0:.{max(power - last, 0)}f}" for x in (value, error)), power


def _power(value, digits):
    """The power of ten of the first digit after rounding to ``digits``: for 0.0996, -2 with three and -1 with two."""
    return int(f"{value:.{digits - 1}e}".partition("e")[2])
