"""What the grammar finds in a piece: nodes and tokens, or where it cannot go on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Start = Literal["item", "rule_head", "clause", "example_head", "state", "formula"]

MAX_DEPTH = 200
"""Operators and parentheses inside one another: far above any law, far below Python's stack."""


@dataclass(frozen=True, slots=True)
class ParseLeaf:
    """A token of the grammar."""

    kind: str
    text: str
    start: int
    end: int


@dataclass(frozen=True, slots=True)
class ParseNode:
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
    """Syntax error at ``position``; ``accepted`` names the possible tokens."""

    position: int
    accepted: frozenset[str]


@dataclass(frozen=True, slots=True)
class TooDeep:
    """Formula nested too deeply at ``position``.

    The part there stands inside more than ``MAX_DEPTH`` others.
    """

    position: int
