"""GEARQUAT for LAMMPS. Imports nothing heavy: every rank imports this module whenever `lmp` starts."""

import os


def plugin_folder() -> str:
    """The folder with gearquatplugin.so; in an editable install, `__file__` lies elsewhere."""
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
