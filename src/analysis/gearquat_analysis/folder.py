"""The folder of results of ``gearquat analyze``: settings.json says which analysis is in it."""

import hashlib
import json

#: what is compared of a dump, in bytes: a dump that has grown since begins as before
BEGINNING = 65536
SETTINGS = "settings.json"


class Folder:
    """Folder ``path`` for the results of an analysis of ``dump`` with ``options``, name -> value, that decide them.

    ``names`` are the files that an analysis may leave.  Raises ValueError if the folder has results of another dump or of
    other options, or results that do not say of what; nothing is changed before ``fill``.  ``replaced`` says whether
    it has results of the same analysis.
    """

    def __init__(self, path, dump, options, names):
        self.path, self._names = path, names
        known = self._known()
        self._written = known.get("written", [])
        # as they come back from the file
        self._settings = json.loads(json.dumps({"dump": str(dump.resolve()), **options}, default=str))
        self._settings["beginning"] = _beginning(dump, BEGINNING)
        self.replaced = bool(known)
        if not known and (strange := [name for name in names if (path / name).exists()]):
            raise ValueError(f"{path} has {strange[0]} of another analysis: another --out is required")
        differing = [name for name in ("dump", *options) if known and known.get(name) != self._settings[name]]
        if known and not differing and known["beginning"] != _beginning(dump, known["beginning"][0]):
            differing = ["the dump was written anew"]
        if differing:
            words = ", ".join(name if " " in name else "--" + name.replace("_", "-") for name in differing)
            words = words.replace("--dump", "the dump")
            raise ValueError(f"{path} has the analysis of other settings ({words}): another --out is required")

    def _known(self):
        path = self.path / SETTINGS
        if not path.exists():
            return {}
        try:
            known = json.loads(path.read_text(encoding="utf-8"))
            return known if "beginning" in known else {}
        except ValueError:
            return {}

    def require_free(self, paths):
        """Raises ValueError if one of the files at ``paths`` exists and is not of this analysis."""
        for path in paths:
            if path.exists() and str(path.resolve()) not in self._written:
                raise ValueError(f"{path} exists: another name is required")

    def fill(self):
        """Remove results of before, and note which analysis is in the folder."""
        for name in self._names:
            (self.path / name).unlink(missing_ok=True)
        self.note()

    def note(self, written=()):
        """Write settings.json, with the files ``written`` elsewhere."""
        self._written = sorted({*self._written, *(str(path.resolve()) for path in written)})
        text = json.dumps({**self._settings, "written": self._written}, indent=1, ensure_ascii=False)
        (self.path / SETTINGS).write_text(text + "\n", encoding="utf-8")


def _beginning(path, length):
    """Length and digest of at most ``length`` bytes of a file."""
    with open(path, "rb") as file:
        data = file.read(length)
    return [len(data), hashlib.sha256(data).hexdigest()]
