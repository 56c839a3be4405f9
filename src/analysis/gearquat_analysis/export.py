"""Results as pandas.DataFrame and xarray.Dataset, with units; both packages are optional."""

import importlib


def dataframe(columns, units):
    """pandas.DataFrame of ``columns``, name -> (n,); ``attrs["units"]`` has the nonempty ``units``, name -> unit."""
    frame = _optional("pandas").DataFrame(columns)
    frame.attrs["units"] = {name: unit for name, unit in units.items() if unit}
    return frame


def dataset(variables, coordinates, units):
    """xarray.Dataset of ``variables``, name -> (dimensions, values), and ``coordinates``; each has ``attrs["units"]``."""
    data = _optional("xarray").Dataset(variables, coordinates)
    for name in data.variables:
        if units.get(name):
            data[name].attrs["units"] = units[name]
    return data


def _optional(name):
    try:
        return importlib.import_module(name)
    except ModuleNotFoundError as error:
        message = f"this function requires {name}, which comes with the extra [frames] of gearquat-analysis: pip install {name}"
        raise ModuleNotFoundError(message, name=name) from error
