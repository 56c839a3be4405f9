"""Publishing as the studies do it that do not use the engine yet."""

import shutil
from pathlib import Path

from . import provenance as origin
from .publish import ANY_BEGIN, END, PublishError, begin, split_block, write_block  # noqa: F401


def find(folder, command=None):
    """``folder`` as a Path, if it is a checkout, and its README has a block for the command, if any."""
    folder = Path(folder).resolve()
    readme = folder / "README.md"
    if not (folder / "src" / "GEARQUAT").is_dir() or not readme.is_file():
        raise PublishError(f"{folder} is not a checkout of GEARQUAT")
    if command:
        split_block(readme.read_text(encoding="utf-8"), command)
    return folder


def write_page(folder, name, text, pictures=()):
    """A page that one command writes as a whole: doc/<name>.md, its pictures in doc/<name>.

    ``folder``: the checkout; ``pictures``: files, which the text calls <name>/<file>.
    """
    doc = find(folder) / "doc"
    (doc / name).mkdir(parents=True, exist_ok=True)
    for picture in pictures:
        shutil.copyfile(picture, doc / name / picture.name)
    (doc / f"{name}.md").write_text(text, encoding="utf-8")


def provenance(out, packages=("lammps-gearquat", "numpy")):
    """One sentence: what measured, where and when.  ``out``: folder of the run."""
    return origin.sentence(out, packages, origin.commit("src")).replace("It was measured", "Measured")
