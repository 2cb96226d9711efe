"""The layout of a file: its pieces, comments and blank lines in order, with aligned columns."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Final

from rulec.diagnostics import Source
from rulec.syntax.file_pieces import ExamplePieces, Piece, RulePieces
from rulec.syntax.formatting.comments import Comment, blank_line_before, comments_of
from rulec.syntax.formatting.document import WIDTH, LaidOutLine, lay_out
from rulec.syntax.formatting.piece_documents import DocumentBuilder
from rulec.syntax.formatting.piece_rows import Part, Pieces
from rulec.syntax.scanner import scan
from rulec.syntax.split_file import FileSplitter

_BEFORE_COMMENT = 2


def align_marks(rows: Iterable[tuple[LaidOutLine | None, int]]) -> None:
    """Align the column marks that were aligned in the file.

    Args:
        rows: consecutive rows, each with the column of its mark in the file; None for what has no
            mark and comes between two that have.
    """
    for (_, marked), together in groupby(rows, key=lambda entry: (entry[1], entry[0] is not None)):
        same = [row for row, _ in together if row is not None]
        column = max((row.mark for row in same), default=0)
        if not marked or any(len(row.code) + column - row.mark > WIDTH for row in same):
            continue
        for row in same:
            at = row.mark
            row.code = row.code[:at] + " " * (column - at) + row.code[at:]


def with_comments(rows: Sequence[LaidOutLine]) -> list[str]:
    """Lines with trailing comments, aligned if they were aligned before."""
    commented = [row for row in rows if row.comment is not None]
    for _, group in groupby(commented, key=lambda row: row.comment and row.comment.column):
        same = list(group)
        column = max(len(row.code) for row in same)
        if any(_width(row, len(row.code)) <= WIDTH < _width(row, column) for row in same):
            continue
        for row in same:
            row.code = row.code.ljust(column)
    gap = " " * _BEFORE_COMMENT
    return [row.code + (f"{gap}{row.comment.text}" if row.comment else "") for row in rows]


def _width(row: LaidOutLine, column: int) -> int:
    assert row.comment is not None, "only rows with comments are asked for"
    return column + _BEFORE_COMMENT + len(row.comment.text)


_INDENT: Final = 2


def arranged(source: Source) -> str:
    """The canonical form of a file without mistakes."""
    tokens = scan(source)
    parts = list(FileSplitter(source, tokens).split())
    speller = DocumentBuilder(deque(comments_of(source, tokens)))
    block = _Block(source.text, speller, Pieces(source, tokens, speller), [])
    end = len(source.text)
    if tokens[0].text == "vocabulary":
        name, *items = parts
        opening, closing = tokens[name.last], tokens[-1]
        block.add([name], 0, 0)
        block.in_braces(items, opening.end, closing.start)
        block.add([], closing.end, end)
    else:
        block.add(parts, 0, end)
    return "".join(f"{line}\n" for line in with_comments(block.rows))


@dataclass(frozen=True, slots=True)
class _Block:
    """Writes pieces below one another, indented by ``indent``, into ``rows``."""

    text: str
    speller: DocumentBuilder
    pieces: Pieces
    rows: list[LaidOutLine]
    indent: int = 0

    def add(self, parts: Sequence[Part], begin: int, end: int) -> None:
        """Write parts, with the comments around them from ``begin`` to ``end``."""
        marks: list[tuple[LaidOutLine | None, int]] = []
        behind, after_rule = begin, False
        columns = self.pieces.columns(parts)
        for part, column in zip(parts, columns, strict=True):
            start = self.pieces.begin(part)
            comments = self._take(start)
            mine = self._rows(part, column)
            rule = isinstance(part, RulePieces) and len(mine) > 1
            blanks = self._blanks([*(comment.start for comment in comments), start], behind)
            blanks[0] = blanks[0] or after_rule
            # The comments directly above a rule belong to it.
            blanks[0] = blanks[0] or (rule and not any(blanks))
            self._add_comments(comments, blanks)
            self._add_row(mine[0], blank=blanks[-1])
            self.rows.extend(mine[1:])
            marks.append(self._mark(part, mine))
            behind, after_rule = self.pieces.end(part), rule
        align_marks(marks)
        comments = self._take(end)
        blanks = self._blanks([comment.start for comment in comments], behind)
        self._add_comments(comments, [after_rule or blanks[0], *blanks[1:]] if blanks else [])

    def in_braces(self, parts: Sequence[Part], begin: int, end: int) -> None:
        """Write braces after the last row, with their content below."""
        if not parts and not self.speller.holds_comment(end):
            self.rows[-1].code += " {}"
            return
        self.rows[-1].code += " {"
        self.rows[-1].opens = True
        inner = _Block(self.text, self.speller, self.pieces, self.rows, self.indent + _INDENT)
        inner.add(parts, begin, end)
        self.rows.append(LaidOutLine(" " * self.indent + "}"))

    def _rows(self, part: Part, column: int) -> list[LaidOutLine]:
        match part:
            case RulePieces():
                one_line = self.pieces.one_line(part, self.indent)
                return [LaidOutLine(one_line)] if one_line else self._rule(part)
            case ExamplePieces():
                return lay_out(self.pieces.example(part, column), self.indent)
            case Piece("clause"):
                return lay_out(self.pieces.clause(part, column), self.indent)
            case Piece():
                return lay_out(self.pieces.item(part, column), self.indent)

    def _rule(self, rule: RulePieces) -> list[LaidOutLine]:
        # The brace stands behind the head.
        head = lay_out(self.pieces.rule_head(rule), self.indent, WIDTH - len(" {"))
        block = _Block(self.text, self.speller, self.pieces, head, self.indent)
        block.in_braces(rule.body, self.pieces.opening(rule).end, self.pieces.closing(rule).start)
        return block.rows

    def _take(self, until: int) -> tuple[Comment, ...]:
        """Take comments up to a position; return those on their own lines.

        A trailing comment is put on the last row.
        """
        trailing, own = self.speller.take(until)
        if trailing is not None:
            self.rows[-1].comment = trailing
        return own

    def _blanks(self, starts: Sequence[int], behind: int) -> list[bool]:
        """The author's blank lines. Text before ``behind`` was inside a piece."""
        return [start >= behind and blank_line_before(self.text, start) for start in starts]

    def _add_comments(self, comments: Sequence[Comment], blanks: Sequence[bool]) -> None:
        for comment, blank in zip(comments, blanks):  # noqa: B905 - what follows may have one more
            self._add_row(LaidOutLine(" " * self.indent + comment.text), blank=blank)

    def _add_row(self, row: LaidOutLine, *, blank: bool) -> None:
        if blank and self.rows and not self.rows[-1].opens:
            self.rows.append(LaidOutLine(""))
        self.rows.append(row)

    def _mark(self, part: Part, rows: Sequence[LaidOutLine]) -> tuple[LaidOutLine | None, int]:
        if isinstance(part, ExamplePieces) and len(rows) == 1:
            brace = self.pieces.opening(part).start
            return rows[0], brace - self.text.rfind("\n", 0, brace)
        return None, 0
