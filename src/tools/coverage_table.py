"""The table of the page ``docs/coverage.md``: which topics each national rulebook covers.

Rules are assigned to topics by marks (`topics` in `schemas`); the counts come from the books as
written and from the situations in `tests/law`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from rulec.diagnostics import RulecError, Source
from rulec.files.file_messages import WRONG_SETTINGS
from rulec.report.text.markdown import code, escaped, table
from rulec.resources import rulebooks_folder
from rulec.rulebook.overlay.rulebook_overlay import Overlay, RuleEntry, overlay, own_law
from rulec.syntax import decode, parse, tree
from rulec.toml import parsed_toml

SITUATIONS = Path(__file__).resolve().parents[2] / "tests" / "law"
PATTERNS = "schemas"
"""The rulebook that declares the topics, and that all national ones extend."""

TYPE_APPROVAL = "un-"
"""The name prefix of rulebooks on vehicle type approval, which are not national law."""

WHOLE, PART, SILENT, NOTHING = "●", "◐", "–", "·"

_SIGNS = {
    WHOLE: "complete: every rule on the topic is the book's own law with its own article, has an "
    "example that it accepts and one that it rejects, and a situation that another author wrote "
    "from the statute",
    PART: "partial, followed by what some rule lacks: `a` its own article (it is inherited, not "
    "confirmed), `e` an example, `s` a situation by another author",
    SILENT: "the book states that it has no rule on the topic, and why",
    NOTHING: "nothing",
}


@dataclass(frozen=True, slots=True)
class Book:
    """A rulebook combined with its bases, and the files in its chain that are its own law."""

    name: str
    laid: Overlay
    own: Sequence[tree.File]


Situations = Mapping[str, frozenset[str]]
"""Book -> the topics (named by rules) for which others have written a situation that tests it."""


def coverage_table() -> str:
    """Render the table of the shipped rulebooks. Raises RulecError if one has mistakes."""
    return table_of(tuple(national_books()), situations())


def table_of(books: Sequence[Book], asked: Situations) -> str:
    """Render the table of books that share the same topics."""
    topics = {name: entry.title.value for book in books for name, entry in book.laid.topics.items()}
    cells = {
        (topic, book.name): cell(book, topic, asked.get(book.name, frozenset()))
        for topic in topics
        for book in books
    }
    rows = [
        [f"{escaped(title)}: {code(topic)}", *(cells[topic, book.name] for book in books)]
        for topic, title in topics.items()
    ]
    head = ["topic", *(code(book.name) for book in books)]
    counts = {book.name: Counter(cells[topic, book.name][0] for topic in topics) for book in books}
    rows.append(["**whole**", *(f"{counts[book.name][WHOLE]}" for book in books)])
    signs = table(["sign", "what it means"], _SIGNS.items())
    return "\n\n".join([signs, _summary(cells), table(head, rows)])


def cell(book: Book, topic: str, asked: frozenset[str]) -> str:
    """A sign for how far a book covers a topic, with what its rules lack."""
    rules = [
        entry for entry in book.laid.rules.values() if topic in book.laid.topics_of(entry.item)
    ]
    if not rules:
        said = {remark.name for remark in book.laid.remarks if remark.kind != "softened"}
        named = (book.laid.topics_of(tree.RuleItem(None, tree.Name(name))) for name in said)
        return SILENT if any(topic in topics for topics in named) or topic in said else NOTHING
    lacking = "".join(sorted({letter for rule in rules for letter in _lacks(book, rule, asked)}))
    return f"{PART} {lacking}" if lacking else WHOLE


def _lacks(book: Book, entry: RuleEntry, asked: frozenset[str]) -> Iterator[str]:
    rule = entry.item
    if rule.cite is None or not any(entry.law is file for file in book.own):
        yield "a"
    if {example.accepts for example in rule.examples} != {True, False}:
        yield "e"
    if not any(_asks(topic, rule.name.text, book) for topic in asked):
        yield "s"


def _asks(topic: str, rule: str, book: Book) -> bool:
    """Whether a situation on a topic tests a rule: by the rule's name, or by a prefix of it.

    A prefix counts only if the book has no rule of exactly that name.
    """
    return topic == rule or (rule.startswith(f"{topic}_") and topic not in book.laid.rules)


def _summary(cells: Mapping[tuple[str, str], str]) -> str:
    signs = Counter(text[0] for text in cells.values())
    shares = (
        f"{signs[sign]:,} {word} ({100 * signs[sign] // len(cells)} %)"
        for sign, word in (
            (WHOLE, "whole"),
            (PART, "in part"),
            (SILENT, "silent with a reason"),
            (NOTHING, "nothing"),
        )
    )
    topics = {topic for topic, _ in cells}
    empty = sum(
        all(text[0] in SILENT + NOTHING for (of, _), text in cells.items() if of == topic)
        for topic in topics
    )
    return (
        f"{len(topics):,} topics in {len(cells) // len(topics):,} books are {len(cells):,} cells: "
        f"{', '.join(shares)}. Topics on which no book has a rule: {empty}."
    )


def national_books() -> Iterator[Book]:
    """The shipped rulebooks of national laws that use the shared patterns, by name."""
    for path in sorted(rulebooks_folder().glob("*/*.rules")):
        if path.stem != path.parent.name or path.stem.startswith(TYPE_APPROVAL):
            continue
        chain = _chain(path.stem)
        if chain[-1].law is not None and chain[0].name == tree.Name(PATTERNS):
            yield Book(path.stem, overlay(chain, {}, unsure=False), own_law(chain))


@cache
def _chain(name: str) -> tuple[tree.File, ...]:
    path = rulebooks_folder() / name / f"{name}.rules"
    file, mistakes = parse(decode(path.name, path.read_bytes()))
    if mistakes:
        raise RulecError(mistakes)
    return (*(_chain(file.extends.name.text) if file.extends else ()), file)


def situations(folder: Path = SITUATIONS) -> Situations:
    """The situations that people other than a book's authors wrote, in a folder and its ``asked``.

    A situation counts if it, or its file, says ``independent = true``; it tests the rules that are
    its topics, or that it violates.
    """
    asked: dict[str, frozenset[str]] = {}
    for path in (*sorted(folder.glob("*.toml")), *sorted(folder.glob("asked/*.toml"))):
        text = path.read_text(encoding="utf-8")
        file: dict[str, Any] = parsed_toml(Source(path.name, text), WRONG_SETTINGS, "")
        for one in (*file.get("case", ()), *file.get("situation", ())):
            if one.get("independent", file.get("independent", False)):
                rules = frozenset(one.get("topics") or one["violated"])
                for book in one.get("verdicts") or one["law"]:
                    asked[book] = asked.get(book, frozenset()) | rules
    return asked
