"""Tables: as CSV files, and as aligned text for a terminal."""

import csv

import numpy as np


def write_rows(path, header, rows):
    """Rows of numbers and words as CSV; floats keep all their digits."""
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(header)
        writer.writerows(rows)


def flat(columns):
    """Columns (n,), (n, 3) or (n, 4) by their names as columns (n,); parts are named by their axes."""
    parts = {}
    for name, values in columns.items():
        values = np.asarray(values)
        letters = {3: "xyz", 4: "0123"}[values.shape[1]] if values.ndim == 2 else ""
        parts |= {f"{name}_{letter}": part for letter, part in zip(letters, values.T)} or {name: values}
    return parts


def write_columns(path, columns):
    """Columns of equal length as CSV, as ``flat`` has them."""
    columns = flat(columns)
    write_rows(path, columns, zip(*columns.values()))


def aligned(header, rows):
    """Columns of text with blanks between them; ``rows`` are lists of strings."""
    lines = [header, *rows]
    widths = [max(map(len, column)) for column in zip(*lines)]
    return "\n".join(
        "  " + "  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip() for line in lines
    )
