"""Texts of the hand-written pages for tests."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sysconfig
from pathlib import Path

from support.running import MPI_ENVIRONMENT, ROOT

INSTALL = (ROOT / "doc" / "install.md").read_text()


def first_script() -> str:
    """The smallest input script, of the page about installing."""
    return re.search(r"^```\n(# in\.\w+\n.*?)^```", INSTALL, re.M | re.S)[1]


def blocks(page: str, language: str) -> list[str]:
    """Texts of the fenced blocks of a how-to page that are in a language."""
    text = (ROOT / "doc" / "howto" / f"{page}.md").read_text()
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.M | re.S)


def unpack(folder: Path) -> Path:
    """``folder`` with the files of the commit alone, as in a fresh clone; of a release without git, what it came with."""
    if not (ROOT / ".git").exists():
        return shutil.copytree(ROOT, folder, dirs_exist_ok=True, ignore=shutil.ignore_patterns(".venv", "build", "__pycache__"))
    archive = subprocess.run(["git", "-C", ROOT, "archive", "HEAD"], capture_output=True, check=True).stdout
    subprocess.run(["tar", "-x", "-C", folder], input=archive, check=True)
    return folder


def paste(text: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """The output of a shell in ``folder`` with ``text`` as its input."""
    path = f"{sysconfig.get_path('scripts')}:{os.environ['PATH']}"
    done = subprocess.run(
        ["bash", "-euo", "pipefail", "-c", text],
        cwd=folder,
        env={**os.environ, **MPI_ENVIRONMENT, "PATH": path},
        capture_output=True,
        text=True,
        timeout=200,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done


def _subject(line: str) -> list[str]:
    words = line.split() or [""]
    named = ("fix", "dump", "fix_modify", "dump_modify")
    return words[: 2 if words[0] in named else 1]


def edited(script: str, block: str) -> str:
    """A script with the lines of a block.

    A line replaces the line with the same command (and ID, if there is one); other lines come before the ``run``, or at
    the end if they follow a ``run`` of the block.
    """
    lines, ran = script.splitlines(), False
    for line in block.splitlines():
        same = [i for i, old in enumerate(lines) if _subject(old) == _subject(line)]
        run = next(i for i, old in enumerate(lines) if _subject(old) == ["run"])
        if same:
            lines[same[0]] = line
        else:
            lines.insert(len(lines) if ran else run, line)
        ran = ran or _subject(line) == ["run"]
    return "\n".join(lines) + "\n"
