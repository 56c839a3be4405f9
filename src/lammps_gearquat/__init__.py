"""GEARQUAT for LAMMPS. Imports nothing heavy: `lmp` imports this at every start on every rank."""

import os


def plugin_folder() -> str:
    """The folder with gearquatplugin.so; in an editable install it is not that of `__file__`."""
    for folder in __path__:
        if os.path.exists(os.path.join(folder, "gearquatplugin.so")):
            return str(folder)
    return str(list(__path__)[0])


def __getattr__(name):
    """`__version__`, looked up only when asked for."""
    if name == "__version__":
        from importlib.metadata import version

        return version("lammps-gearquat")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
