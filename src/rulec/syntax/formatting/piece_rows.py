"""The rows of each piece of a file, and the columns they share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final, cast

from rulec.diagnostics import Source
from rulec.files.source_detection import FILE_WORDS
from rulec.syntax.file_pieces import ExamplePieces, Piece, RulePieces, span_of
from rulec.syntax.formatting.document import (
    WIDTH,
    Break,
    ColumnMark,
    Document,
    Nest,
    group,
    on_one_line,
    run,
)
from rulec.syntax.formatting.parentheses import with_fitting_parentheses
from rulec.syntax.formatting.piece_documents import DocumentBuilder, first_leaf
from rulec.syntax.grammar import parse_piece
from rulec.syntax.keywords import CLAUSE_WORDS, HEADER_WORDS, PROVISION_WORDS
from rulec.syntax.parse_nodes import ParseNode, Start
from rulec.syntax.scanner import Token

Part = Piece | ExamplePieces | RulePieces

_TWO_WORDS: Final = {"in": "in force", "also": "also unless"}

_WORDS: Final = (
    (frozenset(HEADER_WORDS) - frozenset(FILE_WORDS))
    | (frozenset(PROVISION_WORDS) - {"define", "redefine"})
    | (CLAUSE_WORDS - {"also"} | set(_TWO_WORDS.values()))
)
"""Keywords whose contents are aligned in a column with others of their kind."""

_LONGEST_WORD: Final = 7
"""The longest keyword that is aligned; `certainty` or `semantics` would widen the column."""


@dataclass(frozen=True, slots=True)
class Pieces:
    """The pieces of one file without mistakes, laid out in their order."""

    source: Source
    tokens: list[Token]
    speller: DocumentBuilder

    def begin(self, part: Part) -> int:
        """The character at which a part begins."""
        return span_of(self.source, self.tokens, part).start

    def end(self, part: Part) -> int:
        """The character after a part."""
        return span_of(self.source, self.tokens, part).end

    def matched(self, piece: Piece) -> ParseNode:
        """The parse node of a piece."""
        span = span_of(self.source, self.tokens, piece)
        branch = parse_piece(cast("Start", piece.kind), self.source.text, span.start, span.end)
        assert isinstance(branch, ParseNode), "the file has no mistakes"
        return with_fitting_parentheses(branch)

    def item(self, piece: Piece, column: int) -> Document:
        """Rows of a header line, provision or declaration."""
        node = self.matched(piece)
        column = max(column, len(self.word(piece)) + 1)
        match node.kind:
            case "fact_item":
                return self.speller.worded(node, len("fact "))
            case "signal_item":
                return self.speller.worded(node, len("signal "), deeper=0)
            case "topics_item" | "provisions_item":
                return self.speller.block(node)
            case "define_item" | "option_item" | "param_item" | "set_item":
                broken = self._breaks_behind_equals(node)
                return self.speller.assigned(node, column, broken=broken)
            case _ if self.word(piece) in _WORDS:
                return self.speller.worded(node, column, deeper=0)
            case _:
                return self.speller.plain(node.children, node.kind)

    def clause(self, piece: Piece, column: int) -> Document:
        """A clause, whose keyword ends at ``column``."""
        node = self.matched(piece)
        if node.kind == "in_force":
            return self.speller.plain(node.children, node.kind)
        return self.speller.worded(node, max(column, len(self.word(piece)) + 1))

    def example(self, example: ExamplePieces, column: int) -> Document:
        """The rows of an example: one line, or one line per state."""
        head = self.matched(example.head)
        column = max(column, len(self.word(example)) + 1)
        start = (
            self.speller.worded(head, column)
            if len(head.children) > 1
            else on_one_line(self.speller.plain(head.children, head.kind)).ljust(column - 1)
        )
        states: list[Document] = []
        for index, piece in enumerate(example.states):
            state = self.matched(piece)
            gap = self.speller.gap(Break(), first_leaf(state).start)
            states += [*([";"] if index else []), gap, self.speller.spell(state)]
        ends = self.speller.closing_gap(" ", self.closing(example).start)
        broken = "\n" in self.source.text[self.opening(example).start : self.end(example)]
        opening = run(start, " ", ColumnMark(), "{")
        return group(opening, Nest(2, run(*states)), ends, "}", forced=broken)

    def rule_head(self, rule: RulePieces) -> Document:
        """``hard rule NAME (variables)``."""
        head = self.matched(rule.head)
        return self.speller.plain(head.children, head.kind)

    def one_line(self, rule: RulePieces, indent: int) -> str:
        """The row of a rule that fits on one line; otherwise empty."""
        end = self.end(rule)
        inside = self.source.text[self.opening(rule).start : end]
        if not rule.body or "\n" in inside or self.speller.holds_comment(end):
            return ""
        parts = [on_one_line(self.rule_head(rule)), "{"]
        for part in rule.body:
            match part:
                case ExamplePieces():
                    parts.append(on_one_line(self.example(part, 0)))
                case Piece():
                    parts.append(on_one_line(self.clause(part, 0)))
        text = " " * indent + " ".join([*parts, "}"])
        return text if len(text) <= WIDTH else ""

    def opening(self, part: ExamplePieces | RulePieces) -> Token:
        """The opening brace after the head."""
        return self.tokens[part.head.last]

    def closing(self, part: ExamplePieces | RulePieces) -> Token:
        """The closing brace."""
        return self.tokens[part.last - 1]

    def word(self, part: Part) -> str:
        """The first word of a header line, a clause or an example."""
        first = part.head.first if isinstance(part, ExamplePieces | RulePieces) else part.first
        word = self.tokens[first].text
        return _TWO_WORDS.get(word, word)

    def columns(self, parts: Sequence[Part]) -> list[int]:
        """The columns at which contents begin, shared by parts without blank lines between them."""
        columns: list[int] = []
        together: list[int] = []
        for index, part in enumerate(parts):
            width = len(self.word(part)) if self.word(part) in _WORDS else 0
            if not width or (index and self._blank_between(parts[index - 1], part)):
                columns += [max(together, default=0) + 1] * (index - len(columns))
                together.clear()
            if width <= _LONGEST_WORD:
                together.append(width)
        return columns + [max(together, default=0) + 1] * (len(parts) - len(columns))

    def _blank_between(self, before: Part, behind: Part) -> bool:
        between = self.source.text[self.end(before) : self.begin(behind)]
        return any(not line.strip() for line in between.split("\n")[1:-1])

    def _breaks_behind_equals(self, node: ParseNode) -> bool:
        equals, value = next(pair for pair in pairwise(node.children) if pair[0].kind == "EQUALS")
        return "\n" in self.source.text[equals.end : first_leaf(value).start]
