"""Groups of rules with the same types of variables, stepped as products.

For the objects bound to such rules, the states of all their machines form one node, and their reads
in a state form one letter. The product is built lazily: nodes and letters are created on first use.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence, Set
from typing import Any, NamedTuple

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.automata.outcome_machine import OutcomeMachine
from rulec.monitoring.bindings import types_of
from rulec.monitoring.online.encoding.encoded_values import (
    MISSING,
    UNKNOWN_DIGIT,
    Breakpoints,
    breakpoints_of,
    digit_table,
)
from rulec.monitoring.online.encoding.state_shape import Items
from rulec.monitoring.online.four_valued import ClassSet, RunningVerdict
from rulec.monitoring.online.prepared_rule import (
    BY_STATE,
    PossibleClasses,
    PreparedRule,
    prepared_rule,
)
from rulec.monitoring.online.rule_steps import Edge
from rulec.monitoring.uncertainty.state_letters.joint_values import values_at
from rulec.trace.remembered import Remembered
from rulec.vocabulary import Enumeration
from rulec.vocabulary.partial_values import UNKNOWN

MOST_CACHED = 1 << 18
"""How many nodes, letters and transitions are kept before all are discarded."""


class OtherVerdictError(Exception):
    """After this letter the verdict of some rule changes."""


class GroupNode(dict[int, "GroupNode"]):
    """The states of a group's machines, with the next node for each letter.

    Letters that change a verdict raise OtherVerdictError; ``successor`` takes any letter.
    """

    __slots__ = ("edges", "group", "verdicts")
    __eq__ = object.__eq__
    __hash__ = object.__hash__  # type: ignore[assignment]

    def __init__(self, group: RuleGroup, edges: tuple[Edge, ...]) -> None:
        self.group = group
        self.edges = edges
        self.verdicts: tuple[RunningVerdict, ...] = tuple([edge.verdict for edge in edges])

    def __missing__(self, letter: int) -> GroupNode:
        node = self.successor(letter)
        if node.verdicts != self.verdicts:
            raise OtherVerdictError
        self[letter] = node
        self.group.cache_size.n += 1
        return node

    def successor(self, letter: int) -> GroupNode:
        """The node after a letter."""
        classes = self.group.classes[letter]
        return self.group.node(
            tuple([edge[own] for edge, own in zip(self.edges, classes, strict=True)])
        )


class CacheSize:
    """How many nodes, letters and transitions are cached, and the known letters."""

    n = 0
    is_inexact = False
    has_holes = False


class RuleGroup:
    """Rules whose variables have the same types, in the same order, with what they read.

    ``classes`` are those of each letter, one set per rule; ``cache_size`` counts for all groups
    together. For ``inexact`` letters the names of rules are kept whose classes are overestimated;
    letters with ``holes``, which have the numbers of such rules, must be ``filled`` before they are
    read.
    """

    def __init__(self, reads: GroupReads, cache_size: CacheSize) -> None:
        self.reads, self.cache_size = reads, cache_size
        self.rules, self.types = reads.rules, reads.types
        self.classes: list[tuple[ClassSet, ...]] = []
        self.inexact: dict[int, frozenset[str]] = {}
        self.holes: dict[int, frozenset[int]] = {}
        self._letters: dict[tuple[object, ...], int] = {}
        self._nodes: dict[tuple[Edge, ...], GroupNode] = {}

    def node(self, edges: tuple[Edge, ...]) -> GroupNode:
        """The node with these edges, one per rule."""
        if edges not in self._nodes:
            self._nodes[edges] = GroupNode(self, edges)
            self.cache_size.n += 1
        return self._nodes[edges]

    def letter(self, classes: tuple[ClassSet, ...], inexact: Set[int] = frozenset()) -> int:
        """The letter with these classes, one set per rule.

        For the rules with ``inexact`` numbers the classes are overestimated.
        """
        # Exact letters have only numbers in their keys, which the garbage collector need not track.
        key = (classes, frozenset(inexact)) if inexact else classes
        letter = self._letters.get(key)
        if letter is None:
            letter = self._letters[key] = len(self.classes)
            self.classes.append(classes)
            self.cache_size.n += 1
            if BY_STATE in classes:
                self.cache_size.has_holes = True
                self.holes[letter] = frozenset(inexact)
            elif inexact:
                self.cache_size.is_inexact = True
                self.inexact[letter] = frozenset(self.rules[number].name for number in inexact)
        return letter

    def filled(
        self,
        letter: int,
        items: Items,
        read: Callable[[PreparedRule, Items], PossibleClasses],
    ) -> int:
        """The letter whose ``holes`` are filled with what those rules read of the objects."""
        inexact, classes = self.holes[letter], self.classes[letter]
        return self.letter_read(
            [
                read(rule, items) if own == BY_STATE else (own, number not in inexact)
                for number, (rule, own) in enumerate(zip(self.rules, classes, strict=True))
            ]
        )

    def letter_read(self, read: Sequence[PossibleClasses]) -> int:
        """The letter with the classes that each rule reads, given with whether this is exact."""
        inexact = {number for number, (_, is_exact) in enumerate(read) if not is_exact}
        return self.letter(tuple([own for own, _ in read]), inexact)


class RuleGroups:
    """The rules of a rulebook, singly and grouped by their variables' types.

    The groups cache their nodes, letters and transitions. ``lacks_hard``: some hard rules cannot
    be judged.
    """

    def __init__(self, known: KnownReads, *, lacks_hard: bool = False) -> None:
        self._known = known
        self.rules, self.breakpoints = known.rules, known.breakpoints
        self.lacks_hard = lacks_hard
        self.cache_size = CacheSize()
        self.groups = tuple([RuleGroup(reads, self.cache_size) for reads in known.groups])

    def without_cache(self) -> RuleGroups:
        """These groups with empty caches."""
        return RuleGroups(self._known, lacks_hard=self.lacks_hard)


class KnownReads(NamedTuple):
    """The rules of a rulebook with what they read, the same for all monitors."""

    rules: tuple[PreparedRule, ...]
    breakpoints: Breakpoints
    groups: tuple[GroupReads, ...]


def rule_groups(
    rulebook: CompiledRulebook,
    cut: Mapping[str, OutcomeMachine] | None = None,
    *,
    lacks_hard: bool = False,
) -> RuleGroups:
    """Prepare the rules of a rulebook; ``cut`` are their machines if the past is unknown."""
    rules = tuple(
        [
            prepared_rule(rule, rulebook, None if cut is None else cut[rule.name])
            for rule in rulebook.rules
        ]
    )
    known: dict[object, KnownReads] = rulebook.prepared.setdefault(KnownReads, {})
    if rules not in known:
        breakpoints = breakpoints_of(rulebook)
        by_types: dict[tuple[str, ...], list[PreparedRule]] = {}
        for prepared in rules:
            by_types.setdefault(types_of(prepared.rule), []).append(prepared)
        groups = tuple([GroupReads(members, breakpoints) for members in by_types.values()])
        known[rules] = KnownReads(rules, breakpoints, groups)
    return RuleGroups(known[rules], lacks_hard=lacks_hard)


class GroupReads:
    """The reads of ``rules`` whose variables have the same ``types``, in the same order.

    ``sources`` are what they read.
    """

    def __init__(self, rules: Sequence[PreparedRule], breakpoints: Breakpoints) -> None:
        self.rules = tuple(rules)
        self.types = types_of(rules[0].rule)
        self.sources = tuple(dict.fromkeys([own for rule in rules for own in rule.sources]))
        declarations = rules[0].vocabulary.declarations
        declared = [declarations.get(source.name or "") for source in self.sources]
        self._allowed = [
            (place, frozenset([*own.values, MISSING, UNKNOWN]))
            for place, own in enumerate(declared)
            if isinstance(own, Enumeration)
        ]
        self._tables: list[tuple[int, Remembered[Any, int]]] = []
        self._picks = []
        at: dict[object, int] = {source: place for place, source in enumerate(self.sources)}
        for rule in rules:
            places = []
            for read, source in rule.alone:
                key = source if source.name is None else (read.kind, source)
                if key not in at:
                    at[key] = len(at)
                    table = digit_table(read, breakpoints.get(source.name or ""))
                    self._tables.append((at[source], table))
                places.append(at[key])
            self._picks.append(values_at([*places, *[at[source] for source in rule.values]]))

    def classes(self, encoded: Sequence[Any]) -> list[PossibleClasses]:
        """The classes that each rule may read, for these encoded values of the ``sources``.

        Raises LookupError or TypeError if a value is missing or invalid, or if no such state is
        possible.
        """
        for place, allowed in self._allowed:
            if encoded[place] not in allowed:
                raise LookupError
        known = [UNKNOWN_DIGIT if value is UNKNOWN else value for value in encoded]
        known += [table[known[place]] for place, table in self._tables]
        return [
            rule.possible_classes(pick(known))
            for rule, pick in zip(self.rules, self._picks, strict=True)
        ]
