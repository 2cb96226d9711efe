"""Names, texts, dates and numbers, and the places of nodes."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from rulec.diagnostics import Diagnostic, Source, Span
from rulec.syntax import tree
from rulec.syntax.grammar import ParseLeaf, ParseNode
from rulec.syntax.literals import misleads, why_not_a_day
from rulec.syntax.messages import literal_values


@dataclass(frozen=True, slots=True)
class NodeValues:
    """Builder of one source's values; mistakes are added to ``mistakes``."""

    source: Source
    mistakes: list[Diagnostic] = field(default_factory=list)

    def span(self, node: ParseNode | ParseLeaf) -> Span:
        """The characters of a node."""
        return Span(self.source, node.start, node.end)

    def names(self, node: ParseNode, kind: str = "NAME") -> tuple[tree.Name, ...]:
        """The identifiers directly below a node."""
        return tuple(tree.Name(leaf.text, span=self.span(leaf)) for leaf in node.leaves(kind))

    def text(self, node: ParseNode) -> tree.Text:
        """The node's text in quotes, its escapes and characters checked."""
        leaf = node.leaves("STRING")[0]
        value: list[str] = []
        characters = enumerate(leaf.text[1:-1], leaf.start + 1)
        for position, character in characters:
            if character == "\\":
                _, escaped = next(characters)
                if escaped not in '"\\':
                    place = Span(self.source, position, position + 2)
                    self.mistakes.append(literal_values.unknown_escape(place, escaped))
                value.append(escaped)
            elif misleads(character):
                place = Span(self.source, position, position + 1)
                self.mistakes.append(literal_values.control_character(place))
            else:
                value.append(character)
        return tree.Text("".join(value), span=self.span(leaf))

    def date(self, leaf: ParseLeaf) -> str:
        """ISO text of a date that exists."""
        wrong = why_not_a_day(leaf.text)
        if wrong:
            self.mistakes.append(literal_values.no_such_date(self.span(leaf), leaf.text, wrong))
        return "" if wrong else leaf.text

    def number(self, leaf: ParseLeaf) -> float:
        """A finite number; 0 in place of one that is too large."""
        number = float(leaf.text)
        if not math.isfinite(number):
            self.mistakes.append(literal_values.number_too_large(self.span(leaf)))
            return 0.0
        return number
