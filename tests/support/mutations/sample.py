"""A small recording or map as files, and how mistakes come into them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from random import Random

from support.generators.mutated_files import mutated, mutated_bytes, mutated_rows

Change = Callable[[bytes, Random], bytes]


def _as_text(data: bytes, pick: Random) -> bytes:
    return mutated(data.decode(), pick)


def _as_rows(data: bytes, pick: Random) -> bytes:
    return mutated_rows(data.decode(), pick)


_BY_ENDING: Mapping[str, Change] = {
    **dict.fromkeys(("xml", "osm", "xodr", "json"), _as_text),
    **dict.fromkeys(("csv", "txt"), _as_rows),
}


@dataclass(frozen=True)
class Packed:
    """Parts that ``pack`` makes a file of, so that mistakes within them have sums that fit."""

    parts: tuple[bytes, ...]
    pack: Callable[[list[bytes]], bytes]
    change: Change = mutated_bytes

    def whole(self) -> bytes:
        """The file without mistakes."""
        return self.pack(list(self.parts))

    def broken(self, pick: Random) -> bytes:
        """The file with mistakes in a part, or anywhere."""
        if pick.random() < 0.4:
            return mutated_bytes(self.whole(), pick)
        parts = list(self.parts)
        at = pick.randrange(len(parts))
        parts[at] = self.change(parts[at], pick)
        return self.pack(parts)


def plain(name: str, content: bytes | str) -> Packed:
    """A file of one part; its ending says whether it is text, a table, or neither."""
    data = content.encode() if isinstance(content, str) else content
    change = _BY_ENDING.get(name.rpartition(".")[2], mutated_bytes)
    return Packed((data,), lambda parts: parts[0], change)


@dataclass(frozen=True)
class Sample:
    """Files by name, of which ``entry`` is read, with the map ``roads`` if that has a name."""

    entry: str
    files: Mapping[str, Packed | bytes | str]
    roads: str = ""

    def packed(self) -> dict[str, Packed]:
        """The files by name."""
        return {
            name: file if isinstance(file, Packed) else plain(name, file)
            for name, file in self.files.items()
        }
