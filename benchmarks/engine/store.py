"""Results as files: the data of a study as JSON, from which its page can be rendered again."""

import csv

import jsonpickle
import numpy as np
from jsonpickle.ext.numpy import NumpyNDArrayHandlerView, register_handlers


class _Values(NumpyNDArrayHandlerView):
    """Arrays by value: jsonpickle's own handler of views may return other numbers."""

    def flatten(self, obj, data):
        return super().flatten(np.array(obj, order="C"), data)


register_handlers()
jsonpickle.handlers.register(np.ndarray, _Values(), base=True)


def write_data(path, data):
    """Write data, of any types that a study uses, as JSON."""
    path.write_text(jsonpickle.encode(data, keys=True, indent=1), encoding="utf-8")


def read_data(path):
    """The data passed to ``write_data``."""
    return jsonpickle.decode(path.read_text(encoding="utf-8"), keys=True, on_missing="error")


def write_csv(path, header, rows):
    """A table as a CSV file."""
    with open(path, "w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([header, *rows])
