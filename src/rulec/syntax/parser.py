"""Parses a source into its tree and all its mistakes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import islice, takewhile
from types import ModuleType
from typing import TypeVar, cast

from rulec.cancellation import step
from rulec.diagnostics import Diagnostic, RulecError, Source, Span
from rulec.files.source_detection import is_foreign
from rulec.syntax import tree
from rulec.syntax.assembly import Part, assemble_file, assemble_rule
from rulec.syntax.building import formulas, items
from rulec.syntax.building.formulas import NodeValues
from rulec.syntax.file_pieces import ExamplePieces, Piece, RulePieces, span_of
from rulec.syntax.grammar import parse_piece
from rulec.syntax.keywords import DECLARATION_WORDS, HEADER_WORDS, ITEM_WORDS, RESERVED
from rulec.syntax.messages import structure
from rulec.syntax.messages.lookalikes import hidden_meaning
from rulec.syntax.parse_nodes import Mismatch, ParseNode, Start, TooDeep
from rulec.syntax.scanner import Token, checked, scan, tokens_of
from rulec.syntax.split_file import FileSplitter

MAX_PIECE = 10_000
"""The most tokens in one piece, which limits the time and memory that a formula can take."""

MOST_EXAMPLE_STATES = 10_000
"""The most states of one example, which are judged whenever its rulebook is compiled."""

_BEHIND_NAME = ("is", "in", "default", "(", "=", ":")
_NAMING_PROVISIONS = ("option", "param", "define")

NOTHING_READ = tree.File("rulebook", None, complete=False)
"""The tree of a file that cannot be read at all."""

_WORDS_BEHIND_HEAD = ITEM_WORDS.difference(HEADER_WORDS)
_SHOWN_BEHIND_HEAD = 8
"""Tokens: more than any boundary of items is decided by."""

_Built = TypeVar("_Built")


def parse(source: Source) -> tuple[tree.File, tuple[Diagnostic, ...]]:
    """Parse a file; return its syntax tree and all mistakes in order.

    Unreadable parts are left out of the tree and marked there (``BrokenItem``, ``complete``), so
    that later stages do not report them again.
    """
    try:
        own = checked(source)
        if is_foreign(own.text):
            # Another program's file, or a secret behind a link: nothing of it is repeated.
            return NOTHING_READ, (structure.no_beginning(own),)
        tokens = scan(own)
    except RulecError as error:
        return NOTHING_READ, error.diagnostics
    if not tokens:
        empty = structure.EMPTY_FILE.at(
            Span(source, 0, 0),
            "the file is empty",
            expected=structure.EXPECTED_BEGINNING,
            help=structure.HOW_TO_BEGIN,
        )
        return NOTHING_READ, (empty,)
    reader = PieceReader(source, tokens)
    splitter = FileSplitter(source, tokens)
    parts = [reader.part(part) for part in splitter.split()]
    file, order_mistakes = assemble_file(source, parts)
    hidden = hidden_meaning(source, tokens)
    mistakes = (*splitter.mistakes, *reader.mistakes, *order_mistakes, *hidden)
    return file, tuple(sorted(mistakes, key=by_place))


def parse_head(source: Source) -> tree.File:
    """The tree of a file's header lines, which come before its rules and declarations.

    Raises RulecError if the file is not a text.
    """
    tokens = _head_tokens(checked(source))
    reader = PieceReader(source, tokens)

    def is_header_line(piece: Piece | RulePieces) -> bool:
        return isinstance(piece, Piece) and tokens[piece.first].text in HEADER_WORDS

    pieces = takewhile(is_header_line, FileSplitter(source, tokens).split())
    lines = [reader.item(cast("Piece", piece)) for piece in pieces]
    return assemble_file(source, lines)[0] if lines else NOTHING_READ


def _head_tokens(source: Source) -> list[Token]:
    """The tokens of a file up to its first rule or declaration, and a few that show its end."""
    tokens: list[Token] = []
    stream = tokens_of(source)
    depth = 0
    for token in stream:
        tokens.append(token)
        if depth == 0 and token.first and token.text in _WORDS_BEHIND_HEAD:
            return [*tokens, *islice(stream, _SHOWN_BEHIND_HEAD)]
        depth += (token.text == "{") - (token.text == "}")
    return tokens


def parse_formula(text: str, name: str = "<formula>") -> tree.Formula:
    """The tree of one formula.

    Raises RulecError if it is not a formula.
    """
    source = checked(Source(name, text))
    tokens = scan(source)
    reader = PieceReader(source, tokens)
    formula = reader.read("formula", Piece("formula", 0, len(tokens)), formulas.formula)
    if formula is None:
        raise RulecError(reader.mistakes)
    return formula


def by_place(diagnostic: Diagnostic) -> tuple[int, int]:
    """A sort key: the place of the mistake."""
    return (0, 0) if diagnostic.place is None else diagnostic.place.start


def _messages() -> ModuleType:
    """The module of messages about mismatches, loaded on demand to speed up start-up."""
    from rulec.syntax.messages import mismatch  # 10 ms, only for mistakes

    return mismatch


@dataclass(frozen=True, slots=True)
class PieceReader:
    """Parses pieces; returns None for a piece with a reported mistake."""

    source: Source
    tokens: list[Token]
    mistakes: list[Diagnostic] = field(default_factory=list)

    def read(
        self, start: Start, piece: Piece, make: Callable[[NodeValues, ParseNode], _Built]
    ) -> _Built | None:
        """The value that ``make`` gives a piece that matches ``start``."""
        if piece.reported:
            return None
        span = span_of(self.source, self.tokens, piece)
        if piece.last - piece.first > MAX_PIECE:
            self.mistakes.append(_messages().too_long(self._first_token(piece), MAX_PIECE))
            return None
        match parse_piece(start, self.source.text, span.start, span.end):
            case Mismatch() as mismatch:
                why = _messages().explain(self.source, self.tokens, piece, mismatch)
                self.mistakes.append(why)
                return None
            case TooDeep():
                self.mistakes.append(_messages().too_deep(self._first_token(piece)))
                return None
            case branch:
                values = NodeValues(self.source)
                built = make(values, branch)
        if piece.then is not None:
            self.mistakes.append(piece.then)
        self.mistakes.extend(values.mistakes)
        return built

    def _first_token(self, piece: Piece) -> Span:
        token = self.tokens[piece.first]
        return Span(self.source, token.start, token.end)

    def part(self, part: Piece | RulePieces) -> Part:
        """A header line, an item or a rule."""
        step()
        return self.rule(part) if isinstance(part, RulePieces) else self.item(part)

    def item(self, piece: Piece) -> Part:
        """A header line, a declaration or the like; broken if it has a mistake."""
        return self.read("item", piece, items.item) or self._broken(piece)

    def _broken(self, piece: Piece) -> tree.BrokenItem:
        words = self.tokens[piece.first : piece.last]
        names = {token.text for token in words if token.kind == "word"} - RESERVED
        first = words[0].text
        names_one = first in (*DECLARATION_WORDS, *_NAMING_PROVISIONS)
        nameless = names_one and (len(words) < 2 or words[1].text in _BEHIND_NAME)
        span = span_of(self.source, self.tokens, piece)
        return tree.BrokenItem(frozenset(names), first, nameless, span=span)

    def rule(self, pieces: RulePieces) -> tree.RuleItem | tree.BrokenItem:
        """A rule; broken if its head has a mistake."""
        span = span_of(self.source, self.tokens, pieces)
        head_span = span_of(self.source, self.tokens, pieces.head)
        head = self.read("rule_head", pieces.head, items.rule_head)
        parts = [
            self._example(part) if isinstance(part, ExamplePieces) else self._clause(part)
            for part in pieces.body
        ]
        if head is None:
            return tree.BrokenItem(frozenset(), "rule", span=head_span)
        readable = pieces.head.then is None
        rule, mistakes = assemble_rule(head, parts, span, head_span, complete=readable)
        self.mistakes.extend(mistakes)
        return rule

    def _clause(self, piece: Piece) -> tuple[str, items.Clause | None, Span]:
        keyword = self.tokens[piece.first].text
        span = self._first_token(piece)
        if piece.kind == "junk":
            self.mistakes.append(_messages().unknown_clause(self.source, self.tokens, piece))
            return keyword, None, span
        return keyword, self.read("clause", piece, items.clause), span

    def _example(self, pieces: ExamplePieces) -> tree.ExampleItem | None:
        if len(pieces.states) > MOST_EXAMPLE_STATES:
            first, number = self._first_token(pieces.head), len(pieces.states)
            self.mistakes.append(_messages().too_many_states(first, number, MOST_EXAMPLE_STATES))
            return None
        head = self.read("example_head", pieces.head, items.example_head)
        states = [self.read("state", piece, items.state) for piece in pieces.states]
        if head is None or not states or None in states:
            return None
        span = span_of(self.source, self.tokens, pieces)
        good = cast("list[tree.ExampleState]", states)
        return replace(head, states=tuple(good), span=span)
