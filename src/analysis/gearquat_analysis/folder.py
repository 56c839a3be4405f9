"""The folder of results of a command: settings.json has the file and the options to which they belong."""

import hashlib
import json

#: number of bytes at the beginning of a file that are compared; they stay the same when a dump grows
BEGINNING = 65536
SETTINGS = "settings.json"


class Folder:
    """Folder ``path`` for the results of a command about ``source``, a file of the kind ``what``, with ``options``, name ->
    value, that determine them.

    ``names`` are the files that the command may write, and ``more`` options that only settings.json names.  Raises
    ValueError if the folder has results of another file, of other options, or of unknown ones.  ``replaced`` is True if
    it has results of the same ones.  Nothing is changed before ``fill``.
    """

    def __init__(self, path, source, options, names, what="dump", more=None):
        self.path, self._names = path, names
        known = self._known()
        # in the form in which they are read back from the file
        self._settings = json.loads(json.dumps({what: str(source.resolve()), **options}, default=str))
        differing = [name for name in self._settings if known and known.get(name) != self._settings[name]]
        self._settings |= {**(more or {}), "beginning": _beginning(source, BEGINNING)}
        self.replaced = bool(known)
        if not known and (strange := [name for name in names if (path / name).exists()]):
            raise ValueError(f"{path} has {strange[0]} of unknown settings: another --out is required")
        length = known["beginning"][0] if known and what == "dump" else BEGINNING  # only a dump may grow
        if known and not differing and known["beginning"] != _beginning(source, length):
            differing = [f"the {what} was rewritten"]
        if differing:
            words = ", ".join(name if " " in name else "--" + name.replace("_", "-") for name in differing)
            words = words.replace(f"--{what}", f"the {what}")
            raise ValueError(f"{path} has results of other settings ({words}): another --out is required")

    def _known(self):
        path = self.path / SETTINGS
        if not path.exists():
            return {}
        try:
            known = json.loads(path.read_text(encoding="utf-8"))
            return known if "beginning" in known else {}
        except ValueError:
            return {}

    def fill(self, say):
        """Remove earlier results, which ``say`` is told, and write settings.json."""
        if self.replaced:
            say(f"These results replace the earlier ones in {self.path}.")
        self.path.mkdir(parents=True, exist_ok=True)
        for name in self._names:
            (self.path / name).unlink(missing_ok=True)
        text = json.dumps(self._settings, indent=1, ensure_ascii=False)
        (self.path / SETTINGS).write_text(text + "\n", encoding="utf-8")


def _beginning(path, length):
    """Length and digest of the first ``length`` bytes of a file, or of the whole file if it is shorter."""
    with open(path, "rb") as file:
        data = file.read(length)
    return [len(data), hashlib.sha256(data).hexdigest()]
