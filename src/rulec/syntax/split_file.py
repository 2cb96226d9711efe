"""Splits a file into header lines, declarations and rules.

Where braces are missing, the next item that begins on its own line shows where they belong; such
structural mistakes are reported here, one for each.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from rulec.diagnostics import Diagnostic, Source
from rulec.syntax.file_pieces import ExamplePieces, Piece, RulePieces
from rulec.syntax.item_boundaries import Landmarks
from rulec.syntax.keywords import CLAUSE_WORDS
from rulec.syntax.messages.structure import StructureMessages
from rulec.syntax.scanner import Token

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


_WITH_FORMULA = ("require", "when", "unless", "also", "accept", "reject")


@dataclass(frozen=True, slots=True)
class RuleSplitter:
    """Splits rules and adds structural mistakes to ``mistakes``."""

    tokens: list[Token]
    marks: Landmarks
    say: StructureMessages
    mistakes: list[Diagnostic]

    def rule(self, first: int) -> RulePieces:
        """The rule whose head begins at token ``first``."""
        index = first + 1
        while not self._ends_head(index):
            index += 1
        if self.marks.is_symbol(index, "{"):
            opened, index = index, index + 1
            head = Piece("rule_head", first, opened)
        elif (brace := self._brace_behind_clauses(index)) is not None:
            head = Piece("rule_head", first, index, then=self.say.before_brace(index))
            opened, index = brace, brace + 1
        else:
            opened = index - 1
            confirms = self.marks.is_word(first, "confirm")
            missing = self.say.no_open(opened, "the rule's clauses", confirms=confirms)
            head = Piece("rule_head", first, index, then=missing)
            if not (self._at_clause(index) or self.marks.begins_misspelt(index)):
                index += self.marks.is_symbol(index, "}")
                return RulePieces(head, (), first, index)
        body: list[Piece | ExamplePieces] = []
        while index < len(self.tokens) and not self.marks.begins_item_inside(index):
            if self.marks.is_symbol(index, "}"):
                return RulePieces(head, tuple(body), first, index + 1)
            if self.tokens[index].text in ("accept", "reject"):
                example, ended = self._example(index)
                body.append(example)
                index = example.last
                if ended:
                    return RulePieces(head, tuple(body), first, index)
            else:
                known = self.marks.is_word(index, *CLAUSE_WORDS, "in")
                end = self._end_of_clause(index)
                body.append(Piece("clause" if known else "junk", index, end))
                index = end
        self.mistakes.append(self.say.no_close("the rule", opened, index))
        return RulePieces(head, tuple(body), first, index)

    def _brace_behind_clauses(self, index: int) -> int | None:
        """The ``{`` of a rule behind clauses that belong into it, such as ``in force``."""
        if not self._at_clause(index):
            return None
        while index < len(self.tokens) and not self.marks.begins_item_inside(index):
            if self.marks.is_symbol(index, "{"):
                return index
            if self.marks.is_word(index, *_WITH_FORMULA) or self.marks.is_symbol(index, "}"):
                return None
            index += 1
        return None

    def _at_clause(self, index: int) -> bool:
        return index < len(self.tokens) and self.marks.begins_clause(index)

    def _ends_head(self, index: int) -> bool:
        return (
            index >= len(self.tokens)
            or self.marks.is_symbol(index, "{")
            or self.marks.is_symbol(index, "}")
            or self.marks.begins_clause(index)
            or self.marks.begins_item_inside(index)
            or (self.marks.begins_misspelt(index) and not self.marks.is_word(index - 1, "rule"))
        )

    def _end_of_clause(self, first: int) -> int:
        index, parentheses = first + 1, 0
        braces = int(self.marks.is_symbol(first, "{"))
        while index < len(self.tokens):
            if self.marks.begins_clause(index) or self.marks.begins_item_inside(index):
                break
            symbol = self.marks.symbol(index)
            if braces == 0 and (
                symbol == "}" or self._begins_anew(first, index, inside=parentheses > 0)
            ):
                break
            braces += (symbol == "{") - (symbol == "}")
            parentheses = max(0, parentheses + (symbol == "(") - (symbol == ")"))
            index += 1
        return index

    def _begins_anew(self, clause: int, index: int, *, inside: bool) -> bool:
        """Whether a clause with a misspelt keyword begins here.

        The keyword is a name on its own line where a formula cannot have one: after something
        complete, after ``cite`` and ``says``, before a brace or a text.
        """
        if self.tokens[index].first and self.marks.is_word(index, "in"):
            return True
        if self.tokens[index].first and self.marks.is_word(index, "if"):
            return self.marks.is_word(clause, "cite", "says", "source", "certainty")
        if not (self.tokens[index].first and self.marks.is_name(index)):
            return False
        if self.marks.goes_on(index) and self.marks.is_word(clause, "unless", "also", "in"):
            return False
        if self.marks.begins_misspelt(index):
            return True
        complete = not self.marks.wants_more(index - 1)
        return not inside and (complete or self.marks.is_word(clause, "cite", "says"))

    def _example(self, first: int) -> tuple[ExamplePieces, bool]:
        opened = first + 1
        while not self._ends_head(opened) and not self.marks.is_symbol(opened, ";"):
            opened += 1
        if not self.marks.is_symbol(opened, "{"):
            return self._example_without_open(first, opened), False
        head = Piece("example_head", first, opened)
        states: list[Piece] = []
        index = begin = opened + 1
        depth = 0
        while index < len(self.tokens):
            if self.marks.begins_clause(index) or self.marks.begins_item_inside(index):
                break
            symbol = self.marks.symbol(index)
            if depth == 0 and symbol in ("}", ";"):
                states.append(Piece("state", begin, index))
                begin = index + 1
                if symbol == "}":
                    return ExamplePieces(head, tuple(states), begin), False
            depth += (symbol == "{") - (symbol == "}")
            index += 1
        self.mistakes.append(self.say.no_close("the example", opened, index))
        states.append(Piece("state", begin, index, reported=begin == index))
        return ExamplePieces(head, tuple(states), index), index == len(self.tokens)

    def _example_without_open(self, first: int, index: int) -> ExamplePieces:
        """Split an example whose opening brace is missing.

        In ``accept b; l }`` the next ``}`` belongs to the example unless the rule would then lack
        one.
        """
        label = self.tokens[first + 1] if first + 1 < len(self.tokens) else None
        if label is not None and label.kind == "unterminated" and "{" in label.text:
            # The missing quote has swallowed the braces: that is the one mistake.
            return ExamplePieces(Piece("example_head", first, first + 2), (), first + 2)
        end = index
        while not self._ends_head(end):
            end += 1
        behind = end + 1
        if self.marks.is_symbol(end, "}") and (
            self.marks.is_symbol(behind, "}") or self._at_clause(behind)
        ):
            end = behind
        labelled = label is not None and label.kind == "string"
        self.mistakes.append(self.say.no_open(first + labelled, "the example's states"))
        return ExamplePieces(Piece("example_head", first, end, reported=True), (), end)
