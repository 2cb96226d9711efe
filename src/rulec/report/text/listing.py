"""Lists of names, for people or as JSON."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from textwrap import shorten
from typing import Any

from msgspec import UNSET, UnsetType

from rulec.report.findings.source_excerpt import visible
from rulec.report.json_document import JsonDocument, as_indented

LONGEST_TITLE = 90


@dataclass(frozen=True, slots=True)
class Listed:
    """A name, its title, and the file behind it, if any."""

    name: str
    title: str
    path: str | None = None


class ListingDocument(JsonDocument, frozen=True, kw_only=True):
    """A list for each kind asked for; names without file lack paths."""

    rulebooks: Sequence[Listed] | UnsetType = UNSET
    vocabularies: Sequence[Listed] | UnsetType = UNSET
    scenarios: Sequence[Listed] | UnsetType = UNSET
    codes: Sequence[Listed] | UnsetType = UNSET


def as_text(kinds: Mapping[str, Sequence[Listed]]) -> str:
    """Write a line for each name, below its kind if several."""
    width = max((len(one.name) for listed in kinds.values() for one in listed), default=0)
    blocks = []
    for kind, listed in kinds.items():
        lines = [visible(f"{one.name:<{width}}  {_short(one.title)}").rstrip() for one in listed]
        if len(kinds) > 1:
            lines = [kind, *(f"  {line}" for line in lines or ["none"])]
        blocks.append("\n".join(lines))
    return "\n".join(blocks)


def _short(title: str) -> str:
    return shorten(title, LONGEST_TITLE, placeholder=" …")


def as_json(kinds: Mapping[str, Sequence[Listed]]) -> str:
    """Write an object with a list for each kind."""
    lists: Mapping[str, Any] = kinds
    return as_indented(ListingDocument(**lists))
