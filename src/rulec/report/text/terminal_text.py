"""Text for terminals: without control characters, coloured, in columns; long counts and lists."""

from __future__ import annotations

import os
import re
import sys
import unicodedata
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from textwrap import wrap
from typing import TextIO

from click import unstyle

from rulec.resources import variable_set

MOST_DIGITS = 30

_PLAIN, _COLORED = "NO_COLOR", "FORCE_COLOR"

_STYLES = {
    "bold": "1",
    "red": "31",
    "green": "32",
    "yellow": "33",
    "blue": "34",
    "magenta": "35",
    "cyan": "36",
}
"""Words for styles of text -> what selects them on a terminal (ECMA-48)."""

_JOINT, _SECOND_COLUMN = "\0", "\1"
"""Stand for a space at which no line may be broken, and for the second half of a wide character."""

_LONGEST_CUT = 12
"""A beginning of a word that is longer than this is shown where a line ends."""

_KEPT_TOGETHER = re.compile(
    r"(?:§|\b(?:Abs|Art|No|Nr|Reg|Sec)\.|\b(?:Rule|state)) (?=\d)"
    r"|\d (?=(?:km/h|m/s²?|ms|s|min|h|m|km|t|kg|%)(?![\w/]))"
)

HIDDEN = (
    "\x00-\x08\x0b-\x1f\x7f-\x9f\ud800-\udfff\u2028\u2029\ufeff"
    "\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069"
)
"""Control characters but for tabs and line feeds, surrogates, line ends, and reordering marks."""

_NOT_VISIBLE = re.compile(f"[\t\n{HIDDEN}]")


def visible(text: str) -> str:
    """Escape control characters, line ends and reordering marks in a text."""
    return text if text.isprintable() else _NOT_VISIBLE.sub(as_escape, text)


def as_escape(match: re.Match[str]) -> str:
    """The character that was matched, as Python escapes it."""
    code = ord(match[0])
    return f"\\x{code:02x}" if code < 256 else f"\\u{code:04x}"


@contextmanager
def colored(choice: str) -> Iterator[None]:
    """Use colour ``always``, ``never``, or ``auto`` (by stream) in a block.

    It is set in the environment, so that it also applies to other processes.
    """
    plain = os.environ.get(_PLAIN) if choice == "auto" else None
    with (
        variable_set(_PLAIN, "1" if choice == "never" else plain),
        variable_set(_COLORED, "1" if choice == "always" else None),
    ):
        yield


def wants_color(stream: TextIO) -> bool:
    """Whether to use colour, by environment (no-color.org, force-color.org) and terminal."""
    if os.environ.get(_PLAIN):
        return False
    return bool(os.environ.get(_COLORED)) or stream.isatty()


def styled(text: str, style: str, color: bool | None = None) -> str:
    """A text in a style, such as ``bold red``.

    ``color``: whether escape sequences are allowed; None: as standard output wants it.
    """
    if not text or not (wants_color(sys.stdout) if color is None else color):
        return text
    codes = ";".join(_STYLES[word] for word in style.split())
    return f"\x1b[{codes}m{text}\x1b[0m" if codes else text


def cell_width(text: str) -> int:
    """The columns that a text takes on a terminal, ignoring its style."""
    plain = unstyle(text) if "\x1b" in text else text
    return len(plain) if plain.isascii() else sum(map(_columns, plain))


def _columns(character: str) -> int:
    if unicodedata.east_asian_width(character) in "WF":
        return 2
    return int(unicodedata.category(character) not in ("Mn", "Me", "Cf"))


def table_lines(
    rows: Sequence[Sequence[str]],
    *,
    indent: str = "",
    gap: str = "  ",
    right: Sequence[int] = (),
    ruled: Sequence[int] = (),
) -> list[str]:
    """Rows with aligned columns, a line each.

    Args:
        rows: the same number of cells in each, which may be styled.
        indent: the beginning of every line.
        gap: the text between columns.
        right: the columns to align on the right.
        ruled: the rows below which to draw a line.
    """
    columns = list(zip(*rows, strict=True))
    measured = columns if right or ruled else columns[:-1]
    widths = [max(map(cell_width, column)) for column in measured]
    rule = indent + "─" * (sum(widths) + len(gap) * (len(widths) - 1))
    lines = []
    for number, row in enumerate(rows):
        cells = list(row)
        for column, width in enumerate(widths):
            blank = " " * (width - cell_width(cells[column]))
            cells[column] = blank + row[column] if column in right else row[column] + blank
        lines.append(f"{indent}{gap.join(cells)}".rstrip())
        if number in ruled:
            lines.append(rule)
    return lines


def stacked_tables(
    rows: Sequence[Sequence[str]],
    width: int,
    *,
    indent: str = "",
    ruled: Sequence[int] = (),
    is_of_numbers: bool = False,
) -> list[str]:
    """A table as above; if it is wider than a width, its columns go on below, after the first.

    If it is of numbers, all columns but the first are aligned on the right.
    """
    titles, *columns = zip(*rows, strict=True)
    lines: list[str] = []
    while columns:
        for number in range(len(columns), 0, -1):
            part = list(zip(titles, *columns[:number], strict=True))
            right = range(1, number + 1) if is_of_numbers else ()
            table = table_lines(part, indent=indent, ruled=ruled, right=right)
            if max(map(cell_width, table)) <= width:
                break
        lines += ["", *table] if lines else table
        columns = columns[number:]
    return lines


def broken(
    text: str, width: int, first: str = "", later: str = "", *, at_hyphens: bool = True
) -> list[str]:
    """A text wrapped to a width, never between "§" and its number, or "30" and "km/h".

    Args:
        text: the text to wrap.
        width: the most columns of a line.
        first: the beginning of the first line.
        later: the beginning of the other lines.
        at_hyphens: whether words may be broken there; paths should not.
    """
    joined = _KEPT_TOGETHER.sub(lambda match: match[0][:-1] + _JOINT, text)
    # What takes two columns counts as two characters.
    wide = _as_wide(joined)
    lines = wrap(
        wide,
        max(width, cell_width(first) + 20, cell_width(later) + 20) - (wide != joined),
        initial_indent=_as_wide(first),
        subsequent_indent=_as_wide(later),
        break_on_hyphens=at_hyphens,
    )
    return [line.replace(_JOINT, " ").replace(_SECOND_COLUMN, "") for line in lines]


def _as_wide(text: str) -> str:
    """As many characters as the text takes columns."""
    if text.isascii():
        return text
    return "".join(x + _SECOND_COLUMN * (_columns(x) == 2) for x in text)


def cut(text: str, width: int) -> str:
    """A plain text on one line of at most this width, which ends in "…" where it goes on."""
    if cell_width(text) <= width:
        return text
    line, used = "", 0
    for character in text:
        used += cell_width(character)
        if used > width - 2:
            break
        line += character
    head, _, word = line.rpartition(" ")
    return f"{head if head.strip() and len(word) <= _LONGEST_CUT else line} …"


def clipped(text: str, widest: int) -> str:
    """A text, cut to a number of characters."""
    return text if len(text) <= widest else f"{text[: widest - 1]}…"


def column_lines(rows: Sequence[Sequence[str]], width: int, *, indent: str = "") -> list[str]:
    """Plain rows with columns, a line each, cut to a width.

    A column is as wide as nine in ten of its cells; a wider cell moves those to its right. One
    without any text is left out.
    """
    rows = list(zip(*(column for column in zip(*rows, strict=True) if any(column)), strict=True))
    widths = [
        sorted(map(cell_width, column))[len(column) * 9 // 10 if len(column) > 9 else -1]
        for column in list(zip(*rows, strict=True))[:-1]
    ]
    lines = []
    for row in rows:
        line = indent
        end = len(indent)
        for cell, column in zip(row, widths, strict=False):
            end += column + 2
            line += cell + " " * max(2, end - cell_width(line) - cell_width(cell))
        room = width - cell_width(line)
        last = cut(row[-1], room) if room >= _LONGEST_CUT else ""
        lines.append(cut(f"{line}{last}".rstrip(), width))
    return lines


def fact_lines(facts: Sequence[tuple[str, str]], width: int) -> list[str]:
    """Names with texts beside them, or below long names, which are wrapped to a width."""
    shown = [(visible(name), visible(text)) for name, text in facts]
    widths = [cell_width(name) for name, _ in shown]
    column = max((own for own in widths if own <= width * 3 // 5), default=0)
    lines = []
    for (name, text), own in zip(shown, widths, strict=True):
        if own > column:
            lines += broken(name, width, "  ", "  ")
            name, own = "", 0
        beside = f"  {name}{' ' * (column - own)}  "
        lines += broken(text, width, beside, " " * (column + 4)) or [beside.rstrip()]
    return lines


def shown_count(count: int) -> str:
    """A count for readers: exact if short, otherwise its magnitude."""
    digits = str(count)
    if len(digits) <= MOST_DIGITS:
        return f"{count:,}"
    return f"about {digits[0]}.{digits[1:3]}e{len(digits) - 1}"


def counted(number: int, noun: str, several: str = "") -> str:
    """A number with its noun, such as ``1 file`` and ``1,000 files``."""
    return f"{number:,} {noun if number == 1 else several or f'{noun}s'}"


def mirrored(side: str) -> str:
    """What a report says of a mirror image, whose traffic keeps to this side."""
    before = "right" if side == "left" else "left"
    return f"recorded where traffic keeps to the {before}, judged as if it kept to the {side}"
