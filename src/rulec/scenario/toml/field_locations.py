"""Source locations of the fields of a TOML file.

TOML readers hand out values without positions. Headings and keys that stand on lines of their own,
as everybody writes them, are found again here; for others the message names the field in words.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cached_property

from rulec.diagnostics import Source, SourceLocation

_HEADING = re.compile(r"\s*(\[{1,2})\s*([A-Za-z_][\w.-]*)\s*\]{1,2}\s*(?:#.*)?$")
_KEY = re.compile(r"""\s*(["']?)([^"'=\s]+)\1\s*=""")


@dataclass(frozen=True, slots=True)
class TomlTable:
    """A table of the file: its heading, number and name.

    The number, from 1, is that in an array of tables.
    """

    heading: str
    number: int | None
    words: str

    def remedy(self, key: str) -> str:
        """The advice for a missing field."""
        if not self.heading and key in ("road", "ego"):
            return f"add a table `[{key}]`"
        return f"add a line `{key} = …`"


@dataclass(frozen=True)
class TomlText:
    """A file's name and text."""

    source: Source

    def place(self, table: TomlTable, key: str | None = None) -> SourceLocation:
        """The line of a key or its table's heading, else the file."""
        number = table.number or 0
        line = self._lines.get((table.heading, number, key))
        if line is None:
            line = self._lines.get((table.heading, number, None))
        if line is None:
            return SourceLocation(self.source.name)
        excerpt = self.source.line(line)
        start = len(excerpt) - len(excerpt.lstrip())
        end = len(excerpt.rstrip())
        return SourceLocation(self.source.name, line, start + 1, line, end + 1, excerpt=excerpt)

    @cached_property
    def _lines(self) -> dict[tuple[str, int, str | None], int]:
        lines: dict[tuple[str, int, str | None], int] = {}
        counts: dict[str, int] = {}
        heading, number = "", 0
        for line, text in enumerate(self.source.text.split("\n"), start=1):
            if match := _HEADING.match(text):
                heading = match.group(2)
                if match.group(1) == "[[":
                    counts[heading] = counts.get(heading, 0) + 1
                owner = heading if heading in counts else heading.rpartition(".")[0]
                number = counts.get(owner, 0)
                lines.setdefault((heading, number, None), line)
            elif match := _KEY.match(text):
                lines.setdefault((heading, number, match.group(2)), line)
        return lines
