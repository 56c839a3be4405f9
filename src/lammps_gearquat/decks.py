"""Where the input decks of the scenes are: in the checkout, or installed with the package."""

from pathlib import Path

import lammps_gearquat


def examples_folder():
    """Folder that holds ``case1`` … and ``common``, as a Path.

    A checkout (editable install) comes before the copy that was installed with the package, so
    that an edited deck is the one that runs.
    """
    folders = [Path(folder) for folder in lammps_gearquat.__path__]
    candidates = [folder.parent.parent / "examples" for folder in folders]
    candidates += [folder / "examples" for folder in folders]
    for candidate in candidates:
        if (candidate / "common" / "in.scene").is_file():
            return candidate
    raise FileNotFoundError(
        "the example decks (common/in.scene) are neither in the package nor in a checkout: "
        + ", ".join(str(c) for c in candidates)
    )


def deck_of_case(case):
    """Input deck of test case 1, 2 or 3."""
    return examples_folder() / f"case{case}" / f"in.case{case}"
