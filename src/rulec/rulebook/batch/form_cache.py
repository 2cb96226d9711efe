"""Cache of what is in canonical form: digests of texts, for this program alone.

Whether a text is in form depends on nothing but the text and the formatter. Anything odd about the
file, and all is formatted anew.
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
"""So many are known; of more, the ones used last."""

_FILE = "in_form"


@dataclass(slots=True)
class KnownForms:
    """Digests of texts that are in form, those used last at the end."""

    digests: dict[str, None] = field(default_factory=dict)
    is_changed: bool = False

    @classmethod
    def read(cls) -> KnownForms:
        """What the cache knows."""
        folder = usable_folder()
        kept: Any = None if folder is None else recall_json(folder / _FILE)
        with suppress(TypeError, LookupError):
            if kept["program"] == _program():
                return cls(dict.fromkeys(map(str, kept["digests"])))
        return cls()

    def has(self, text: bytes) -> bool:
        """Tell whether a text is known to be in form."""
        return sha256(text).hexdigest() in self.digests

    def add(self, text: bytes) -> None:
        """Note that a text is in form."""
        self.digests[sha256(text).hexdigest()] = None
        self.is_changed = True

    def write(self) -> None:
        """Keep what is known, if that is possible and something is new."""
        folder = usable_folder()
        if folder is not None and self.is_changed:
            kept = {"program": _program(), "digests": list(self.digests)[-MOST_TEXTS:]}
            keep_json(folder / _FILE, kept)


def _program() -> str:
    return f"{__version__} {program_digest()}"
