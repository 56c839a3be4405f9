"""GEARQUAT as a pull request to LAMMPS: a patch for ``git am``, and the accompanying text.

    tests/run patch [--author "NAME (AFFILIATION)"] [--email ADDRESS]

writes ``build/upstream/gearquat.patch`` and ``pull_request.md`` for the newest release that the tests know, or
for a clone of LAMMPS that LAMMPS_NEWEST_SOURCE_DIR names. A pull request needs the clone: it has two lists that
no distributor publishes, ``src/.gitignore`` and ``.github/CODEOWNERS``. Author and address stand in every place
where LAMMPS wants them; without the options the words AUTHOR and EMAIL stand there, to be filled in later.
`tests/run upstream` rehearses what LAMMPS' developers would do with the patch.

A list of LAMMPS in which the place of an entry is not found ends the program with the name of the list:
LAMMPS has changed, and the entry needs another rule.
"""

from __future__ import annotations

import argparse
import re
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from example_logs import copy_examples
from running import ROOT

PACKAGE = ROOT / "src" / "GEARQUAT"
SUMMARY = "accurate motion of rigid bodies"

#: the notice that LAMMPS requires at the beginning of every source file
NOTICE = """\
/* {mode:-<70}
   LAMMPS - Large-scale Atomic/Molecular Massively Parallel Simulator
   https://www.lammps.org/, Sandia National Laboratories
   LAMMPS development team: developers@lammps.org

   Copyright (2003) Sandia Corporation.  Under the terms of Contract
   DE-AC04-94AL85000 with Sandia Corporation, the U.S. Government retains
   certain rights in this software.  This software is distributed under
   the GNU General Public License.

   See the README file in the top-level LAMMPS directory.
------------------------------------------------------------------------- */

/* ----------------------------------------------------------------------
   Contributing author: {author}, {email}
------------------------------------------------------------------------- */
"""

DETAILS = """\
.. _PKG-GEARQUAT:

GEARQUAT package
----------------

**Contents:**

This package provides :doc:`fix gear/quat <fix_gear_quat>`, which moves
rigid bodies by Gear's predictor-corrector method in quaternions. Its
error falls with a high power of the time step at one evaluation of the
forces per step, and it estimates this error and can adapt the time step
to it.

**Author:** {author}

**Supporting info:**

* ``src/GEARQUAT``: filenames -> commands
* ``src/GEARQUAT/README``
* :doc:`fix gear/quat <fix_gear_quat>`
* ``examples/PACKAGES/gearquat``

----------

"""

TABLE_ROW = f"""\
   * - :ref:`GEARQUAT <PKG-GEARQUAT>`
     - {SUMMARY}
     - :doc:`fix gear/quat <fix_gear_quat>`
     - ``PACKAGES/gearquat``
     - no
"""

#: words of the manual page that are in no dictionary of LAMMPS' spell check
WORDS = ("Failor", "librations", "Mohamad", "Rapaport", "Zaini")

#: sentences of the manual page that are about this repository: plugins, and its releases
ONLY_HERE = (
    "A plugin for the LAMMPS of the Python package cannot read them and warns.",
    "Ellipsoids, lines and triangles need headers that the LAMMPS of the Python package lacks: "
    "a plugin for it refuses them.",
    "Restart files of releases up to 0.2.0 are refused.",
    ", or if it was loaded as a :doc:`plugin <plugin>`",
)


@dataclass(frozen=True)
class Entry:
    """Lines for one of LAMMPS' lists, before or after each line that the pattern ``at`` matches."""

    path: str
    at: str
    text: str
    after: bool = False
    times: int = 1
    #: distributors leave out the files that only git and GitHub use
    optional: bool = False

    def add_to(self, tree: Path) -> None:
        file = tree / self.path

        def with_text(line: re.Match) -> str:
            return line[0] + self.text if self.after else self.text + line[0]

        text, found = re.subn(self.at, with_text, file.read_text(), flags=re.M)
        if found != self.times:
            raise SystemExit(
                f"{self.path}: the place for GEARQUAT, {self.at!r}, is there {found} times, "
                f"not {self.times}; LAMMPS has changed this list"
            )
        file.write_text(text)


def entries(author: str) -> list[Entry]:
    """Every list of LAMMPS that names all packages or all fixes, in the order of the alphabet."""
    presets = ("all_off", "all_on", "lammps-gui", "mingw-cross", "most", "windows")
    cmake = ["cmake/CMakeLists.txt", *(f"cmake/presets/{name}.cmake" for name in presets)]
    return [
        *(Entry(path, r"^  FEP\n", "  GEARQUAT\n", after=True) for path in cmake),
        # all packages, and those without libraries (yes-most)
        Entry("src/Makefile", r"^\tfep \\\n", "\tgearquat \\\n", after=True, times=2),
        Entry("doc/src/Packages.rst", r"^   \* - :ref:`GPU <PKG-GPU>`$", TABLE_ROW),
        Entry(
            "doc/src/Packages_details.rst",
            r"^   \* :ref:`GPU <PKG-GPU>`$",
            "   * :ref:`GEARQUAT <PKG-GEARQUAT>`\n",
        ),
        Entry("doc/src/Packages_details.rst", r"^\.\. _PKG-GPU:$", DETAILS.format(author=author)),
        Entry(
            "doc/src/Commands_fix.rst",
            r"^   \* :doc:`gld <fix_gld>`$",
            "   * :doc:`gear/quat <fix_gear_quat>`\n",
        ),
        Entry(
            "doc/src/fix.rst",
            r"^\* :doc:`gld <fix_gld>` - ",
            f"* :doc:`gear/quat <fix_gear_quat>` - {SUMMARY}\n",
        ),
        Entry(
            "src/.gitignore",
            r"^/fix_gcmc\.h\n",
            "/fix_gear_quat.cpp\n/fix_gear_quat.h\n/gear_quat_*.cpp\n/gear_quat_*.h\n",
            after=True,
            optional=True,
        ),
        Entry(
            ".github/CODEOWNERS",
            r"^src/FEP/\*.*\n",
            "src/GEARQUAT/*        @GITHUB-NAME\n",
            after=True,
            optional=True,
        ),
    ]


def add_words(tree: Path, author: str) -> None:
    """Into the sorted list of words that LAMMPS' spell check takes, the author's names among them."""
    file = tree / "doc" / "utils" / "sphinx-config" / "false_positives.txt"
    words = file.read_text().split("\n")[:-1]
    for word in (*WORDS, *re.findall(r"[A-Z][a-z]+", author)):
        if word not in words:
            place = next((n for n, old in enumerate(words) if old.lower() > word.lower()), len(words))
            words.insert(place, word)
    file.write_text("\n".join(words) + "\n")


def with_notice(path: Path, author: str, email: str) -> str:
    """A source with LAMMPS' notice in place of the one that it has here."""
    text = path.read_text()
    own = re.match(r"/\*.* -+\n(?:.*\n)*?-+ \*/\n", text)
    mode = "-*- c++ -*- " if path.suffix == ".h" else ""
    notice = NOTICE.format(mode=mode, author=author, email=email)
    return notice + text[own.end() :]


def without_paragraphs(text: str, *words: str) -> str:
    """The paragraphs that contain none of these words."""
    kept = [part for part in text.split("\n\n") if not any(word in part for word in words)]
    return "\n\n".join(kept)


def manual_page() -> str:
    """The page of the fix without the sentences that are about this repository."""
    text = (ROOT / "doc" / "src" / "fix_gear_quat.rst").read_text()
    for sentence in ONLY_HERE:
        words = r"\s+".join(map(re.escape, sentence.split()))
        text, found = re.subn(rf"\s*{words}", "", text)
        if found != 1:
            raise SystemExit(f"fix_gear_quat.rst has {found} times, not once: {sentence}")
    return text


def package_readme(author: str, email: str) -> str:
    """The README of the package if it is one of LAMMPS' packages."""
    text = (PACKAGE / "README").read_text()
    before, build, after = re.match(r"(.*\nHow to build\n\n)(.*?)(Contents\n.*)", text, re.S).groups()
    assert "STANDARD_PACKAGES" in build
    build = (
        "The package requires neither libraries nor other packages.\n\n"
        "  CMake             -D PKG_GEARQUAT=on\n"
        "  traditional make  make yes-gearquat\n\n"
    )
    person = f"The person who created this package is {author}. Contact: {email}\n\n"
    return before.replace("How to build\n", person + "How to build\n") + build + after


def examples_readme(folder: Path) -> str:
    """The README of the examples, about the copied folders only."""
    text = without_paragraphs(
        (ROOT / "examples" / "README").read_text(), "tests/run logs", "make_scenes.py write"
    )
    present = {path.name for path in folder.iterdir()}
    table = re.search(r"(?:^    \w+ +.*\n(?: {10,}\S.*\n)*)+", text, re.M)
    rows = re.findall(r"^    \w+ +.*\n(?: {10,}\S.*\n)*", table[0], re.M)
    kept = "".join(row for row in rows if row.split()[0] in present)
    return text.replace(table[0], kept, 1).rstrip("\n") + "\n"


def without_benchmarks(text: str) -> str:
    """A README or a deck without the sentences that name a command of this repository."""
    text = re.sub(r'(^|(?<=\.) )([A-Z][^.]*)?"benchmarks/run \w+"[^.]*\. ?', "", text, flags=re.M)
    text = re.sub(r"\n{3,}", "\n\n", text)
    return re.sub(r": benchmarks/run \w+\.", ".", text)


def new_files(tree: Path, author: str, email: str) -> None:
    """All files that LAMMPS does not have yet."""
    package = tree / "src" / "GEARQUAT"
    package.mkdir(parents=True)
    for source in (*PACKAGE.glob("*.h"), *PACKAGE.glob("*.cpp")):
        (package / source.name).write_text(with_notice(source, author, email))
    (package / "README").write_text(package_readme(author, email))
    (tree / "doc" / "src" / "fix_gear_quat.rst").write_text(manual_page())
    examples = copy_examples(tree)
    (examples / "README").write_text(examples_readme(examples))
    for file in (*examples.glob("*/README"), *examples.glob("*/in.*")):
        file.write_text(without_benchmarks(file.read_text()))
    tests = tree / "unittest" / "force-styles" / "tests"
    tests.mkdir(parents=True)
    for yaml in (ROOT / "tests" / "lammps").glob("fix-timestep-*.yaml"):
        shutil.copy(yaml, tests)


def git(folder: Path, *words: str) -> str:
    """Runs git without personal settings."""
    identity = ["-c", "user.name=AUTHOR", "-c", "user.email=EMAIL", "-c", "core.autocrlf=false"]
    done = subprocess.run(["git", "-C", folder, *identity, *words], capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(f"git {' '.join(words)}:\n{done.stdout}{done.stderr}")
    return done.stdout


def existing(lammps: Path, lists: list[Entry]) -> Iterator[Entry]:
    for entry in lists:
        if (lammps / entry.path).exists():
            yield entry
        elif not entry.optional:
            raise SystemExit(f"{lammps} has no {entry.path}: not a whole source tree of LAMMPS, or another one")
        else:
            print(f"   {entry.path} is not in this tree (a clone has it): no entry")


def make_patch(lammps: Path, author: str, email: str) -> str:
    """A commit on top of ``lammps``, which stays as it is, in the form of ``git format-patch``."""
    with tempfile.TemporaryDirectory() as temporary:
        tree = Path(temporary)
        lists = list(existing(lammps, entries(author)))
        edited = {entry.path for entry in lists} | {"doc/utils/sphinx-config/false_positives.txt"}
        git(tree, "init", "-q")
        for path in edited:
            (tree / path).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(lammps / path, tree / path)
        git(tree, "add", "-f", ".")
        git(tree, "commit", "-q", "-m", "LAMMPS")
        for entry in lists:
            entry.add_to(tree)
        add_words(tree, author)
        new_files(tree, author, email)
        git(tree, "add", "-f", ".")
        subject = f"add package GEARQUAT with fix gear/quat: {SUMMARY}"
        git(tree, "commit", "-q", "-m", subject, f"--author={author} <{email}>")
        return git(tree, "format-patch", "-1", "--stdout", "--no-signature")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("lammps", type=Path, metavar="LAMMPS")
    parser.add_argument("--author", default="AUTHOR (AFFILIATION)")
    parser.add_argument("--email", default="EMAIL")
    parser.add_argument("--to", type=Path, default=ROOT / "build" / "upstream", help=argparse.SUPPRESS)
    args = parser.parse_args()
    args.to.mkdir(parents=True, exist_ok=True)
    patch = args.to / "gearquat.patch"
    patch.write_text(make_patch(args.lammps.resolve(), args.author, args.email))
    text = (Path(__file__).parent / "pull_request.md").read_text()
    (args.to / "pull_request.md").write_text(text.format(author=args.author, email=args.email))
    print(f"   {patch}\n   {args.to / 'pull_request.md'}")


if __name__ == "__main__":
    main()
