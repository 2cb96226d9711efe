"""Rules about the same kinds of objects, whose machines take one step together.

For objects that such rules are bound to, where all their machines stand is one node, and what all
of them read in a state is one letter. Nodes and letters are made when they are first met.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.mealy_monitor import IMPOSSIBLE
from rulec.monitoring.online.breakpoints import Floors, breakpoints_of
from rulec.monitoring.online.four_valued import Edge, Prefix, VerdictLinks, linked
from rulec.monitoring.online.letter_inputs import Input, Weigh, inputs_of

MOST_LEARNED = 1 << 18
"""So many nodes, letters and ways between nodes are remembered before they are forgotten again."""


@dataclass(frozen=True, slots=True, eq=False)
class Ready:
    """A rule made ready for any objects."""

    rule: CompiledRule
    links: VerdictLinks
    inputs: tuple[tuple[Input, Weigh], ...]

    def bound(self, items: Sequence[str]) -> dict[str, str]:
        """Objects by the names of the variables that they stand for."""
        return dict(zip([one.name for one in self.rule.variables], items, strict=True))


class OtherVerdictError(Exception):
    """Behind this letter a rule's verdict is another one."""


class Node(dict[int, "Node"]):
    """Where the machines of a team stand, and behind each letter where they will stand then.

    Of letters that change a verdict an OtherVerdictError is raised; ``behind`` takes any.
    """

    __slots__ = ("edges", "team", "verdicts")
    __eq__ = object.__eq__
    __hash__ = object.__hash__  # type: ignore[assignment]

    def __init__(self, team: RuleGroup, edges: tuple[Edge, ...]) -> None:
        self.team = team
        self.edges = edges
        self.verdicts: tuple[Prefix, ...] = tuple([edge.verdict for edge in edges])

    def __missing__(self, letter: int) -> Node:
        node = self.behind(letter)
        if node.verdicts != self.verdicts:
            raise OtherVerdictError
        self[letter] = node
        self.team.learned.n += 1
        return node

    def behind(self, letter: int) -> Node:
        """Where the machines stand behind a letter."""
        classes = self.team.classes[letter]
        edges = [edge.onward[one] for edge, one in zip(self.edges, classes, strict=True)]
        return self.team.node(tuple(edges))


class Learned:
    """How many nodes, letters and ways between nodes there are."""

    n = 0


class RuleGroup:
    """Rules whose variables are of the same types, in the same order.

    ``own`` are their inputs about variables, ``world`` those about none. ``classes`` are those that
    each letter has for each rule, ``learned`` counts for all teams together.
    """

    def __init__(self, rules: Sequence[Ready], learned: Learned) -> None:
        self.learned = learned
        self.rules = tuple(rules)
        self.types = tuple([variable.type for variable in rules[0].rule.variables])
        inputs = dict.fromkeys(one for ready in rules for one, _ in ready.inputs)
        self.own = tuple([one for one in inputs if one.places or one.name is None])
        self.world = tuple([one for one in inputs if one not in self.own])
        self.classes: list[tuple[int, ...]] = []
        self._letters: dict[tuple[int, ...], int] = {}
        self._nodes: dict[tuple[Edge, ...], Node] = {}
        self.start = self.node(tuple([ready.links.start for ready in rules]))

    def node(self, edges: tuple[Edge, ...]) -> Node:
        """The node with these edges, one for each rule."""
        if edges not in self._nodes:
            self._nodes[edges] = Node(self, edges)
            self.learned.n += 1
        return self._nodes[edges]

    def letter(self, classes: tuple[int, ...]) -> int:
        """The letter that has these classes, one for each rule."""
        if classes not in self._letters:
            self._letters[classes] = len(self.classes)
            self.classes.append(classes)
            self.learned.n += 1
        return self._letters[classes]

    def letter_of(self, digits: dict[Input, Any]) -> int:
        """The letter where inputs have these digits.

        Raises a LookupError or a TypeError if one is missing or wrong, or if there is no such
        state.
        """
        classes = []
        for ready in self.rules:
            number = sum([weigh(digits[one]) for one, weigh in ready.inputs])
            classes.append(ready.rule.machine.letters[number])
        if IMPOSSIBLE in classes:
            raise LookupError
        return self.letter(tuple(classes))


@dataclass(frozen=True, slots=True, eq=False)
class RuleGroups:
    """The rules of a rulebook, one by one and by the types of their variables.

    They learn: which nodes and letters there are, and what leads where. ``floors`` are what they
    compare quantities with.
    """

    rules: tuple[Ready, ...]
    teams: tuple[RuleGroup, ...]
    floors: Floors
    learned: Learned

    def forgetful(self) -> RuleGroups:
        """The same, but for what they have learnt."""
        return _by_types(self.rules, self.floors)


def rule_groups(rulebook: CompiledRulebook) -> RuleGroups:
    """The rules of a rulebook, made ready."""
    vocabulary = rulebook.vocabulary
    return _by_types(
        [
            Ready(rule, linked(rule.machine), tuple(inputs_of(rule, vocabulary)))
            for rule in rulebook.rules
        ],
        breakpoints_of(rulebook),
    )


def _by_types(rules: Sequence[Ready], floors: Floors) -> RuleGroups:
    by_types: dict[tuple[str, ...], list[Ready]] = {}
    for one in rules:
        by_types.setdefault(tuple([each.type for each in one.rule.variables]), []).append(one)
    learned = Learned()
    teams = tuple([RuleGroup(team, learned) for team in by_types.values()])
    return RuleGroups(tuple(rules), teams, floors, learned)
