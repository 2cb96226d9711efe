"""Rules of one or several rulebooks by topic, a line each."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from rulec.report.json_document import JsonDocument, JsonPart, as_indented, filled
from rulec.report.text.formula_lines import plain_text
from rulec.report.text.terminal_text import broken, column_lines, counted, styled, visible
from rulec.rulebook.rulebook_model import Rule, Rulebook, Strength, cited_law
from rulec.rulebook.rules.rule_topics import OTHER, by_group

MOST_HEADS = 5
"""More rulebooks are only counted."""

if TYPE_CHECKING:
    from rulec.analysis.audit.rulebook_audit import Audit


class ListedSide(JsonPart, frozen=True, kw_only=True):
    """A rule as one rulebook has it."""

    strength: Strength
    cite: str
    says: str


class ListedRule(JsonPart, frozen=True, kw_only=True):
    """A rule, what it is about, and what each rulebook that has it says."""

    name: str
    about: str
    books: Mapping[str, ListedSide]


class RuleListDocument(JsonDocument, frozen=True, kw_only=True):
    """The rules of one or several rulebooks, by what they are about."""

    rules: Sequence[ListedRule]


def as_text(books: Sequence[Rulebook], width: int, ways_on: str) -> str:
    """Counts, then a line for each rule: its article and sentence, or the books that have it.

    ``ways_on`` says how to see more.
    """
    groups = by_group(books)
    lines = [line for book in books for line in broken(visible(_head(book)), width, later="  ")]
    if len(books) > MOST_HEADS:
        lines = [f"{counted(len(books), 'rulebook')}, {sum(map(len, groups.values())):,} rules"]
    rows = [_row(name, books) for names in groups.values() for name in names]
    table = iter(column_lines(rows, width, indent="  "))
    for heading, names in groups.items():
        lines += [] if groups.keys() == {OTHER} else [styled(visible(heading), "bold")]
        lines += [next(table) for _ in names]
    return "\n".join([*lines, *broken(ways_on, width)])


def as_json(books: Sequence[Rulebook]) -> str:
    """Write a list with an object for each rule."""
    rules = [
        ListedRule(
            name=name,
            about=heading,
            books={
                book: filled(ListedSide, rule, cite=cited_law(rule.cite, rule.inherited_from))
                for book, rule in rules_named(name, books).items()
            },
        )
        for heading, names in by_group(books).items()
        for name in names
    ]
    return as_indented(RuleListDocument(rules=rules))


def rules_named(name: str, books: Sequence[Rulebook]) -> dict[str, Rule]:
    """The rulebooks that have a rule of this name, each with its own."""
    return {book.name: rule for book in books for rule in book.rules if rule.name == name}


def _head(book: Rulebook) -> str:
    strengths = Counter(rule.strength for rule in book.rules)
    counts = [f"{strengths[kind]:,} {kind}" for kind in ("hard", "soft") if strengths[kind]]
    inherited = sum(bool(rule.inherited_from) for rule in book.rules)
    counts += [f"{inherited:,} inherited and not confirmed"] if inherited else []
    title = f"{book.title}, " if book.title else ""
    rules = f"{counted(len(book.rules), 'rule')} ({', '.join(counts)})" if counts else "no rules"
    return f"{book.name}: {title}{law_of(book)}; {rules}"


def law_of(book: Rulebook | Audit) -> str:
    """The rulebook's law and its date."""
    since = f", as of {book.as_of}" if book.as_of else ""
    return f"{book.law}{since}" if book.law else "no law is named"


def _row(name: str, books: Sequence[Rulebook]) -> tuple[str, str, str]:
    having = rules_named(name, books)
    first = next(iter(having.values()))
    says = visible(first.says or plain_text(first.required or first.formula))
    if len(books) == 1:
        soft = "(soft) " if first.strength == "soft" else ""
        return visible(name), visible(first_provision(first)), f"{soft}{says}"
    whose = " ".join(having) if len(having) < 4 else f"{len(having)} books"
    return visible(name), visible(whose), says


def first_provision(rule: Rule) -> str:
    """The first provision that a rule cites, with its rulebook where that is another's law."""
    cite = rule.cite.partition(", ")[0].partition("; ")[0]
    return f"{rule.inherited_from} {cite}".strip()
