"""The machine and the software of a measurement."""

import datetime
import os
import platform
import re
import shutil
import subprocess
from importlib import metadata
from pathlib import Path

from .decks import ROOT

#: packages whose versions pages name
PACKAGES = ("lammps-gearquat", "numpy", "scipy")


def processor():
    """Name of the processor, as reported by Linux."""
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except OSError:
        text = ""
    match = re.search(r"^model name\s*:\s*(.*)$", text, re.MULTILINE)
    return match[1].strip() if match else platform.machine()


def system():
    """Name of the operating system."""
    try:
        return platform.freedesktop_os_release()["PRETTY_NAME"]
    except (OSError, KeyError):
        return platform.system()


def commit(*paths):
    """The last commit that changed ``paths``, and whether they have been changed since then; "" without git."""

    if not shutil.which("git"):
        return ""

    def git(*words):
        done = subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True)
        return done.stdout.strip() if done.returncode == 0 else ""

    name = git("log", "-1", "--format=%h", "--", *paths)
    return name + (" with changes" if name and git("status", "--porcelain", "--", *paths) else "")


def lammps_of(logs):
    """The LAMMPS that wrote the logs in a folder, from their first lines."""
    first = {log.open(encoding="utf-8").readline().strip() for log in Path(logs).glob("log.*")}
    return ", ".join(sorted(first)) or "LAMMPS of unknown version"


def sentence(out, at):
    """One sentence on the measurement: software, machine, date and commit.  ``out``: folder of the run."""
    cores = len(os.sched_getaffinity(0))
    logs = Path(out) / "logs"
    versions = [lammps_of(logs)] if logs.is_dir() else []
    versions += [f"{name} {metadata.version(name)}" for name in PACKAGES]
    return (
        f"It was measured with {', '.join(versions)} and Python "
        f"{platform.python_version()} on {system()}, {processor()} ({cores} cores), on "
        f"{datetime.date.today():%d %b %Y}{f', at commit {at}' if at else ''}."
    )
