"""Put the blocks and the pictures of a study into this checkout.

A block is text that a study has written into a hand-written page, between two markers; the first marker names the
command.
"""

import shutil

from .decks import ROOT
from .page import render

ANY_BEGIN, END = "<!-- begin: ", "<!-- end -->"


class PublishError(RuntimeError):
    """Raised if a page lacks the markers of a block."""


def begin(command):
    """The line before the block of a command."""
    return f"{ANY_BEGIN}written by `{command}` -->"


def split_block(text, command, page="README.md"):
    """A page before, inside and after the block of a command.

    Raises PublishError unless the page has exactly one such block.
    """
    before, marker, rest = text.partition(begin(command))
    inside, end, after = rest.partition(END)
    if not marker or not end or begin(command) in rest or ANY_BEGIN in inside:
        raise PublishError(f"{page} needs one {begin(command)} and after it one {END}")
    return before, inside, after


def write_block(page, command, block):
    """Put a block into a page, between its markers."""
    before, _, after = split_block(page.read_text(encoding="utf-8"), command, page.name)
    page.write_text(f"{before}{begin(command)}\n{block}\n{END}{after}", encoding="utf-8")


def command_of(study):
    """The command that publishes a study."""
    return f"benchmarks/run {study.key} --publish"


def check_places(study, root=ROOT):
    """Raise PublishError if a page lacks the block of the study."""
    for name in study.blocks:
        split_block((root / name).read_text(encoding="utf-8"), command_of(study), name)


def publish(study, finding, provenance, out, root=ROOT):
    """Write the blocks, and copy the pictures that they show from ``out``, the folder of the run."""
    folder, texts = root / "doc" / study.key, []
    for name, template in study.blocks.items():
        texts.append(render(template, study, finding, provenance))
        write_block(root / name, command_of(study), texts[-1])
    for source in sorted((out / study.key).iterdir()):
        if any(f"{study.key}/{source.name})" in text for text in texts):
            folder.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source, folder / source.name)
