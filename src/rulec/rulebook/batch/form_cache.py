"""A cache of digests of formatted texts, for this version of rulec only.

Whether a text is formatted depends only on the text and the formatter.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from hashlib import sha256

from rulec.cache.kept_bytes import KeptBytes

MOST_TEXTS = 10_000
"""How many texts are kept, the most recently used ones."""

_FORMS = KeptBytes("form", 1)


@dataclass(slots=True)
class KnownForms:
    """Digests of formatted texts, the most recently used ones at the end."""

    digests: dict[bytes, None] = field(default_factory=dict)
    is_changed: bool = False

    @classmethod
    def read(cls) -> KnownForms:
        """The content of the cache."""
        size, kept = sha256().digest_size, _FORMS.recall(_FORMS.key()) or b""
        return cls(dict.fromkeys(kept[n : n + size] for n in range(0, len(kept), size)))

    def has(self, text: bytes) -> bool:
        """Whether a text is known to be formatted."""
        return sha256(text).digest() in self.digests

    def add(self, text: bytes) -> None:
        """Record that a text is formatted."""
        self.digests[sha256(text).digest()] = None
        self.is_changed = True

    def write(self) -> None:
        """Write the cache, if possible and if something is new."""
        if self.is_changed:
            _FORMS.keep({_FORMS.key(): b"".join([*self.digests][-MOST_TEXTS:])})
