"""The tables of the page ``docs/vocabulary.md``, from the file of the vocabulary ``road``.

Each item of the file has a comment above it, `SUPPLIER: what it means`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from rulec.diagnostics import RulecError, Source
from rulec.resources import rulebooks_folder
from rulec.syntax import decode, parse, tree

ROAD = rulebooks_folder() / "vocabulary" / "road.rules"


@dataclass(frozen=True, slots=True)
class Word:
    """A declared word; ``holds`` describes its values; ``default`` is None if it has none."""

    name: str
    about: str
    holds: str
    default: str | None
    meaning: str
    supplier: str


def road_tables() -> str:
    """Render the vocabulary ``road``."""
    return vocabulary_tables(decode(ROAD.name, ROAD.read_bytes()))


def vocabulary_tables(source: Source) -> str:
    """Render a vocabulary's file. Raises RulecError if it has mistakes."""
    file, mistakes = parse(source)
    if mistakes:
        raise RulecError(mistakes)
    types = [_type_row(item) for item in file.items if isinstance(item, tree.TypeItem)]
    marks = _marks(file.items)
    words = [word for item in file.items for word in _words(item, marks)]
    return "\n".join(
        [
            "## Types of objects\n",
            *_table(("type", "is a", "meaning"), types),
            "\n## About an object\n",
            *_word_table([word for word in words if word.about]),
            "\n## About ego and the world\n",
            *_word_table([word for word in words if not word.about]),
            *_definitions(file.items),
            *_facts(file.items),
        ]
    )


def _definitions(items: Sequence[tree.Item]) -> Iterator[str]:
    """A section with what words mean where no source tells them, if the file has any."""
    defined = [item for item in items if isinstance(item, tree.ParamItem | tree.DefineItem)]
    if defined:
        yield "\n## What words mean\n"
        yield "Where a source does not tell a word, its definition does; a rulebook may `set` the"
        yield "parameters and `redefine` the words.\n"
        yield "```rulec"
        yield from (dedented for item in defined for dedented in _dedented(item.span.text))
        yield "```"


def _dedented(text: str) -> Iterator[str]:
    first, *rest = text.splitlines()
    yield first
    yield from (line.removeprefix("  ") for line in rest)


def _facts(items: Sequence[tree.Item]) -> Iterator[str]:
    """A section with the facts, if the file has any."""
    facts = [item for item in items if isinstance(item, tree.FactItem)]
    if facts:
        yield "\n## What always holds\n"
        yield "A trace or an example that contradicts a fact that a rule reads is an error.\n"
    for item in facts:
        yield f"- `{' '.join(item.span.text.split()).removeprefix('fact ')}`"


def comment_above(item: tree.Item) -> str:
    """The comment on the lines directly above an item, as one line of text."""
    source = item.span.source
    number = source.position(item.span.start)[0] - 1
    lines: list[str] = []
    while number and source.line(number).lstrip().startswith("#"):
        lines.insert(0, source.line(number).strip().lstrip("#").strip())
        number -= 1
    return " ".join(lines)


def _marks(items: Sequence[tree.Item]) -> dict[str, str]:
    """Name -> its marks *constant* and *presumed*, from the lines that declare them."""
    marks: dict[str, str] = {}
    for item in items:
        if isinstance(item, tree.ConstantItem | tree.PresumedItem):
            mark = "constant" if isinstance(item, tree.ConstantItem) else "presumed"
            marks |= {name.text: f"{marks.get(name.text, '')}, *{mark}*" for name in item.names}
    return marks


def _words(item: tree.Item, marks: Mapping[str, str]) -> Iterator[Word]:
    for word in _bare_words(item):
        yield replace(word, holds=word.holds + marks.get(word.name, ""))


def _bare_words(item: tree.Item) -> Iterator[Word]:
    supplier, _, meaning = comment_above(item).partition(": ")
    match item:
        case tree.EnumerationItem(name, parameters, values, default):
            holds = ", ".join(f"`{value.text}`" for value in values)
            default_text = None if default is None else f"`{default.text}`"
            yield Word(name.text, _about(parameters), holds, default_text, meaning, supplier)
        case tree.SignalItem(signals, default):
            default_text = None if default is None else f"`{str(default).lower()}`"
            for signal in signals:
                yield Word(
                    signal.name.text,
                    _about(signal.parameters),
                    "signal",
                    default_text,
                    meaning,
                    supplier,
                )
        case tree.QuantityItem(name, parameters, unit, default):
            default_text = None if default is None else f"{default:g}"
            yield Word(name.text, _about(parameters), f"in {unit}", default_text, meaning, supplier)


def _about(parameters: Sequence[tree.Parameter]) -> str:
    return ", ".join(
        parameter.name.text
        if parameter.type is None
        else f"{parameter.name.text}: {parameter.type.text}"
        for parameter in parameters
    )


def _type_row(item: tree.TypeItem) -> tuple[str, ...]:
    parent = "" if item.parent is None else f"`{item.parent.text}`"
    return f"`{item.name.text}`", parent, comment_above(item).partition(": ")[2]


def _word_table(words: Sequence[Word]) -> Iterator[str]:
    head = ("word", "values", "default", "meaning", "supplied by")
    rows = [
        (
            f"`{word.name}({word.about})`" if word.about else f"`{word.name}`",
            word.holds,
            word.default or "–",
            word.meaning,
            word.supplier.lower(),
        )
        for word in words
    ]
    return _table(head, rows)


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> Iterator[str]:
    yield _row(head)
    yield "|" + "---|" * len(head)
    yield from map(_row, rows)


def _row(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"
