"""The checks of LAMMPS' developers and their continuous integration, applied to the pull request.

The patch is applied to the newest release, which ``tests/run upstream`` names in GEARQUAT_UPSTREAM, followed by
LAMMPS' own checks, manual, builds and unit tests. A deliberate error shows that each check examines the package.
This takes an hour on one core with an empty compiler cache.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from example_logs import FOLDERS, decks, needs_wheel, run_tests
from pull_request import entries, git, make_patch
from running import OPEN_MPI_ENVIRONMENT, OPEN_MPI_LAUNCHER, ROOT, Lammps
from shell import CORES, do
from thrown import DECK, assert_thrown

AUTHOR, EMAIL = "Ada Lovelace (Nowhere)", "ada@example.org"
MANUAL = Path("doc/src/fix_gear_quat.rst")
SOURCE = Path("src/GEARQUAT/fix_gear_quat.cpp")


@pytest.fixture(scope="session")
def release() -> Path:
    return Path(os.environ["GEARQUAT_UPSTREAM"])


@pytest.fixture(scope="session")
def tree(release: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A repository with two commits: the release, and the patch on top of it."""
    folder = tmp_path_factory.mktemp("pull")
    tree = folder / "lammps"
    shutil.copytree(release, tree, symlinks=True, ignore=shutil.ignore_patterns(".git"))
    (folder / "gearquat.patch").write_text(make_patch(release, AUTHOR, EMAIL))
    git(tree, "init", "-q")
    git(tree, "config", "core.compression", "0")
    git(tree, "add", "-f", ".")
    git(tree, "commit", "-q", "-m", "LAMMPS")
    git(tree, "apply", "--check", str(folder / "gearquat.patch"))
    git(tree, "am", "-q", str(folder / "gearquat.patch"))
    return tree


@pytest.fixture(scope="session")
def docenv(release: Path) -> Path:
    """The environment for building LAMMPS' manual; kept in build, since it takes minutes."""
    utils, folder = release / "doc" / "utils", ROOT / "build" / "upstream" / "docenv"
    # LAMMPS takes sphinx-fortran from a branch on GitHub; the released version reads in one process
    wanted = [line for line in (utils / "requirements.txt").read_text().splitlines() if "git+" not in line]
    wanted += ["sphinx-fortran", "setuptools<80"]
    stamp = folder / "requirements.txt"
    if not stamp.exists() or stamp.read_text().splitlines() != wanted:
        shutil.rmtree(folder, ignore_errors=True)
        do(ROOT, f"{sys.executable} -m venv {folder}")
        (folder / "wanted.txt").write_text("\n".join(wanted) + "\n")
        do(folder, f"bin/pip install -r wanted.txt {utils / 'converters'}")
        (folder / "wanted.txt").rename(stamp)
    os.utime(folder, (0, 0))  # for make, no part of it is out of date
    return folder


def make(tree: Path, target: str, docenv: Path) -> tuple[int, str]:
    """``make check-whitespace`` in src, ``make style_check`` in doc: exit code and output."""
    where = "src" if target.startswith("check-") else "doc"
    # a folder for MathJax keeps make from cloning it; the finished pages alone load it
    (tree / "doc/utils/sphinx-config/_static/mathjax").mkdir(exist_ok=True)
    command = ["make", "-s", "--no-print-directory", "-C", where, target, "MFLAGS=", f"VENV={docenv}"]
    done = subprocess.run(command, cwd=tree, capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


def ours(said: str) -> list[str]:
    """Lines about the package or the fix."""
    return [line for line in said.splitlines() if re.search(r"gear[/_]?quat", line, re.I)]


# --- the patch ------------------------------------------------------------------------------------
def test_the_patch_adds_and_removes_nothing(tree):
    changed = git(tree, "diff", "--numstat", "HEAD~1").splitlines()
    assert len(changed) > 100 and all(line.split("\t")[1] == "0" for line in changed)
    assert git(tree, "status", "--porcelain", "--untracked-files=no") == ""
    assert git(tree, "log", "-1", "--format=%an <%ae>").strip() == f"{AUTHOR} <{EMAIL}>"


def test_every_source_has_the_notice_and_its_author(tree):
    sources = [path for path in (tree / "src" / "GEARQUAT").iterdir() if path.suffix in (".h", ".cpp")]
    assert len(sources) > 60
    for path in sources:
        head = path.read_text()[:1400]
        assert "Copyright (2003) Sandia Corporation" in head and f"{AUTHOR}, {EMAIL}" in head, path.name
        assert "__has_include" not in path.read_text() and "library.h" not in path.read_text(), path.name


def test_examples_are_complete_and_speak_of_nothing_else(tree):
    examples = tree / "examples" / "PACKAGES" / "gearquat"
    assert {path.name for path in examples.iterdir()} == {"README", "common", *FOLDERS}
    text = (examples / "README").read_text()
    table = re.findall(r"^    (\w+) +\S", text.partition("Two things")[0], re.M)
    assert set(table) == {"common", *FOLDERS}
    assert "installs this repository" not in text
    for path in examples.rglob("*"):
        if path.is_file() and not path.name.startswith("log."):
            assert not re.search(r"\b(tests|benchmarks)/", path.read_text()), path


def test_entries_that_only_a_clone_needs(release, tmp_path):
    """Distributors omit these two files from their packages."""
    clone = tmp_path / "lammps"
    (clone / ".github").mkdir(parents=True)
    for part in ("cmake", "doc"):
        (clone / part).symlink_to(release / part)
    (clone / "src").mkdir()
    (clone / "src" / "Makefile").symlink_to(release / "src" / "Makefile")
    (clone / "src" / ".gitignore").write_text("/fix_gcmc.cpp\n/fix_gcmc.h\n/fix_gld.cpp\n")
    (clone / ".github" / "CODEOWNERS").write_text("src/FEP/*             @somebody\n")
    patch = make_patch(clone, AUTHOR, EMAIL)
    assert "\n+/gear_quat_*.cpp\n" in patch and "\n+src/GEARQUAT/*        @" in patch


def test_a_changed_list_is_named(tmp_path):
    entry = next(entry for entry in entries(AUTHOR) if entry.path.endswith("most.cmake"))
    (tmp_path / entry.path).parent.mkdir(parents=True)
    (tmp_path / entry.path).write_text("  EXTRA-PAIR\n  GRANULAR\n")
    with pytest.raises(SystemExit, match="most.cmake"):
        entry.add_to(tmp_path)


# --- LAMMPS' checks -------------------------------------------------------------------------------
def appended(line):
    return lambda text: text + line


def without(pattern):
    return lambda text: re.sub(pattern, "", text, flags=re.M)


#: target of make -> a file of the patch, and a fault that the check must find
PLANTED = {
    "check-whitespace": (SOURCE, appended("int late; \n")),
    "check-homepage": (SOURCE.parent / "README", appended("http://lammps.sandia.gov\n")),
    "check-errordocs": (
        SOURCE.with_suffix(".h"),
        appended("\n/* ERROR/WARNING messages:\n\n*/\n"),
    ),
    "check-fmtlib": (SOURCE, appended('  fmt::print("x");\n')),
    "check-permissions": (SOURCE, None),  # an executable bit
    "anchor_check": (MANUAL, appended("\n.. _GearQuatGear:\n\n**(Gear)** again\n")),
    "style_check": (Path("doc/src/Commands_fix.rst"), without(r"^.*<fix_gear_quat>`\n")),
    "package_check": (Path("doc/src/Packages_details.rst"), without(r"^.*<PKG-GEARQUAT>`\n")),
    "char_check": (MANUAL, appended("caf\u00e9\n")),
    "role_check": (MANUAL, appended(".. neighbors: begin\n")),
}


@pytest.mark.parametrize("target", PLANTED)
def test_checks_pass_and_look(tree, docenv, target):
    code, said = make(tree, target, docenv)
    assert code == 0 and ours(said) == [], said
    path, fault = PLANTED[target]
    file = tree / path
    text, mode = file.read_text(), file.stat().st_mode
    try:
        file.write_text(fault(text)) if fault else file.chmod(0o755)
        assert fault is None or file.read_text() != text
        _, said_now = make(tree, target, docenv)
        assert said_now != said and re.search(r"gear[/_]?quat", said_now, re.I), said_now
    finally:
        file.write_text(text)
        file.chmod(mode)


def test_manual(tree, docenv):
    """All pages, without a warning other than one of sphinx-fortran about itself."""
    code, said = make(tree, "html", docenv)
    page = tree / "doc" / "html" / "fix_gear_quat.html"
    assert code == 0 and page.exists(), said[-5000:]
    warnings = [line for line in said.splitlines() if re.search("warning|error:", line, re.I)]
    progress = r"^(reading sources|writing output|highlighting module code|copying)|^build succeeded"
    others = [line for line in warnings if not re.search(progress, line)]
    assert [line for line in others if "sphinxfortran" not in line and "serial read" not in line] == []
    assert "PKG-GEARQUAT" in (tree / "doc" / "html" / "Packages.html").read_text().replace("pkg-gearquat", "PKG-GEARQUAT")


def test_spelling(tree, docenv):
    """No unknown word in the page, in the lists or in the author's name, where a misspelled word is found."""
    file = tree / MANUAL
    text = file.read_text()
    try:
        file.write_text(text + "\nThis is a mispelled wrod.\n")
        code, said = make(tree, "spelling", docenv)
    finally:
        file.write_text(text)
    assert code == 0, said[-5000:]
    found = (tree / "doc" / "spelling" / "fix_gear_quat.spelling").read_text()
    assert set(re.findall(r"rst:\d+: \((\w+)\)", found)) == {"mispelled", "wrod"}
    names = set(re.findall(r"[A-Z][a-z]+", AUTHOR))
    for page in (tree / "doc" / "spelling").glob("*.spelling"):
        assert not names & set(re.findall(r"rst:\d+: \((\w+)\)", page.read_text())), page.name


@pytest.fixture(scope="session")
def zig(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The compiler of the package ziglang: Clang with libc++, which has std::format."""
    folder = tmp_path_factory.mktemp("zig")
    do(folder, f"{sys.executable} -m venv . && bin/pip install ziglang")
    return folder / "bin" / "python-zig"


def test_cpp23_without_variable_length_arrays(tree, zig, tmp_path):
    """With C++20 and later LAMMPS takes std::format, which judges format strings when it is compiled."""
    include = [f"-I{tree / part}" for part in ("src/GEARQUAT", "src", "src/STUBS")]
    flags = ["-std=c++23", "-Werror=vla", "-O0", "-DLAMMPS_SMALLBIG", "-c", "-o", tmp_path / "object.o"]

    def errors(source: Path) -> list[str]:
        done = subprocess.run([zig, "c++", *flags, *include, source], capture_output=True, text=True)
        found = [line for line in done.stderr.splitlines() if "error:" in line]
        assert bool(found) == (done.returncode != 0), done.stderr
        return found

    wrong = tmp_path / "wrong.cpp"
    begin = '#include "pointers.h"\nstd::string text(double x, int n) {'
    wrong.write_text(begin + ' return fmt::format("{:d}", x); }\n')
    assert errors(wrong) != []
    wrong.write_text(begin + " double a[n]; a[0] = x; return fmt::format(\"{:g}\", a[0]); }\n")
    assert "variable length" in errors(wrong)[0]
    for source in sorted((tree / "src" / "GEARQUAT").glob("*.cpp")):
        assert errors(source) == [], source.name


# --- LAMMPS' builds -------------------------------------------------------------------------------
#: without optimization, and with a compiler cache
SETTINGS = {"CXXFLAGS": "-O0", "CMAKE_CXX_COMPILER_LAUNCHER": "ccache", "CMAKE_GENERATOR": "Ninja"}


def test_presets(tree, tmp_path):
    on = {name: "ON" for name in ("all_on", "most", "lammps-gui", "mingw-cross", "windows")}
    for preset, value in {**on, "all_off": "OFF"}.items():
        lines = f'include("{tree}/cmake/presets/{preset}.cmake")\nmessage("${{PKG_GEARQUAT}} ${{PKG_FEP}}")\n'
        (tmp_path / "ask.cmake").write_text(lines)
        assert do(tmp_path, "cmake -P ask.cmake").split() == [value, value], preset


@pytest.fixture(scope="session")
def build(tree: Path) -> Path:
    """LAMMPS with the package, by CMake, and the program of its unit tests of fixes."""
    gtest = Path(os.environ["GEARQUAT_GTEST"])
    checksum = hashlib.sha256(gtest.read_bytes()).hexdigest()
    packages = ["GEARQUAT", *os.environ["GEARQUAT_PACKAGES"].split()]
    options = [f"-D PKG_{name}=on" for name in packages]
    options += ["-D ENABLE_TESTING=on", f"-D GTEST_URL=file://{gtest}", f"-D GTEST_SHA256={checksum}"]
    options += ["-D BUILD_MPI=on", f"-D MPI_CXX_COMPILER={shutil.which('mpicxx.openmpi')}"]
    options += [f"-D WITH_{name}=off" for name in ("JPEG", "PNG", "GZIP", "FFMPEG", "CURL")]
    do(tree, f"cmake -S cmake -B build {' '.join(options)} -D FFT=KISS -D BUILD_OMP=off", **SETTINGS)
    do(tree, f"ninja -C build -j {CORES} lmp test_fix_timestep")
    return tree / "build"


def test_unit_tests(build):
    said = do(build, "ctest -R gear_quat --no-tests=error")
    total = int(re.search(r"100% tests passed, 0 tests failed out of (\d+)", said)[1])
    assert total == len(list((build.parent / "unittest").glob("**/fix-timestep-gear_quat*.yaml"))) > 10
    assert "Skipped" not in said and "Disabled" not in said


@pytest.mark.parametrize("ranks", [1, 4])
def test_examples_agree_with_their_logs(build, tmp_path, ranks):
    lmp = Lammps("pull", build / "lmp", OPEN_MPI_LAUNCHER, tmp_path, OPEN_MPI_ENVIRONMENT)
    examples = build.parent / "examples" / "PACKAGES" / "gearquat"
    wanted = [deck for deck in decks(examples, ranks) if not needs_wheel(deck)]
    found = run_tests(lmp, wanted, ranks, tmp_path)
    assert set(found) == {deck.name for deck in wanted} and len(found) >= 5
    assert [how for how in found.values() if not (isinstance(how, int) and how >= 8)] == []


def test_traditional_make(tree, tmp_path):
    sources = tree / "src"
    assert "gearquat" in do(sources, "make package").split()
    do(sources, "make yes-gearquat")
    do(sources, f"make -j {CORES} serial CC='ccache g++' CCFLAGS=-O0")
    lmp = Lammps("make", sources / "lmp_serial", [], tmp_path)
    assert_thrown(lmp.run(DECK.format(load="")))
    do(sources, "make no-gearquat")
    assert [path for path in sources.iterdir() if "gear_quat" in path.name] == []
