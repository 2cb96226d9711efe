"""The formats of recordings and maps, and the words that files of each can provide."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from rulec.extraction.tellable_words import TELLABLE_WORDS
from rulec.recordings.format_table import FORMATS
from rulec.recordings.map_files import MAP_FORMATS
from rulec.report.json_document import JsonDocument, JsonPart, as_indented, filled
from rulec.report.text import markdown
from rulec.report.text.console import PAGE_WIDTH
from rulec.report.text.terminal_text import broken, cut, table_lines
from rulec.rulebook.loader import load_vocabulary
from rulec.value_display import short_repr

TELLS = "x"
TELLS_NOT = "."


@dataclass(frozen=True, slots=True)
class ListedFormat:
    """A format of recordings or, if ``is_map``, of maps.

    ``files`` describes the names of its files, ``roads`` says where a recording's roads come from.
    ``words`` are those that some file of the format can provide, in the vocabulary's order; None if
    unknown. ``takes_map``: the roads may come from a map given separately.
    """

    __repr__ = short_repr

    name: str
    title: str
    files: str
    is_map: bool = False
    takes_map: bool = False
    roads: str = ""
    words: tuple[str, ...] | None = None


def words_in_order() -> tuple[str, ...]:
    """The words of the vocabulary `road`, in which countries' rulebooks are written."""
    return tuple(load_vocabulary("road").declarations)


def listed_formats(order: Sequence[str]) -> tuple[ListedFormat, ...]:
    """Every format of recordings, then every format of maps, with words in this order."""
    recordings = [
        ListedFormat(
            form.name,
            form.title,
            form.files,
            takes_map=form.takes_map,
            roads=form.roads,
            words=_words_of(form.name, order),
        )
        for form in FORMATS
    ]
    maps = [ListedFormat(form.name, form.title, form.files, is_map=True) for form in MAP_FORMATS]
    return (*recordings, *maps)


def _words_of(form: str, order: Sequence[str]) -> tuple[str, ...] | None:
    words = TELLABLE_WORDS.get(form)
    if words is None:
        return None
    return (*(word for word in order if word in words), *sorted(words - set(order)))


def as_text(
    listed: Sequence[ListedFormat], order: Sequence[str], *, words: bool, width: int = PAGE_WIDTH
) -> str:
    """Write each format with its files and its map, and, if wanted, a line for each word."""
    parts = []
    for title, forms in _kinds(listed):
        lines = [title]
        indent = " " * (max(len(form.name) for form in forms) + 4)
        for form in forms:
            roads = f"; map: {form.roads}" if form.roads else ""
            lines.append(cut(f"  {form.name}".ljust(len(indent)) + form.title, width))
            lines += broken(f"{form.files}{roads}", width, indent, indent)
        parts.append("\n".join(lines))
    if words:
        forms, table = _word_table(listed, order)
        heads = [f"  {number}  {form.name}" for number, form in enumerate(forms, 1)]
        numbers = [str(number) for number in range(1, len(forms) + 1)]
        lines = table_lines([("  word", *numbers), *((f"  {row[0]}", *row[1:]) for row in table)])
        title = f"words that some file of a format can provide ({TELLS}) or none can ({TELLS_NOT})"
        parts.append("\n".join([title, *heads, *lines]))
    return "\n\n".join(parts)


def as_markdown(listed: Sequence[ListedFormat], order: Sequence[str], *, words: bool) -> str:
    """Write tables of the formats, and, if wanted, one of the words."""
    parts = []
    for title, forms in _kinds(listed):
        with_map = title == _RECORDINGS
        head = (title, "name", "files", "map") if with_map else (title, "name", "files")
        rows = [
            (markdown.escaped(form.title), f"`{form.name}`", markdown.escaped(form.files))
            + ((form.roads.replace("--map", "`--map`"),) if with_map else ())
            for form in forms
        ]
        parts.append(markdown.table(head, rows))
    return "\n\n".join([*parts, words_as_markdown(listed, order)] if words else parts)


def words_as_markdown(listed: Sequence[ListedFormat], order: Sequence[str]) -> str:
    """Write the table of words and formats."""
    forms, table = _word_table(listed, order)
    marks = {TELLS: "yes", TELLS_NOT: ""}
    rows = [(f"`{word}`", *(marks[cell] for cell in cells)) for word, *cells in table]
    return markdown.table(("word", *(f"`{form.name}`" for form in forms)), rows)


_RECORDINGS = "recordings"


def _kinds(listed: Sequence[ListedFormat]) -> Iterator[tuple[str, list[ListedFormat]]]:
    for title, is_map in ((_RECORDINGS, False), ("maps", True)):
        if forms := [form for form in listed if form.is_map == is_map]:
            yield title, forms


def _word_table(
    listed: Sequence[ListedFormat], order: Sequence[str]
) -> tuple[list[ListedFormat], list[tuple[str, ...]]]:
    """The formats whose words are known, and for each word which of them provide it."""
    forms = [form for form in listed if form.words is not None]
    words_of_forms = [frozenset(form.words or ()) for form in forms]
    beyond = sorted(frozenset().union(*words_of_forms) - set(order))
    rows = [
        (word, *(TELLS if word in words else TELLS_NOT for words in words_of_forms))
        for word in (*order, *beyond)
    ]
    return forms, rows


class RecordingFormatData(JsonPart, frozen=True, kw_only=True):
    """A format of recordings; ``words`` are those that some file provides, null if unknown."""

    name: str
    title: str
    files: str
    takes_map: bool
    words: Sequence[str] | None


class MapFormatData(JsonPart, frozen=True, kw_only=True):
    """A format of maps."""

    name: str
    title: str
    files: str


class FormatsDocument(JsonDocument, frozen=True, kw_only=True):
    """The formats that can be read, in the order in which they are tried."""

    recordings: Sequence[RecordingFormatData]
    maps: Sequence[MapFormatData]


def as_json(listed: Sequence[ListedFormat]) -> str:
    """Write an object with the formats of recordings and of maps."""
    return as_indented(
        FormatsDocument(
            recordings=[filled(RecordingFormatData, form) for form in listed if not form.is_map],
            maps=[filled(MapFormatData, form) for form in listed if form.is_map],
        )
    )
