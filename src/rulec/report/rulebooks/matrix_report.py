"""Many rulebooks side by side, as text, Markdown, page, JSON or CSV."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from textwrap import fill

from rulec.analysis.diff.comparison_matrix import ComparisonMatrix, SharedRule, pairs
from rulec.report.json_document import JsonDocument, JsonPart, as_indented
from rulec.report.rulebooks.diff_formats import as_csv
from rulec.report.rulebooks.diff_json import BookData, book_data
from rulec.report.rulebooks.diff_text import WIDTH
from rulec.report.text.markdown import code, escaped
from rulec.report.text.markdown import table as markdown_table
from rulec.report.text.terminal_text import styled, table_lines, visible
from rulec.rulebook.rulebook_model import Strength

SIGNS = {"equal": "=", "stricter": "+", "laxer": "-", "incomparable": "~", "undecided": "?"}
"""What stands behind a number of rules."""

ABSENT, SILENT = ".", "/"

RULES = (
    "rules: rulebooks with the same letter forbid the same traces; small letters are soft rules, "
    f"`{ABSENT}` is no such rule, `{SILENT}` a rule that was dropped or passed over in silence"
)

PAIRS = (
    "pairs: how many rules of the rulebook on the left are the same as those of the one above (=), "
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


def render(comparison_matrix: ComparisonMatrix, output_format: str) -> str:
    """The matrix in one of the formats of differences."""
    match output_format:
        case "json":
            return _as_json(comparison_matrix)
        case "csv":
            return _as_csv(comparison_matrix)
        case "markdown":
            return _as_markdown(comparison_matrix)
        case "html":
            # markdown-it and Pygments take 0.1 s.
            from rulec.report.text.html_page import as_html

            return as_html(_as_markdown(comparison_matrix), TITLE, "")
        case "text":
            return _as_text(comparison_matrix)
    raise ValueError(f"there is no format {output_format}")


def _as_text(comparison_matrix: ComparisonMatrix) -> str:
    names = [book.name for book in comparison_matrix.books]
    by_rule = [
        ["", *names],
        *([rule.name, *_letters(rule, names)] for rule in comparison_matrix.shared),
    ]
    by_pair = [
        ["", *names],
        *([name, *(_cell(comparison_matrix, name, other) for other in names)] for name in names),
    ]
    blocks = [
        fill(RULES, WIDTH),
        _columns(by_rule),
        fill(PAIRS, WIDTH),
        _columns(by_pair),
        _summary(comparison_matrix),
    ]
    return "\n\n".join(blocks)


def _columns(rows: Sequence[Sequence[str]]) -> str:
    head, *lines = table_lines([[visible(cell) for cell in row] for row in rows])
    return "\n".join([styled(head, "bold"), *lines])


def _letters(rule: SharedRule, names: Sequence[str]) -> list[str]:
    return [_letter(rule, name) for name in names]


def _letter(rule: SharedRule, book: str) -> str:
    if book not in rule.laws:
        return SILENT if book in rule.remarks else ABSENT
    letter = rule.letter(book)
    return letter if rule.rules[book].strength == "hard" else letter.lower()


def _cell(comparison_matrix: ComparisonMatrix, left: str, right: str) -> str:
    if left == right:
        return ""
    counted = comparison_matrix.counts(left, right)
    parts = [f"{counted[kind]}{sign}" for kind, sign in SIGNS.items() if counted[kind]]
    return " ".join(parts) or ABSENT


def _summary(comparison_matrix: ComparisonMatrix) -> str:
    counted = Counter(len(set(rule.laws.values())) == 1 for rule in comparison_matrix.shared)
    return (
        f"{len(comparison_matrix.books):,} rulebooks, "
        f"{len(comparison_matrix.shared):,} rules that two or more of them have, "
        f"{counted[True]:,} of them the same in all"
    )


def _as_markdown(comparison_matrix: ComparisonMatrix) -> str:
    names = [book.name for book in comparison_matrix.books]
    head = ["", *map(code, names)]
    return "\n\n".join(
        [
            f"# {TITLE}",
            f"{escaped(_summary(comparison_matrix))}.",
            "## Rule by rule",
            f"{RULES.partition(': ')[2].capitalize()}.",
            markdown_table(
                head,
                [
                    [code(rule.name), *map(escaped, _letters(rule, names))]
                    for rule in comparison_matrix.shared
                ],
            ),
            "## Pair by pair",
            f"{escaped(PAIRS.partition(': ')[2].capitalize())}.",
            markdown_table(
                head,
                [
                    [
                        code(name),
                        *(escaped(_cell(comparison_matrix, name, other)) for other in names),
                    ]
                    for name in names
                ],
            ),
        ]
    )


def _as_csv(comparison_matrix: ComparisonMatrix) -> str:
    rows = [
        (rule.name, one, other, rule.relation(one, other) or "")
        for rule in comparison_matrix.shared
        for one, other in pairs(comparison_matrix.books)
        if one in rule.laws and other in rule.laws
    ]
    return as_csv([("rule", "first", "second", "relation"), *rows])


def _as_json(matrix: ComparisonMatrix) -> str:
    names = [book.name for book in matrix.books]
    return as_indented(
        MatrixDocument(
            books=[book_data(book) for book in matrix.books],
            rules=[_shared_rule(rule, names) for rule in matrix.rules],
            pairs=[_book_pair(matrix, first, second) for first, second in pairs(matrix.books)],
        )
    )


def _shared_rule(rule: SharedRule, names: Sequence[str]) -> SharedRuleData:
    books = [
        RuleInBook(
            name=name,
            law=rule.letter(name) or None,
            strength=rule.rules[name].strength if name in rule.rules else None,
            because=rule.remarks[name].because if name in rule.remarks else None,
        )
        for name in names
    ]
    return SharedRuleData(rule=rule.name, books=books)


def _book_pair(matrix: ComparisonMatrix, first: str, second: str) -> BookPairData:
    counts = matrix.counts(first, second)
    by_relation = {relation: counts[relation] for relation in (*SIGNS, "only", "silent")}
    return BookPairData(first=first, second=second, **by_relation)
