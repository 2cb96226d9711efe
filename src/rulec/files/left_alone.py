"""Files in searched folders that were skipped, and why."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class LeftAlone:
    """A file or folder that was skipped, and why."""

    path: str
    why: str


def in_words(left_alone: Sequence[LeftAlone], most: int = 3) -> str:
    """How much was skipped, and why, with the first names of each kind; empty for nothing."""
    kinds = Counter(file.why for file in left_alone)
    return "; ".join(
        f"{count:,} {why} ({_first([file.path for file in left_alone if file.why == why], most)})"
        for why, count in kinds.items()
    )


def _first(names: Sequence[str], most: int) -> str:
    return ", ".join([*names[:most], *(["…"] if len(names) > most else [])])
