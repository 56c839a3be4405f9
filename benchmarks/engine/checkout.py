"""A checkout, as commands that publish see it: blocks between markers, and where it was measured.

A block is what one command has written into a page that people write: README.md may have several,
each named after its command.
"""

import datetime
import os
import platform
import re
import shutil
from importlib import metadata
from pathlib import Path

ANY_BEGIN, END = "<!-- begin: ", "<!-- end -->"


class PublishError(RuntimeError):
    """The folder is not a checkout of GEARQUAT, or lacks the place to write to."""


def begin(command):
    """The line before the block of a command."""
    return f"{ANY_BEGIN}written by `{command}` -->"


def split_block(text, command, page="README.md"):
    """A page before, inside and after the block of a command."""
    before, marker, rest = text.partition(begin(command))
    inside, end, after = rest.partition(END)
    if not marker or not end or begin(command) in rest or ANY_BEGIN in inside:
        raise PublishError(f"{page} needs one {begin(command)} and after it one {END}")
    return before, inside, after


def write_block(page, command, block):
    """Put a block into a page, between its markers."""
    before, _, after = split_block(page.read_text(encoding="utf-8"), command, page.name)
    page.write_text(f"{before}{begin(command)}\n{block}\n{END}{after}", encoding="utf-8")


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


# --- where it was measured ----------------------------------------------------------------------
def processor():
    """Name of the processor, as Linux tells it."""
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except OSError:
        text = ""
    found = re.search(r"^model name\s*:\s*(.*)$", text, re.MULTILINE)
    return found[1].strip() if found else platform.machine()


def system():
    """Name of the operating system."""
    try:
        return platform.freedesktop_os_release()["PRETTY_NAME"]
    except (OSError, KeyError):
        return platform.system()


def lammps_of(logs):
    """The LAMMPS that wrote the logs in a folder, from their first lines."""
    first = {log.open(encoding="utf-8").readline().strip() for log in Path(logs).glob("log.*")}
    return ", ".join(sorted(first)) or "LAMMPS of unknown version"


def provenance(out, packages=("lammps-gearquat", "numpy")):
    """One sentence: what measured, where and when.  ``out``: folder of the run."""
    cores = len(os.sched_getaffinity(0))
    versions = [f"{name} {metadata.version(name)}" for name in packages]
    return (
        f"Measured with {lammps_of(Path(out) / 'logs')}, {', '.join(versions)}, Python "
        f"{platform.python_version()}, on {system()}, {processor()} ({cores} cores), "
        f"{datetime.date.today():%d %b %Y}."
    )
