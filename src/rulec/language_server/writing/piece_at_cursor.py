"""The piece of a text that is being written, up to the cursor."""

from __future__ import annotations

from dataclasses import dataclass

from rulec.diagnostics import RulecError, Source
from rulec.language_server.names.name_occurrences import DocumentNames
from rulec.syntax.file_pieces import ExamplePieces, Piece, RulePieces
from rulec.syntax.grammar import accepted_after
from rulec.syntax.parse_nodes import Start
from rulec.syntax.scanner import Token, scan
from rulec.syntax.split_file import FileSplitter


@dataclass(frozen=True, slots=True)
class PieceAtCursor:
    """The piece of a text up to the name at the cursor, which begins at character ``start``.

    ``tokens`` are the piece's tokens, ``kind`` is its syntactic kind; ``accepted`` are the
    grammar's terminals that can follow. ``in_rule`` and ``in_vocabulary``: it is inside their
    braces. ``heads`` are the tokens of the heads that it is under: of its rule, and its example.
    """

    start: int
    kind: Start | None
    tokens: tuple[Token, ...]
    accepted: frozenset[str]
    in_rule: bool
    in_vocabulary: bool
    heads: tuple[Token, ...] = ()

    def text(self, back: int = 1) -> str:
        """The text of a token, counted back from the cursor; empty before the piece."""
        return self.tokens[-back].text if back <= len(self.tokens) else ""

    @property
    def first(self) -> str:
        """The piece's first word."""
        return self.tokens[0].text if self.tokens else ""


def piece_at(names: DocumentNames, offset: int) -> PieceAtCursor | None:
    """The piece at a character of the document; None in a comment or a string."""
    text = names.checked.text
    start = offset
    while start > 0 and (text[start - 1].isalnum() or text[start - 1] == "_"):
        start -= 1
    before = text[:start]
    line = before[before.rfind("\n") + 1 :]
    if "#" in line and line.count('"', 0, line.index("#")) % 2 == 0:
        return None
    try:
        tokens = scan(Source("", before))
    except RulecError:
        return None
    if tokens and tokens[-1].kind in ("unterminated", "quoted"):
        return None
    in_vocabulary = names.file.kind == "vocabulary" and bool(tokens)
    parts = list(FileSplitter(Source("", before), tokens).split()) if tokens else []
    last = parts[-1] if parts else None
    if isinstance(last, RulePieces):
        closed = last.body or tokens[last.last - 1].text in ("{", "}")
        if tokens[last.last - 1].text == "}" and _is_balanced(tokens[last.first : last.last]):
            return _none_yet(start, in_vocabulary=in_vocabulary)
        if not closed:
            return _of("rule_head", last.head, start, (before, tokens))
        return _in_rule(last, start, (before, tokens))
    if last is None or tokens[-1].text == "{":
        return _none_yet(start, in_vocabulary=in_vocabulary)
    return _of("item", last, start, (before, tokens), in_vocabulary=in_vocabulary)


def _is_balanced(tokens: list[Token]) -> bool:
    signs = [token.text for token in tokens if token.kind == "symbol"]
    return signs.count("{") == signs.count("}")


def _in_rule(rule: RulePieces, start: int, read: tuple[str, list[Token]]) -> PieceAtCursor:
    part = rule.body[-1] if rule.body else None
    ended = read[1][-1].text == "}"
    heads = _inside(rule.head, read[1])
    if part is None or (ended and _is_balanced(_tokens_of(part, read[1]))):
        return _none_yet(start, "clause", in_rule=True)
    if isinstance(part, ExamplePieces):
        if part.states:
            heads += _inside(part.head, read[1])
            return _of("state", part.states[-1], start, read, in_rule=True, heads=heads)
        return _of("example_head", part.head, start, read, in_rule=True, heads=heads)
    return _of("clause", part, start, read, in_rule=True, heads=heads)


def _inside(piece: Piece, tokens: list[Token]) -> tuple[Token, ...]:
    return tuple(tokens[piece.first : piece.last])


def _none_yet(
    start: int,
    kind: Start | None = None,
    *,
    in_rule: bool = False,
    in_vocabulary: bool = False,
) -> PieceAtCursor:
    """A place where a piece may begin, with at most its first word written."""
    return PieceAtCursor(
        start,
        kind,
        tokens=(),
        accepted=frozenset(),
        in_rule=in_rule,
        in_vocabulary=in_vocabulary,
    )


def _tokens_of(part: Piece | ExamplePieces, tokens: list[Token]) -> list[Token]:
    first = part.head.first if isinstance(part, ExamplePieces) else part.first
    return tokens[first : part.last]


def _of(
    kind: Start,
    piece: Piece,
    start: int,
    read: tuple[str, list[Token]],
    *,
    in_rule: bool = False,
    in_vocabulary: bool = False,
    heads: tuple[Token, ...] = (),
) -> PieceAtCursor:
    before, tokens = read
    inside = _inside(piece, tokens)
    text = before[inside[0].start :] if inside else ""
    return PieceAtCursor(
        start,
        kind,
        tokens=inside,
        accepted=accepted_after(kind, text),
        in_rule=in_rule,
        in_vocabulary=in_vocabulary,
        heads=heads,
    )
