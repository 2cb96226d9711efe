"""Names by which rulebooks of one name are distinct, such as two editions of a book."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from os.path import commonpath
from pathlib import PurePath


def edition_names(names: Sequence[str], files: Sequence[str]) -> list[str]:
    """The names of rulebooks, those that occur twice with their files, or else numbers, after them.

    ``files`` has the file of each, or whatever else it was asked for by; empty if it has none.
    """
    times = Counter(names)
    twins = [number for number, name in enumerate(names) if times[name] > 1]
    own = {number: files[number] for number in twins}
    texts = _short(own) if len(set(own.values())) == len(twins) else {}
    distinct = list(names)
    for place, number in enumerate(twins, 1):
        distinct[number] = f"{names[number]} ({texts.get(number, str(place))})"
    return distinct


def _short(files: dict[int, str]) -> dict[int, str]:
    """The paths of files from their common folder on."""
    if not all(files.values()):
        return {}
    try:
        common = PurePath(commonpath(files.values()))
    except ValueError:  # some are absolute, others are not
        return files
    short = {
        number: PurePath(file).relative_to(common).as_posix() for number, file in files.items()
    }
    return short if len(set(short.values())) == len(files) else files
