"""What benchmarks have found, kept as JSON Lines, and as the tables of the documentation."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import msgspec
from figure import COLUMNS, Result, cells


class Measured(msgspec.Struct, omit_defaults=True):
    """A line of the file: the machine first, then what each benchmark found on one input."""

    machine: list[str] = []
    name: str = ""
    result: Result | None = None


def as_lines(found: Mapping[str, Sequence[Result]], about: list[str]) -> bytes:
    """What was found by each benchmark, and about the machine, as JSON Lines."""
    sections = [
        Measured(name=name, result=result) for name, results in found.items() for result in results
    ]
    return msgspec.json.Encoder().encode_lines([Measured(about), *sections])


def tables(lines: bytes) -> str:
    """The file in Markdown."""
    parts: list[str] = []
    for line in msgspec.json.Decoder(Measured).decode_lines(lines):
        parts += (f"- {one}" for one in line.machine)
        parts += section(line.name, line.result) if line.result else ()
    return "\n".join(parts)


def section(name: str, result: Result) -> Iterator[str]:
    """A heading, what the input was, a table, and notes."""
    yield from ("", f"## {result.title}", "", f"`{name}`: {result.input}.", "")
    yield row(COLUMNS)
    yield row(["---", "---", "---:", "---:", "---:"])
    for figure in result.figures:
        yield row(cells(figure))
    if result.notes:
        yield ""
        yield from (f"- {note}" for note in result.notes)
    if result.table:
        head, *rows = result.table
        yield ""
        yield row(head)
        yield row(["---", *["---:"] * (len(head) - 1)])
        yield from map(row, rows)


def row(texts: Sequence[str]) -> str:
    """A row of a table."""
    return "| " + " | ".join(text.replace("|", "\\|") for text in texts) + " |"
