"""A cache of digests of formatted texts, for this version of rulec only.

Whether a text is formatted depends only on the text and the formatter. If anything is wrong with
the cache file, everything is formatted again.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, field
from hashlib import sha256
from typing import Any

from rulec.cache.cache_folder import program_digest, usable_folder
from rulec.cache.kept_json import keep_json, recall_json
from rulec.version import __version__

MOST_TEXTS = 10_000
"""How many texts are kept, the most recently used ones."""

_FILE = "in_form"


@dataclass(slots=True)
class KnownForms:
    """Digests of formatted texts, the most recently used ones at the end."""

    digests: dict[str, None] = field(default_factory=dict)
    is_changed: bool = False

    @classmethod
    def read(cls) -> KnownForms:
        """The content of the cache."""
        folder = usable_folder()
        kept: Any = None if folder is None else recall_json(folder / _FILE)
        with suppress(TypeError, LookupError):
            if kept["program"] == _program():
                return cls(dict.fromkeys(map(str, kept["digests"])))
        return cls()

    def has(self, text: bytes) -> bool:
        """Whether a text is known to be formatted."""
        return sha256(text).hexdigest() in self.digests

    def add(self, text: bytes) -> None:
        """Record that a text is formatted."""
        self.digests[sha256(text).hexdigest()] = None
        self.is_changed = True

    def write(self) -> None:
        """Write the cache, if possible and if something is new."""
        folder = usable_folder()
        if folder is not None and self.is_changed:
            kept = {"program": _program(), "digests": list(self.digests)[-MOST_TEXTS:]}
            keep_json(folder / _FILE, kept)


def _program() -> str:
    return f"{__version__} {program_digest()}"
