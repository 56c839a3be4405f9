"""The folder of results of ``gearquat analyze``: settings.json describes the analysis in it."""

import hashlib
import json

#: number of bytes at the beginning of a dump that are compared; they stay the same when a dump grows
BEGINNING = 65536
SETTINGS = "settings.json"


class Folder:
    """Folder ``path`` for the results of an analysis of ``dump`` with ``options``, name -> value, that determine them.

    ``names`` are the files that an analysis may write.  Raises ValueError if the folder has results of another dump, of
    other options, or of an unknown analysis.  ``replaced`` is True if it has results of the same analysis.  Nothing is
    changed before ``fill``.
    """

    def __init__(self, path, dump, options, names):
        self.path, self._names = path, names
        known = self._known()
        self._written = known.get("written", [])
        # in the form in which they are read back from the file
        self._settings = json.loads(json.dumps({"dump": str(dump.resolve()), **options}, default=str))
        self._settings["beginning"] = _beginning(dump, BEGINNING)
        self.replaced = bool(known)
        if not known and (strange := [name for name in names if (path / name).exists()]):
            raise ValueError(f"{path} has {strange[0]} of another analysis: another --out is required")
        differing = [name for name in ("dump", *options) if known and known.get(name) != self._settings[name]]
        if known and not differing and known["beginning"] != _beginning(dump, known["beginning"][0]):
            differing = ["the dump was rewritten"]
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
        """Raises ValueError if a file at ``paths`` exists that this analysis did not write."""
        for path in paths:
            if path.exists() and str(path.resolve()) not in self._written:
                raise ValueError(f"{path} exists: another name is required")

    def fill(self):
        """Remove earlier results, and write settings.json."""
        for name in self._names:
            (self.path / name).unlink(missing_ok=True)
        self.note()

    def note(self, written=()):
        """Write settings.json, including the files ``written`` to other places."""
        self._written = sorted({*self._written, *(str(path.resolve()) for path in written)})
        text = json.dumps({**self._settings, "written": self._written}, indent=1, ensure_ascii=False)
        (self.path / SETTINGS).write_text(text + "\n", encoding="utf-8")


def _beginning(path, length):
    """Length and digest of the first ``length`` bytes of a file, or of the whole file if it is shorter."""
    with open(path, "rb") as file:
        data = file.read(length)
    return [len(data), hashlib.sha256(data).hexdigest()]
