"""Groups of rules about common types of objects, stepped as products.

For objects that such rules are bound to, the states of all their machines are one node, and what
all of them read in a state is one letter. The product is built lazily: nodes and letters are made
when they are first met.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.mealy_monitor import IMPOSSIBLE
from rulec.monitoring.online.encoding.encoded_values import (
    Breakpoints,
    DigitWeight,
    MonitorInput,
    breakpoints_of,
    monitor_inputs,
)
from rulec.monitoring.online.four_valued import FourValued, MonitorEdge, linked_edges

MOST_CACHED = 1 << 18
"""Nodes, letters and transitions that are kept before all are forgotten."""


@dataclass(frozen=True, slots=True, eq=False)
class PreparedRule:
    """A rule prepared for any objects: its monitor's ``start`` and ``edges``, and its inputs."""

    rule: CompiledRule
    start: MonitorEdge
    edges: Mapping[tuple[int, FourValued], MonitorEdge]
    inputs: tuple[tuple[MonitorInput, DigitWeight], ...]

    @property
    def name(self) -> str:
        """The rule's name."""
        return self.rule.name

    def bound(self, items: Sequence[str]) -> dict[str, str]:
        """Objects by the names of the variables that they stand for."""
        return dict(zip([variable.name for variable in self.rule.variables], items, strict=True))


class OtherVerdictError(Exception):
    """Behind this letter a rule's verdict is another one."""


class GroupNode(dict[int, "GroupNode"]):
    """States of a group's machines, and behind each letter their next ones.

    Of letters that change a verdict an OtherVerdictError is raised; ``successor`` takes any.
    """

    __slots__ = ("edges", "group", "verdicts")
    __eq__ = object.__eq__
    __hash__ = object.__hash__  # type: ignore[assignment]

    def __init__(self, group: RuleGroup, edges: tuple[MonitorEdge, ...]) -> None:
        self.group = group
        self.edges = edges
        self.verdicts: tuple[FourValued, ...] = tuple([edge.verdict for edge in edges])

    def __missing__(self, letter: int) -> GroupNode:
        node = self.successor(letter)
        if node.verdicts != self.verdicts:
            raise OtherVerdictError
        self[letter] = node
        self.group.cache_size.n += 1
        return node

    def successor(self, letter: int) -> GroupNode:
        """The node behind a letter."""
        classes = self.group.classes[letter]
        edges = [
            edge.successors[letter_class]
            for edge, letter_class in zip(self.edges, classes, strict=True)
        ]
        return self.group.node(tuple(edges))


class CacheSize:
    """Number of cached nodes, letters and transitions."""

    n = 0


class RuleGroup:
    """Rules whose variables are of the same types, in the same order.

    ``own`` are their inputs about variables, ``world`` those about none. ``classes`` are the letter
    classes of each letter, one for each rule; ``cache_size`` counts for all groups together.
    """

    def __init__(
        self, rules: Sequence[PreparedRule], types: tuple[str, ...], cache_size: CacheSize
    ) -> None:
        self.rules, self.types, self.cache_size = tuple(rules), types, cache_size
        inputs = dict.fromkeys(read for prepared in rules for read, _ in prepared.inputs)
        self.own = tuple([read for read in inputs if read.places or read.name is None])
        self.world = tuple([read for read in inputs if read not in self.own])
        self.classes: list[tuple[int, ...]] = []
        self._letters: dict[tuple[int, ...], int] = {}
        self._nodes: dict[tuple[MonitorEdge, ...], GroupNode] = {}

    def node(self, edges: tuple[MonitorEdge, ...]) -> GroupNode:
        """The node with these edges, one for each rule."""
        if edges not in self._nodes:
            self._nodes[edges] = GroupNode(self, edges)
            self.cache_size.n += 1
        return self._nodes[edges]

    def letter(self, classes: tuple[int, ...]) -> int:
        """The letter that has these classes, one for each rule."""
        if classes not in self._letters:
            self._letters[classes] = len(self.classes)
            self.classes.append(classes)
            self.cache_size.n += 1
        return self._letters[classes]

    def letter_of(self, digits: dict[MonitorInput, Any]) -> int:
        """The letter where inputs have these digits.

        Raises LookupError or TypeError if one is missing or wrong, or if no state is such.
        """
        classes = []
        for prepared in self.rules:
            number = sum([weight_of(digits[read]) for read, weight_of in prepared.inputs])
            classes.append(prepared.rule.machine.letters[number])
        if IMPOSSIBLE in classes:
            raise LookupError
        return self.letter(tuple(classes))


class RuleGroups:
    """Rules of a rulebook, singly and grouped by their variables' types.

    The groups cache their nodes, letters and transitions.
    """

    def __init__(self, rules: Sequence[PreparedRule], breakpoints: Breakpoints) -> None:
        self.rules, self.breakpoints = tuple(rules), breakpoints
        self.cache_size = CacheSize()
        by_types: dict[tuple[str, ...], list[PreparedRule]] = {}
        for prepared in rules:
            types = tuple([variable.type for variable in prepared.rule.variables])
            by_types.setdefault(types, []).append(prepared)
        self.groups = tuple(
            [RuleGroup(members, types, self.cache_size) for types, members in by_types.items()]
        )

    def without_cache(self) -> RuleGroups:
        """These groups as they were at first."""
        return RuleGroups(self.rules, self.breakpoints)


def rule_groups(rulebook: CompiledRulebook) -> RuleGroups:
    """Prepare the rules of a rulebook."""
    rules = [
        PreparedRule(
            rule, *linked_edges(rule.machine), tuple(monitor_inputs(rule, rulebook.vocabulary))
        )
        for rule in rulebook.rules
    ]
    return RuleGroups(rules, breakpoints_of(rulebook))
