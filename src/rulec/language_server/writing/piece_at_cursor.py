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
    grammar's terminals that can follow. ``in_vocabulary``: it is inside its braces. ``heads`` are
    the tokens of the heads that it is under: of its rule, and its example.
    """

    start: int
    kind: Start | None
    tokens: tuple[Token, ...]
    accepted: frozenset[str]
    in_vocabulary: bool
    heads: tuple[Token, ...]

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
    parts = list(FileSplitter(Source("", before), tokens).split()) if tokens else []
    last = parts[-1] if parts else None
    kind: Start | None = "item"
    piece, heads = last, tuple[Piece, ...]()
    if isinstance(last, RulePieces):
        kind, piece, heads = _in_rule(last, tokens)
    elif last is None or tokens[-1].text == "{":
        kind, piece = None, None
    inside: list[Token] = []
    accepted = frozenset[str]()
    if piece is not None and kind is not None:
        inside = _tokens_of(piece, tokens)
        accepted = accepted_after(kind, before[inside[0].start :] if inside else "")
    above = (token for head in heads for token in _tokens_of(head, tokens))
    in_vocabulary = names.file.kind == "vocabulary" and bool(tokens)
    return PieceAtCursor(
        start, kind, tuple(inside), accepted, in_vocabulary=in_vocabulary, heads=tuple(above)
    )


def _is_balanced(tokens: list[Token]) -> bool:
    signs = [token.text for token in tokens if token.kind == "symbol"]
    return signs.count("{") == signs.count("}")


def _in_rule(
    rule: RulePieces, tokens: list[Token]
) -> tuple[Start | None, Piece | None, tuple[Piece, ...]]:
    """What is being written at the end of a rule: its kind, what there is of it, and its heads."""
    closing = tokens[rule.last - 1].text
    if closing == "}" and _is_balanced(tokens[rule.first : rule.last]):
        return None, None, ()
    if not rule.body and closing not in ("{", "}"):
        return "rule_head", rule.head, ()
    part = rule.body[-1] if rule.body else None
    if part is None or (tokens[-1].text == "}" and _is_balanced(_tokens_of(part, tokens))):
        return "clause", None, ()
    if isinstance(part, Piece):
        return "clause", part, (rule.head,)
    if part.states:
        return "state", part.states[-1], (rule.head, part.head)
    return "example_head", part.head, (rule.head,)


def _tokens_of(part: Piece | ExamplePieces | RulePieces, tokens: list[Token]) -> list[Token]:
    first = part.head.first if isinstance(part, ExamplePieces) else part.first
    return tokens[first : part.last]
