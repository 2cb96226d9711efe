"""Splits a file into header lines, declarations and rules.

Where braces are missing, the next item that begins on its own line shows where they belong; such
structural mistakes are reported here, one for each.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from rulec.diagnostics import Diagnostic, Source
from rulec.syntax.file_pieces import Piece, RulePieces
from rulec.syntax.item_boundaries import Landmarks
from rulec.syntax.keywords import CLAUSE_WORDS
from rulec.syntax.messages.structure import StructureMessages
from rulec.syntax.scanner import Token
from rulec.syntax.split_rule import RuleSplitter

_OWN_CLAUSES = {
    "provisions": "certainty",
    **dict.fromkeys(("option", "param", "set", "define", "redefine"), "cite"),
}
"""Words of items that may have a clause of rules, and the word of that clause."""


@dataclass(slots=True)
class FileSplitter:
    """Walks over the tokens once, in linear time."""

    source: Source
    tokens: list[Token]
    mistakes: list[Diagnostic] = field(default_factory=list)
    marks: Landmarks = field(init=False)
    say: StructureMessages = field(init=False)

    def __post_init__(self) -> None:
        self.marks = Landmarks(self.tokens)
        self.say = StructureMessages(self.source, self.tokens)

    def split(self) -> Iterator[Piece | RulePieces]:
        """Split a file into pieces; ``mistakes`` is complete after the last."""
        rules = RuleSplitter(self.tokens, self.marks, self.say, self.mistakes)
        index, count = 0, len(self.tokens)
        opened: int | None = None
        closed: int | None = None
        if count and self.marks.is_word(0, "vocabulary"):
            head = self._vocabulary_line()
            yield head
            index = head.last
            if self.marks.is_symbol(index, "{"):
                opened, index = index, index + 1
            elif self._has_spare_close(index):
                opened = index
        while index < count:
            if self.marks.is_symbol(index, "}") and opened is not None:
                opened, closed, index = None, index, index + 1
                if index < count:
                    self.mistakes.append(self.say.behind_vocabulary(index, closed))
                    yield Piece("junk", index, count, reported=True)
                    index = count
            elif self.marks.is_symbol(index, "}") or self.marks.begins_clause(index):
                self.mistakes.append(self.say.outside(index, closed))
                end = self._skip_to_item(index + 1)
                yield Piece("junk", index, end, reported=True)
                index = end
            elif self.marks.begins_rule(index):
                rule = rules.rule(index)
                yield rule
                index, closed = rule.last, rule.last - 1
            else:
                end = self._over_block(self._end_of_item(index))
                yield Piece("item", index, end)
                index = end
        if opened is not None:
            self.mistakes.append(self.say.no_close("the vocabulary", opened, count))

    def _vocabulary_line(self) -> Piece:
        end = self._end_of_item(0)
        if self.marks.is_symbol(end, "{"):
            return Piece("item", 0, end)
        return Piece("item", 0, end, then=self.say.no_open(end - 1, "the vocabulary's items"))

    def _has_spare_close(self, index: int) -> bool:
        depth = 0
        for token in self.tokens[index:]:
            depth += (token.text == "{") - (token.text == "}")
            if depth < 0:
                return True
        return False

    def _end_of_item(self, index: int) -> int:
        end = index + 1
        own = _OWN_CLAUSES.get(self.tokens[index].text, "")
        while end < len(self.tokens):
            if self.marks.is_symbol(end, "{") or self.marks.is_symbol(end, "}"):
                break
            if self.marks.begins_item(end):
                break
            is_clause = self.tokens[end].first and self.marks.is_word(end, *CLAUSE_WORDS)
            if is_clause and not self.marks.is_word(end, own):
                break
            end += 1
        return end

    def _over_block(self, index: int) -> int:
        depth = 0
        while index < len(self.tokens):
            if depth and self.marks.begins_item_inside(index):
                break
            if depth == 0 and not self.marks.is_symbol(index, "{"):
                break
            depth += self.marks.is_symbol(index, "{") - self.marks.is_symbol(index, "}")
            index += 1
        return index

    def _skip_to_item(self, index: int) -> int:
        while index < len(self.tokens) and not self.marks.begins_item_inside(index):
            index += 1
        return index
