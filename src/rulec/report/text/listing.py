"""Lists of names, as text or as JSON."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from msgspec import UNSET, UnsetType

from rulec.report.json_document import JsonDocument, as_indented
from rulec.report.text.terminal_text import column_lines, visible


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


def as_text(kinds: Mapping[str, Sequence[Listed]], width: int) -> str:
    """Write a line for each name, cut to a width, below its kind if there are several."""
    indent = "  " if len(kinds) > 1 else ""
    rows = [(visible(x.name), visible(x.title)) for listed in kinds.values() for x in listed]
    table = iter(column_lines(rows, width, indent=indent))
    lines = []
    for kind, listed in kinds.items():
        lines += [kind] if indent else []
        lines += [next(table) for _ in listed] or [f"{indent}none"]
    return "\n".join(lines)


def as_json(kinds: Mapping[str, Sequence[Listed]]) -> str:
    """Write an object with a list for each kind."""
    lists: Mapping[str, Any] = kinds
    return as_indented(ListingDocument(**lists))
