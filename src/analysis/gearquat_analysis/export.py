"""Results as pandas.DataFrame, with units; pandas is optional."""

import importlib


def dataframe(columns, units):
    """pandas.DataFrame of ``columns``, name -> (n,); ``attrs["units"]`` has the nonempty ``units``, name -> unit."""
    try:
        pandas = importlib.import_module("pandas")
    except ModuleNotFoundError as error:
        message = "this function requires pandas, which comes with the extra [frames] of gearquat-analysis: pip install pandas"
        raise ModuleNotFoundError(message, name="pandas") from error
    frame = pandas.DataFrame(columns)
    frame.attrs["units"] = {name: unit for name, unit in units.items() if unit}
    return frame
