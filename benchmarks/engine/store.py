"""Results as files: the data of a study as JSON, from which its page can be rendered again."""

import csv

import jsonpickle
import jsonpickle.ext.numpy

jsonpickle.ext.numpy.register_handlers()


def write_data(path, data):
    """Write data, of any types that a study uses, as JSON."""
    path.write_text(jsonpickle.encode(data, keys=True, indent=1), encoding="utf-8")


def read_data(path):
    """Data as ``write_data`` got it."""
    return jsonpickle.decode(path.read_text(encoding="utf-8"), keys=True, on_missing="error")


def write_csv(path, header, rows):
    """A table as a CSV file."""
    with open(path, "w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([header, *rows])
