"""Lines of shell that a page or a developer of LAMMPS would type."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

CORES = str(len(os.sched_getaffinity(0)))


def do(where: Path, lines: str, **environment: str) -> str:
    """Runs lines of shell, which must succeed, and returns their output."""
    done = subprocess.run(
        ["bash", "-e", "-c", lines],
        cwd=where,
        # cached objects are found for any name of the folder
        env={**os.environ, "CCACHE_BASEDIR": str(where), "CCACHE_NOHASHDIR": "1", **environment},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    assert done.returncode == 0, f"{lines}\n{done.stdout[-5000:]}"
    return done.stdout
