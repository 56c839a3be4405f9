"""The paper as a PDF, without LaTeX: pandoc turns paper.md into Typst's markup, and Typst makes pages of it.

The journal makes its own PDF, with pandoc and LaTeX, in its own layout.
"""

import subprocess
import sys
from pathlib import Path

import pypandoc
import typst

PAPER = Path(__file__).resolve().parent
ROOT = PAPER.parent
#: pandoc lays out the columns of tables by their contents if no line is longer
WIDEST = 1000


def markup(text):
    """Typst's markup of a paper in Markdown, with all references.

    Raises ValueError with pandoc's words if it warns, as it does of a citation that paper.bib lacks.
    """
    command = [pypandoc.get_pandoc_path(), "--from=markdown", "--to=typst", "--template=layout.typ"]
    command += ["--citeproc", "--fail-if-warnings", f"--columns={WIDEST}"]
    done = subprocess.run(command, cwd=PAPER, input=text, capture_output=True, text=True)
    if done.returncode != 0:
        raise ValueError(done.stderr.strip())
    return done.stdout


def make_pdf(text, pdf):
    """Write the PDF of a paper.  Raises ValueError, also for a picture that is not there."""
    # Typst's absolute paths begin at its root, which is the repository
    source = markup(text).replace('image("../', 'image("/')
    try:
        typst.compile(source.encode("utf-8"), output=pdf, root=ROOT)
    except RuntimeError as error:
        raise ValueError(str(error)) from error


if __name__ == "__main__":
    make_pdf((PAPER / "paper.md").read_text(encoding="utf-8"), Path(sys.argv[1]))
