"""Results as tables of pandas and data sets of xarray, with their units; both packages are optional."""

import importlib


def dataframe(columns, units):
    """pandas.DataFrame of columns (n,) by their names; ``attrs["units"]`` has ``units``, name -> unit."""
    frame = _optional("pandas").DataFrame(columns)
    frame.attrs["units"] = {name: unit for name, unit in units.items() if unit}
    return frame


def dataset(variables, coordinates, units):
    """xarray.Dataset of ``variables``, name -> (dimensions, values), and ``coordinates``; ``attrs["units"]`` of each."""
    data = _optional("xarray").Dataset(variables, coordinates)
    for name in data.variables:
        if units.get(name):
            data[name].attrs["units"] = units[name]
    return data


def _optional(name):
    try:
        return importlib.import_module(name)
    except ModuleNotFoundError as error:
        message = f"this needs {name}, which the extra [frames] of gearquat-analysis brings: pip install {name}"
        raise ModuleNotFoundError(message, name=name) from error
