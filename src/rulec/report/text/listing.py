"""What there is, as a list for people or as JSON."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from textwrap import shorten

from rulec.report.findings.source_excerpt import visible

LONGEST_TITLE = 90


@dataclass(frozen=True, slots=True)
class Listed:
    """A name to ask for something by, what it is, and the file that it comes from, if any."""

    name: str
    title: str
    path: str | None = None


def as_text(kinds: Mapping[str, Sequence[Listed]]) -> str:
    """A line for each thing, below its kind's name if there are several kinds."""
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
    """An object with a list for each kind."""
    document = {
        kind: [{"name": one.name, "title": one.title, "path": one.path} for one in listed]
        for kind, listed in kinds.items()
    }
    return json.dumps(document, ensure_ascii=False, indent=2)
