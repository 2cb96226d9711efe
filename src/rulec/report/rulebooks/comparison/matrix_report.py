"""Many rulebooks side by side, as text, Markdown, page, JSON or CSV.

Text and CSV begin with a part on the pairs of each rulebook with those before it, so that one can
read while the next is compared; the other formats are written at the end.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations, permutations
from string import ascii_uppercase, digits

from rulec.analysis.diff.comparison_matrix import ComparisonMatrix, SharedRule
from rulec.report.json_document import JsonDocument, JsonPart, as_indented, filled
from rulec.report.rulebooks.comparison.diff_formats import BookData
from rulec.report.text.html_page import as_html
from rulec.report.text.markdown import PageTexts, anchors, code, escaped
from rulec.report.text.markdown import table as markdown_table
from rulec.report.text.outgoing import csv_text
from rulec.report.text.terminal_text import broken, stacked_tables, styled, visible
from rulec.rulebook.rulebook_model import Strength

SIGNS = {"equal": "=", "stricter": "+", "laxer": "-", "incomparable": "~", "undecided": "?"}
"""Relation -> the sign after the number of rules with it."""

ABSENT, SILENT = ".", "/"

RULES = (
    "rules: rulebooks with the same letter forbid the same traces; small letters are soft rules, "
    f"`{ABSENT}` is no such rule, `{SILENT}` a rule that was dropped or passed over in silence"
)

PAIRS = (
    "pairs: how many rules of the first rulebook are the same as those of the second (=), "
    "stricter (+), laxer (-), neither (~), or undecided (?)"
)

TITLE = "Rulebooks compared"


class RuleInBook(JsonPart, frozen=True, kw_only=True):
    """A rule in one rulebook, with its law's letter; null where absent."""

    name: str
    law: str | None
    strength: Strength | None
    because: str | None


class SharedRuleData(JsonPart, frozen=True, kw_only=True):
    """A rule in each rulebook; equal letters forbid the same traces."""

    rule: str
    books: Sequence[RuleInBook]


class BookPairData(JsonPart, frozen=True, kw_only=True):
    """Counts of a rulebook's rules by their relation to another's."""

    first: str
    second: str
    equal: int
    stricter: int
    laxer: int
    incomparable: int
    undecided: int
    only: int
    silent: int


class MatrixDocument(JsonDocument, frozen=True, kw_only=True):
    """Many rulebooks side by side."""

    books: Sequence[BookData]
    rules: Sequence[SharedRuleData]
    pairs: Sequence[BookPairData]


def opening(form: str, width: int) -> str:
    """What stands above the pairs in a format; text has a width in characters."""
    if form == "csv":
        return csv_text([_HEAD], "\n").rstrip("\n")
    return "\n".join([*broken(PAIRS, width), ""]) if form == "text" else ""


def last_pairs(matrix: ComparisonMatrix, form: str, width: int) -> list[str]:
    """The lines on the last rulebook and each one before it, of those that share a rule."""
    *before, last = (book.name for book in matrix.books)
    lines: list[str] = []
    for name in before:
        if form == "csv" and (rows := _relations(matrix, name, last)):
            lines.append(csv_text(rows, "\n").rstrip("\n"))
        elif form == "text" and (cells := _signs(matrix, name, last)):
            names = "  ".join(f"{visible(own):<9}" for own in (name, last))
            numbers = "".join(f"{cell:>5}" for cell in cells)
            lines += broken(f"{names}  {numbers}".rstrip(), width, later="    ", at_hyphens=False)
    return lines


def render(matrix: ComparisonMatrix, form: str, width: int) -> str:
    """What stands below the pairs in a format; text has a width in characters."""
    match form:
        case "json":
            return _as_json(matrix)
        case "csv":
            return ""
        case "markdown":
            return _as_markdown(matrix)
        case "html":
            return as_html(_as_markdown(matrix), PageTexts(TITLE), cell_class=_cell_class)
        case _:
            return _as_text(matrix, width)


def _as_text(matrix: ComparisonMatrix, width: int) -> str:
    rows = [["", *(visible(book.name) for book in matrix.books)], *_by_rule(matrix)]
    head, *lines = stacked_tables(rows, width)
    blocks = [
        broken(RULES, width),
        [styled(head, "bold"), *lines],
        broken(_summary(matrix), width),
    ]
    return "\n" + "\n\n".join("\n".join(block) for block in blocks)


def _by_rule(matrix: ComparisonMatrix) -> list[list[str]]:
    return [
        [rule.name, *(_letter(rule, book.name) for book in matrix.books)] for rule in matrix.shared
    ]


def _letter(rule: SharedRule, book: str) -> str:
    if book not in rule.laws:
        return SILENT if book in rule.remarks else ABSENT
    letter = rule.letter(book)
    return letter if rule.rules[book].strength == "hard" else letter.lower()


def _signs(matrix: ComparisonMatrix, left: str, right: str) -> list[str]:
    """The number of rules in each relation, with its sign; nothing where two share no rule."""
    counted = matrix.counts(left, right)
    parts = [f"{counted[kind]}{sign}" * bool(counted[kind]) for kind, sign in SIGNS.items()]
    return parts if any(parts) else []


def _summary(matrix: ComparisonMatrix) -> str:
    n_same = sum(len(set(rule.laws.values())) == 1 for rule in matrix.shared)
    return (
        f"{len(matrix.books):,} rulebooks, "
        f"{len(matrix.shared):,} rules that two or more of them have, "
        f"{n_same:,} of them the same in all"
    )


_HEADINGS = (TITLE, "Rule by rule", "Pair by pair", "What each law says")


def _as_markdown(matrix: ComparisonMatrix) -> str:
    head = ["", *(code(book.name) for book in matrix.books)]
    # The anchors that the headings get on a page.
    places = anchors([*_HEADINGS, *(rule.name for rule in matrix.shared)])[len(_HEADINGS) :]
    by_rule = [
        [f"[{code(name)}](#{place})", *map(escaped, cells)]
        for place, (name, *cells) in zip(places, _by_rule(matrix), strict=True)
    ]
    by_pair = [
        [code(first), code(second), *map(escaped, cells)]
        for first, second in combinations([book.name for book in matrix.books], 2)
        if (cells := _signs(matrix, first, second))
    ]
    return "\n\n".join(
        [
            f"# {TITLE}",
            f"{escaped(_summary(matrix))}.",
            "## Rule by rule",
            f"{RULES.partition(': ')[2].capitalize()}.",
            markdown_table(head, by_rule),
            "## Pair by pair",
            f"{escaped(PAIRS.partition(': ')[2].capitalize())}.",
            markdown_table(["first", "second", *SIGNS], by_pair),
            "## What each law says",
            *(block for rule in matrix.shared for block in _laws(rule)),
        ]
    )


def _laws(rule: SharedRule) -> Iterator[str]:
    """The section on a rule: each law's letter, with what its rulebooks cite and say."""
    yield f"### {escaped(rule.name)}"
    rows = []
    for book in sorted(rule.laws, key=lambda name: (rule.laws[name], name)):
        own = rule.rules[book]
        letter = _letter(rule, book)
        rows.append([letter, code(book), own.strength, escaped(own.cite), escaped(own.says)])
    yield markdown_table(["", "rulebook", "strength", "provision", "what it says"], rows)
    remarks = [
        f"- {code(book)}: {escaped(remark.because)}"
        for book, remark in rule.remarks.items()
        if remark.because
    ]
    if remarks:
        yield "Without it, because:"
        yield "\n".join(remarks)


_COLOURS = 6
"""Number of different colours for laws on a page."""


def _cell_class(text: str) -> str:
    """The CSS class of a cell: cells with the same letter (the same law) have the same colour."""
    if text in (ABSENT, SILENT):
        return "absent"
    if len(text.rstrip(digits)) != 1 or not text[0].isalpha():
        return ""
    return f"law law{ascii_uppercase.index(text[0].upper()) % _COLOURS}"


_HEAD = ("rule", "first", "second", "relation")


def _relations(matrix: ComparisonMatrix, first: str, second: str) -> list[tuple[str, ...]]:
    """Each rule's relation between two rulebooks, in both directions."""
    return [
        (rule.name, left, right, relation)
        for rule in matrix.shared
        for left, right in ((first, second), (second, first))
        if (relation := rule.relation(left, right)) is not None
    ]


def _as_json(matrix: ComparisonMatrix) -> str:
    names = [book.name for book in matrix.books]
    rules = [
        SharedRuleData(rule=rule.name, books=[_in_book(rule, name) for name in names])
        for rule in matrix.rules
    ]
    pairs = [_book_pair(matrix, *pair) for pair in permutations(names, 2)]
    return as_indented(filled(MatrixDocument, matrix, rules=rules, pairs=pairs))


def _in_book(rule: SharedRule, book: str) -> RuleInBook:
    own, remark = rule.rules.get(book), rule.remarks.get(book)
    return RuleInBook(
        name=book,
        law=rule.letter(book) or None,
        strength=own.strength if own else None,
        because=remark.because if remark else None,
    )


def _book_pair(matrix: ComparisonMatrix, first: str, second: str) -> BookPairData:
    counts = matrix.counts(first, second)
    by_relation = {relation: counts[relation] for relation in (*SIGNS, "only", "silent")}
    return BookPairData(first=first, second=second, **by_relation)
