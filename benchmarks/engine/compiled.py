"""The C++ of a study, compiled with the kernel and the headers of its unit tests, and loaded."""

import ctypes
import hashlib
import os
import subprocess
from functools import cache

from .decks import ROOT

INCLUDED = (ROOT / "src" / "GEARQUAT", ROOT / "tests" / "unit")
#: the sources of the kernel beside its headers
_SOURCES = ("chain", "coefficients", "integrator", "remembered_loads", "shapes", "startup", "turn")
KERNEL = tuple(ROOT / "src" / "GEARQUAT" / f"gear_quat_{name}.cpp" for name in _SOURCES)


@cache
def load(source):
    """Library of a C++ file ``source``; it is compiled again if the file or a header has changed."""
    headers = sorted(header for folder in INCLUDED for header in folder.rglob("*.h"))
    text = b"".join(path.read_bytes() for path in (source, *KERNEL, *headers))
    folder = ROOT / "build" / "benchmarks" / source.parent.name
    compiled = folder / f"{source.stem}-{hashlib.sha256(text).hexdigest()[:16]}.so"
    if not compiled.is_file():
        folder.mkdir(parents=True, exist_ok=True)
        made = compiled.with_suffix(f".{os.getpid()}")
        words = ["g++", "-O2", "-std=c++17", "-shared", "-fPIC", str(source), *map(str, KERNEL), "-o", str(made)]
        subprocess.run([*words, *(f"-I{path}" for path in INCLUDED)], check=True)
        made.replace(compiled)
    return ctypes.CDLL(str(compiled))
