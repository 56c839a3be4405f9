"""Tables: as CSV files, and as aligned text for a terminal."""

import csv

import numpy as np


def write_rows(path, header, rows):
    """Rows of numbers and words as CSV; floats keep all their digits."""
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(header)
        for row in rows:
            writer.writerow([value.item() if isinstance(value, np.generic) else value for value in row])


def write_columns(path, columns):
    """Columns of equal length as CSV, name -> (F,) or (F, 3); parts are named by their axes."""
    flat = {}
    for name, values in columns.items():
        values = np.asarray(values)
        parts = {name: values} if values.ndim == 1 else dict(zip("xyz", values.T))
        flat |= {part if part == name else f"{name}_{part}": column for part, column in parts.items()}
    write_rows(path, flat, zip(*flat.values()))


def aligned(header, rows):
    """Columns of text with blanks between them; ``rows`` are lists of strings."""
    lines = [header, *rows]
    widths = [max(map(len, column)) for column in zip(*lines)]
    return "\n".join(
        "  " + "  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip() for line in lines
    )
