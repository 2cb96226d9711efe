"""What several rulebooks say on a topic, side by side, as text, Markdown, page, JSON or CSV."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import groupby

from rulec.report.rulebooks.document.book_document import NO_ADVICE
from rulec.report.rulebooks.rule_list import as_json, first_provision, rules_named
from rulec.report.text.html_page import as_html
from rulec.report.text.markdown import (
    CONTENTS,
    Block,
    Heading,
    PageTexts,
    escaped,
    with_contents,
    written,
)
from rulec.report.text.outgoing import csv_text
from rulec.report.text.terminal_text import broken, column_lines, cut, styled, visible
from rulec.rulebook.rulebook_model import Rule, Rulebook, cited_law
from rulec.rulebook.rules.rule_topics import by_group

_APART = (
    "Rules of one name stand together. A rulebook without a rule of that name may say the same in "
    "another one."
)

MOST_LINES = 40
"""A text has at most as many lines as fit on a screen, unless it is wanted in full."""


@dataclass(frozen=True, slots=True)
class _Section:
    """A rule or a topic, what each rulebook says on it, and which ones say nothing."""

    title: str
    says: tuple[tuple[str, Rule, int], ...]
    """A rulebook's name, its rule, and how many more it has."""
    silent: tuple[tuple[str, str], ...]
    """A rulebook's name, and its reason if it has given one."""


def render(
    books: Sequence[Rulebook], topic: str, output_format: str, width: int, *, in_full: bool
) -> str:
    """Write rulebooks with only the rules on a topic, in the order given.

    Text has a width in characters. It is as detailed as fits on a screen, with every sentence only
    ``in_full``.
    """
    match output_format:
        case "json":
            return as_json(books)
        case "csv":
            cells = (
                (section.title, book, cited_law(rule.cite, rule.inherited_from), rule.says)
                for section in _rules(books)
                for book, rule, _ in section.says
            )
            return csv_text([("rule", "rulebook", "cite", "says"), *cells], "\n").rstrip("\n")
        case "markdown":
            return _as_markdown(books, topic)
        case "html":
            return as_html(_as_markdown(books, topic), PageTexts(_title(books, topic), CONTENTS))
        case _:
            return _as_text(books, topic, width, in_full=in_full)


def _title(books: Sequence[Rulebook], topic: str) -> str:
    return f"{', '.join(book.name for book in books)} on {topic}"


def _dates(books: Sequence[Rulebook]) -> str:
    """The days of the books' texts, as far as they say; empty if none does."""
    days = [f"{book.name} {book.as_of}" for book in books if book.as_of]
    return f"law as of: {', '.join(days)}" if days else ""


def _as_text(books: Sequence[Rulebook], topic: str, width: int, *, in_full: bool) -> str:
    counts = ", ".join(f"{len(book.rules):,}" for book in books)
    more = "" if in_full else " (-v: every sentence)"
    title = f"{_title(books, topic)}: {counts} rules{more}"
    head = broken(visible(title), width, later="  ")
    dates = broken(visible(said), width, later="  ") if (said := _dates(books)) else []
    layouts: list[Callable[[], list[str]]] = [
        lambda: _wrapped(_rules(books), width),
        lambda: _in_lines(_rules(books), width),
        lambda: _in_lines(_topics(books), width),
    ]
    for layout in layouts:
        below = layout()
        if in_full or len(head) + len(below) <= MOST_LINES:
            break
    if in_full or len(head) + len(dates) + len(below) <= MOST_LINES:
        head += dates
    return "\n".join([*head, *below])


def _rules(books: Sequence[Rulebook]) -> list[_Section]:
    names = [name for below in by_group(books).values() for name in below]
    return [_section(name, [name], books) for name in names]


def _topics(books: Sequence[Rulebook]) -> list[_Section]:
    """A section for each topic, with the first rule that a rulebook has on it."""
    titles = {topic.name: topic.title for book in books for topic in book.topics}
    topics = {rule.name: rule.topics[0] for book in books for rule in book.rules}
    below: dict[str, list[str]] = {}
    for name in (name for names in by_group(books).values() for name in names):
        below.setdefault(titles[topics[name]], []).append(name)
    return [_section(title, names, books) for title, names in below.items()]


def _section(title: str, names: Sequence[str], books: Sequence[Rulebook]) -> _Section:
    says, silent = [], []
    for book in books:
        own = [rule for name in names for rule in rules_named(name, [book]).values()]
        if own:
            says.append((book.name, own[0], len(own) - 1))
        else:
            remarks = (remark.because for remark in book.remarks if remark.name in names)
            silent.append((book.name, next(remarks, "")))
    return _Section(title, tuple(says), tuple(silent))


def _wrapped(sections: Sequence[_Section], width: int) -> list[str]:
    """All sentences, each once for the rulebooks that share it."""
    lines = []
    for section in sections:
        lines.append(styled(visible(section.title), "bold"))
        for books, *texts in _said(section):
            text = "  ".join(filter(None, (books, *texts)))
            lines += broken(visible(text), width, "  ", "      ")
    return lines


def _said(section: _Section) -> list[tuple[str, str, str]]:
    """What is said, each once: the rulebooks that share it, the provision, and the sentence."""
    alike: dict[tuple[str, str], list[str]] = {}
    for book, rule, _ in section.says:
        cite = cited_law(rule.cite, rule.inherited_from)
        alike.setdefault((cite, rule.says), []).append(book)
    for book, because in section.silent:
        alike.setdefault(("", f"no rule of this name{because and f': {because}'}"), []).append(book)
    return [(", ".join(books), *texts) for texts, books in alike.items()]


def _in_lines(sections: Sequence[_Section], width: int) -> list[str]:
    """A line for each rulebook, or one for what only one of them has."""
    rows = [
        (visible(book), visible(_provisions(rule, more)), visible(rule.says))
        for section in sections
        for book, rule, more in section.says
        if len(section.says) > 1
    ]
    table = iter(column_lines(rows, width, indent="  "))
    lines = []
    for section in sections:
        if len(section.says) > 1:
            lines.append(styled(cut(visible(section.title), width), "bold"))
            lines += [next(table) for _ in section.says]
        for book, rule, more in section.says if len(section.says) == 1 else ():
            text = f"{section.title}, only {book}: {_provisions(rule, more)}: {rule.says}"
            lines.append(cut(visible(text), width))
    return lines


def _provisions(rule: Rule, more: int) -> str:
    return f"{first_provision(rule)}{f' (+{more})' if more else ''}"


def _as_markdown(books: Sequence[Rulebook], topic: str) -> str:
    topics = {topic.name: topic.title for book in books for topic in book.topics}
    titles = {rule.name: topics[rule.topics[0]] for book in books for rule in book.rules}
    body: list[Block] = []
    for title, sections in groupby(_rules(books), lambda section: titles[section.title]):
        body.append(Heading(2, title))
        for section in sections:
            said = [
                f"- **{escaped(books)}**{cite and f' ({escaped(cite)})'}: {escaped(says)}"
                for books, cite, says in _said(section)
            ]
            body += [Heading(3, section.title), "\n".join(said)]
    head: list[Block] = [
        Heading(1, _title(books, topic)),
        NO_ADVICE,
        _APART,
        *filter(None, [_dates(books)]),
    ]
    return written(with_contents(head, CONTENTS, body))
