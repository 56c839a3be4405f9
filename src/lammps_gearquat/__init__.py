"""GEARQUAT for LAMMPS. The module imports no large packages, because every rank imports it whenever `lmp` starts."""

import os


def plugin_folder() -> str:
    """The folder with gearquatplugin.so; in an editable install, `__file__` is in another folder."""
    for folder in __path__:
        if os.path.exists(os.path.join(folder, "gearquatplugin.so")):
            return str(folder)
    return str(list(__path__)[0])


def __getattr__(name):
    """`__version__` is determined only when it is requested."""
    if name == "__version__":
        from importlib.metadata import version

        return version("lammps-gearquat")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
