"""Tables of a scenario file, read by their schema, with a source location for every mistake.

TOML readers return values without positions. Headings and keys on lines of their own, the usual
style, are found again here; for others the message names the field in words.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, TypeVar, get_args

import msgspec

from rulec.diagnostics import Diagnostic, Source, SourceLocation, did_you_mean, nearest_name
from rulec.diagnostics.code import Code
from rulec.scenario.scenario_messages import (
    INCONSISTENT_SCENARIO,
    MISSING_OR_UNKNOWN_FIELD,
    UNFITTING_FIELD,
)

T = TypeVar("T", bound=msgspec.Struct)

_HEADING = re.compile(r"\s*(\[{1,2})\s*([A-Za-z_][\w.-]*)\s*\]{1,2}\s*(?:#.*)?$")
_KEY = re.compile(r"""\s*(["']?)([^"'=\s]+)\1\s*=""")


@dataclass(frozen=True)
class TomlFile:
    """The file being read, and the mistakes found in it so far."""

    source: Source
    errors: list[Diagnostic] = field(default_factory=list)

    def line(self, heading: str, number: int, key: str | None) -> int | None:
        """The line of a key, else of its table's heading; None if neither has its own line."""
        return self._lines.get((heading, number, key), self._lines.get((heading, number, None)))

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


@dataclass(frozen=True, slots=True)
class TomlTable:
    """A table of a file: name in words, heading, and number (from 1) in an array of tables."""

    file: TomlFile
    words: str
    heading: str
    number: int = 0

    def place(self, key: str | None = None) -> SourceLocation:
        """The location of a key, else of the heading, else of the file."""
        source = self.file.source
        line = self.file.line(self.heading, self.number, key)
        if line is None:
            return SourceLocation(source.name)
        excerpt = source.line(line)
        start = len(excerpt) - len(excerpt.lstrip())
        end = len(excerpt.rstrip())
        return SourceLocation(source.name, line, start + 1, line, end + 1, excerpt=excerpt)

    def add(
        self,
        message: str,
        key: str | None = None,
        *,
        expected: str = "",
        way_out: str = "",
        code: Code = INCONSISTENT_SCENARIO,
    ) -> None:
        """Add a mistake in the table or in one of its fields; ``expected`` is a noun phrase."""
        expected = expected and f"expected {expected}"
        self.file.errors.append(code.at(self.place(key), message, expected=expected, help=way_out))

    def read(self, kind: type[T], raw: object) -> T | None:
        """The table as a ``kind``, or None after adding all mistakes in its fields."""
        if not isinstance(raw, Mapping):
            self.add(
                f"{self.words} is {shown(raw)}", expected="a table of fields", code=UNFITTING_FIELD
            )
            return None
        known = {info.name: info for info in msgspec.structs.fields(kind)}
        values: dict[str, Any] = {}
        misspelt: set[str | None] = set()
        before = len(self.file.errors)
        for key, value in raw.items():
            if key not in known:
                misspelt.add(nearest_name(key, list(known)))
                self.add(
                    f"{self.words} has a field {quoted(key)} that does not exist",
                    key,
                    expected=f"one of {', '.join(map(quoted, known))}",
                    way_out=did_you_mean(key, list(known)) or "leave it out",
                    code=MISSING_OR_UNKNOWN_FIELD,
                )
                continue
            try:
                values[key] = msgspec.convert(value, known[key].type)
            except msgspec.ValidationError as error:
                where, part = "", value
                for index in _indices(str(error)):
                    where, part = f"{where}, number {index + 1}", part[index]
                self.add(
                    f"{self.words}: `{key}`{where} is {shown(part)}",
                    key,
                    expected=_words_of(known[key].type),
                    code=UNFITTING_FIELD,
                )
        for key, info in known.items():
            if info.required and key not in raw and key not in misspelt:
                is_table = not self.heading and key in ("road", "ego")
                self.add(
                    f"{self.words} has no `{key}`",
                    expected=_words_of(info.type),
                    way_out=f"add a table `[{key}]`" if is_table else f"add a line `{key} = …`",
                    code=MISSING_OR_UNKNOWN_FIELD,
                )
        return kind(**values) if len(self.file.errors) == before else None


def shown(value: object) -> str:
    """A value as the file spells it, quoted and shortened; tables and lists are only named."""
    match value:
        case bool():
            return "`true`" if value else "`false`"
        case str():
            return f'`"{_short(value)}"`'
        case Mapping():
            return "a table"
        case list():
            return f"a list of {len(value)}"
        case int() if abs(value) >= 10**30:
            return "a number of more than 30 digits"
        case _:
            return quoted(str(value))


def quoted(name: str) -> str:
    """A name in backquotes, shortened."""
    return f"`{_short(name)}`"


def _short(text: str) -> str:
    short = text if len(text) <= 40 else text[:37] + "..."
    return "".join(character if character.isprintable() else "?" for character in short)


def _words_of(kind: object) -> str:
    """The description of a field, from the outermost of its types."""
    for part in (*getattr(kind, "__metadata__", ()), *get_args(kind)):
        if isinstance(part, msgspec.Meta):
            if part.description:
                return part.description
        elif words := _words_of(part):
            return words
    return ""


def _indices(message: str) -> list[int]:
    path = re.search(r"at `\$([^`]*)`", message)
    return [int(number) for number in re.findall(r"\[(\d+)\]", path.group(1))] if path else []
