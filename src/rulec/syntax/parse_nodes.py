"""The result of the grammar for a piece: nodes and tokens, or where it cannot continue."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

Start = Literal["item", "rule_head", "clause", "example_head", "state", "formula"]

MAX_DEPTH = 200
"""The deepest nesting of operators and parentheses: far above any law, far below Python's stack."""


class ParseLeaf(NamedTuple):
    """A token of the grammar."""

    kind: str
    text: str
    start: int
    end: int


class ParseNode(NamedTuple):
    """Match of a grammar rule, from character ``start`` to ``end``."""

    kind: str
    children: tuple[ParseNode | ParseLeaf, ...]
    start: int
    end: int

    def leaves(self, kind: str) -> list[ParseLeaf]:
        """The tokens of a kind directly below."""
        return [leaf for leaf in self.children if leaf.kind == kind and isinstance(leaf, ParseLeaf)]

    def branches(self, *kinds: str) -> list[ParseNode]:
        """The matched rules of some kinds directly below."""
        return [
            node for node in self.children if node.kind in kinds and isinstance(node, ParseNode)
        ]


@dataclass(frozen=True, slots=True)
class Mismatch:
    """A syntax error at ``position``; ``accepted`` names the possible tokens."""

    position: int
    accepted: frozenset[str]


@dataclass(frozen=True, slots=True)
class TooDeep:
    """A formula is nested too deeply at ``position``.

    The part there is inside more than ``MAX_DEPTH`` others.
    """

    position: int
