"""Lists of names, as text or as JSON."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from textwrap import shorten
from typing import Any

from msgspec import UNSET, UnsetType

from rulec.report.json_document import JsonDocument, as_indented
from rulec.report.text.terminal_text import table_lines, visible

LONGEST_TITLE = 90


@dataclass(frozen=True, slots=True)
class Listed:
    """A name, its title, and its file, if there is one."""

    name: str
    title: str
    path: str | None = None


class ListingDocument(JsonDocument, frozen=True, kw_only=True):
    """A list for each kind requested; names without a file have no path."""

    rulebooks: Sequence[Listed] | UnsetType = UNSET
    vocabularies: Sequence[Listed] | UnsetType = UNSET
    scenarios: Sequence[Listed] | UnsetType = UNSET
    codes: Sequence[Listed] | UnsetType = UNSET


def as_text(kinds: Mapping[str, Sequence[Listed]]) -> str:
    """Write a line for each name, below its kind if there are several."""
    rows = [
        (visible(item.name), visible(shorten(item.title, LONGEST_TITLE, placeholder=" …")))
        for listed in kinds.values()
        for item in listed
    ]
    table = iter(table_lines(rows))
    blocks = []
    for kind, listed in kinds.items():
        lines = list(islice(table, len(listed)))
        if len(kinds) > 1:
            lines = [kind, *(f"  {line}" for line in lines or ["none"])]
        blocks.append("\n".join(lines))
    return "\n".join(blocks)


def as_json(kinds: Mapping[str, Sequence[Listed]]) -> str:
    """Write an object with a list for each kind."""
    lists: Mapping[str, Any] = kinds
    return as_indented(ListingDocument(**lists))
