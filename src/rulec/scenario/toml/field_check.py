"""Check a table of a scenario file against its schema.

All of its bad fields are reported.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, TypeVar, get_args

import msgspec

from rulec.diagnostics import Diagnostic, did_you_mean, nearest_name
from rulec.diagnostics.code import Code
from rulec.scenario.scenario_messages import MISSING_OR_UNKNOWN_FIELD, UNFITTING_FIELD
from rulec.scenario.toml.field_locations import TomlTable, TomlText

T = TypeVar("T", bound=msgspec.Struct)


@dataclass(frozen=True, slots=True)
class Findings:
    """The file being read, and the mistakes in it so far."""

    text: TomlText
    errors: list[Diagnostic] = field(default_factory=list)

    def add(
        self,
        code: Code,
        message: str,
        table: TomlTable,
        key: str | None = None,
        *,
        expected: str = "",
        way_out: str = "",
    ) -> None:
        """Add a mistake in a table, or in one of its fields.

        ``expected`` is a thing.
        """
        place = self.text.place(table, key)
        expected = expected and f"expected {expected}"
        self.errors.append(code.at(place, message, expected=expected, help=way_out))


def read_table(kind: type[T], raw: object, table: TomlTable, findings: Findings) -> T | None:
    """A table as a ``kind``, or None if it had mistakes.

    The mistakes are then in ``findings``.
    """
    if not isinstance(raw, Mapping):
        findings.add(
            UNFITTING_FIELD, f"{table.words} is {shown(raw)}", table, expected="a table of fields"
        )
        return None
    known = {info.name: info for info in msgspec.structs.fields(kind)}
    values: dict[str, Any] = {}
    misspelt: set[str | None] = set()
    before = len(findings.errors)
    for key, value in raw.items():
        if key not in known:
            misspelt.add(_unknown_field(key, list(known), table, findings))
            continue
        try:
            values[key] = msgspec.convert(value, known[key].type)
        except msgspec.ValidationError as error:
            where = _inside(str(error))
            findings.add(
                UNFITTING_FIELD,
                f"{table.words}: `{key}`{where} is {shown(_at(value, str(error)))}",
                table,
                key,
                expected=words_of(known[key].type),
            )
    for key, info in known.items():
        if info.required and key not in raw and key not in misspelt:
            findings.add(
                MISSING_OR_UNKNOWN_FIELD,
                f"{table.words} has no `{key}`",
                table,
                expected=words_of(info.type),
                way_out=table.remedy(key),
            )
    return kind(**values) if len(findings.errors) == before else None


def shown(value: object) -> str:
    """A value in the file's spelling, quoted and shortened.

    Tables and lists are in words.
    """
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


def words_of(kind: object) -> str:
    """A field's description in words, the outermost of its type."""
    for part in (*getattr(kind, "__metadata__", ()), *get_args(kind)):
        if isinstance(part, msgspec.Meta):
            if part.description:
                return part.description
        elif words := words_of(part):
            return words
    return ""


def _unknown_field(key: str, known: list[str], table: TomlTable, findings: Findings) -> str | None:
    """Report an unknown field and the known one probably meant.

    There may be none close by.
    """
    findings.add(
        MISSING_OR_UNKNOWN_FIELD,
        f"{table.words} has a field {quoted(key)} that does not exist",
        table,
        key,
        expected=f"one of {', '.join(map(quoted, known))}",
        way_out=did_you_mean(key, known) or "leave it out",
    )
    return nearest_name(key, known)


def _indices(message: str) -> list[int]:
    path = re.search(r"at `\$([^`]*)`", message)
    return [int(number) for number in re.findall(r"\[(\d+)\]", path.group(1))] if path else []


def _inside(message: str) -> str:
    return "".join(f", number {i + 1}" for i in _indices(message))


def _at(value: Any, message: str) -> object:
    for index in _indices(message):
        value = value[index]
    return value
