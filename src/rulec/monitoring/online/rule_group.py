"""Groups of rules with the same types of variables, stepped as products.

For the objects bound to such rules, the states of all their machines form one node, and their reads
in a state form one letter. The product is built lazily: nodes and letters are created on first use.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence, Set
from typing import Any, NamedTuple, TypeAlias

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.automata.outcome_machine import OutcomeMachine
from rulec.monitoring.online.encoding.encoded_values import (
    Breakpoints,
    MonitorInput,
    breakpoints_of,
)
from rulec.monitoring.online.encoding.state_shape import Items
from rulec.monitoring.online.four_valued import (
    LetterClass,
    RunningVerdict,
)
from rulec.monitoring.online.prepared_rule import BY_STATE, PreparedRule, prepared_rule
from rulec.monitoring.online.uncertain_steps import Edge
from rulec.monitoring.uncertainty.state_letters.joint_values import values_at

MOST_CACHED = 1 << 18
"""How many nodes, letters and transitions are kept before all are discarded."""

_SetsOfClasses: TypeAlias = tuple[tuple[LetterClass, ...], tuple[int, ...]]
"""For each rule its class, and the numbers of the rules that read sets of classes."""


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
        try:
            edges: list[Edge] = [
                edge.successors[letter_class]
                for edge, letter_class in zip(self.edges, classes, strict=True)
            ]
        except IndexError:
            # Numbers beyond all classes stand for sets of classes.
            single, sets = self.group.sets_in(letter)
            edges = [
                edge.successors[letter_class]
                for edge, letter_class in zip(self.edges, single, strict=True)
            ]
            rules = self.group.rules
            for place in sets:
                edges[place] = rules[place].uncertain.rows[self.edges[place]][classes[place]]
        return self.group.node(tuple(edges))


class CacheSize:
    """How many nodes, letters and transitions are cached, and the known letters."""

    n = 0
    is_inexact = False
    has_holes = False


class Holes(NamedTuple):
    """The numbers of a letter's rules that read the whole state, and of those that are inexact."""

    rules: tuple[int, ...]
    inexact: frozenset[int]


class RuleGroup:
    """Rules whose variables have the same types, in the same order.

    ``own`` are their inputs about variables, ``world`` those about none. ``classes`` are the letter
    classes of each letter, one per rule; ``cache_size`` counts for all groups together. For
    ``inexact`` letters the names of rules are kept whose classes are overestimated; letters with
    ``holes`` must be ``filled`` before they are read.
    """

    def __init__(
        self, rules: Sequence[PreparedRule], types: tuple[str, ...], cache_size: CacheSize
    ) -> None:
        self.rules, self.types, self.cache_size = tuple(rules), types, cache_size
        inputs = dict.fromkeys(read for prepared in rules for read in prepared.all_inputs)
        self.own = tuple([read for read in inputs if read.places or read.name is None])
        self.world = tuple([read for read in inputs if read not in self.own])
        self.classes: list[tuple[LetterClass, ...]] = []
        self.inexact: dict[int, frozenset[str]] = {}
        self.holes: dict[int, Holes] = {}
        self._letters: dict[tuple[object, ...], int] = {}
        self._nodes: dict[tuple[Edge, ...], GroupNode] = {}
        self._sets: dict[int, _SetsOfClasses] = {}
        self._tables = [(prepared.classes, values_at(prepared.all_inputs)) for prepared in rules]
        self._all_inexact = [table.inexact for table, _ in self._tables]

    def node(self, edges: tuple[Edge, ...]) -> GroupNode:
        """The node with these edges, one per rule."""
        if edges not in self._nodes:
            self._nodes[edges] = GroupNode(self, edges)
            self.cache_size.n += 1
        return self._nodes[edges]

    def sets_in(self, letter: int) -> _SetsOfClasses:
        """A letter's single classes, with placeholders for sets of classes, and their places."""
        known = self._sets.get(letter)
        if known is None:
            classes, rules = self.classes[letter], self.rules
            sets = tuple([n for n, own in enumerate(classes) if own >= rules[n].n_classes])
            single = list(classes)
            for place in sets:
                single[place] = 0
            known = self._sets[letter] = tuple(single), sets
        return known

    def letter(self, classes: tuple[LetterClass, ...], inexact: Set[int] = frozenset()) -> int:
        """The letter with these classes, one per rule.

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
                own = tuple([n for n, known in enumerate(classes) if known == BY_STATE])
                self.holes[letter] = Holes(own, frozenset(inexact))
            elif inexact:
                self.cache_size.is_inexact = True
                self.inexact[letter] = frozenset(self.rules[number].name for number in inexact)
        return letter

    def filled(
        self,
        letter: int,
        items: Items,
        read: Callable[[PreparedRule, Items], tuple[LetterClass, bool]],
    ) -> int:
        """The letter whose ``holes`` are filled with what those rules read of the objects."""
        holes = self.holes[letter]
        classes, inexact = list(self.classes[letter]), set(holes.inexact)
        for number in holes.rules:
            classes[number], is_exact = read(self.rules[number], items)
            if not is_exact:
                inexact.add(number)
        return self.letter(tuple(classes), inexact)

    def letter_of(self, digits: Mapping[MonitorInput, Any]) -> int:
        """The letter for inputs with these digits or partly known values.

        It may have holes. Raises LookupError or TypeError if a digit is missing or invalid, or if
        no such state is possible.
        """
        read = [pick(digits) for _, pick in self._tables]
        classes = tuple([table[own] for (table, _), own in zip(self._tables, read, strict=True)])
        if not any(self._all_inexact):
            return self.letter(classes)
        inexact = frozenset(
            number
            for number, (inexact_here, own) in enumerate(zip(self._all_inexact, read, strict=True))
            if inexact_here and own in inexact_here
        )
        return self.letter(classes, inexact)

    def letter_read(self, read: Sequence[tuple[LetterClass, bool]]) -> int:
        """The letter with the class that each rule reads, given with whether this is exact."""
        inexact = {number for number, (_, is_exact) in enumerate(read) if not is_exact}
        return self.letter(tuple([own for own, _ in read]), inexact)


class RuleGroups:
    """The rules of a rulebook, singly and grouped by their variables' types.

    The groups cache their nodes, letters and transitions. ``lacks_hard``: some hard rules cannot
    be judged.
    """

    def __init__(
        self,
        rules: Sequence[PreparedRule],
        breakpoints: Breakpoints,
        *,
        lacks_hard: bool = False,
    ) -> None:
        self.rules, self.breakpoints = tuple(rules), breakpoints
        self.lacks_hard = lacks_hard
        self.cache_size = CacheSize()
        by_types: dict[tuple[str, ...], list[PreparedRule]] = {}
        for prepared in rules:
            types = tuple([variable.type for variable in prepared.rule.variables])
            by_types.setdefault(types, []).append(prepared)
        self.groups = tuple(
            [RuleGroup(members, types, self.cache_size) for types, members in by_types.items()]
        )

    def without_cache(self) -> RuleGroups:
        """These groups with empty caches."""
        return RuleGroups(self.rules, self.breakpoints, lacks_hard=self.lacks_hard)


def rule_groups(
    rulebook: CompiledRulebook,
    cut: Mapping[str, OutcomeMachine] | None = None,
    *,
    lacks_hard: bool = False,
) -> RuleGroups:
    """Prepare the rules of a rulebook; ``cut`` are their machines if the past is unknown."""
    rules = [
        prepared_rule(rule, rulebook, None if cut is None else cut[rule.name])
        for rule in rulebook.rules
    ]
    return RuleGroups(rules, breakpoints_of(rulebook), lacks_hard=lacks_hard)
