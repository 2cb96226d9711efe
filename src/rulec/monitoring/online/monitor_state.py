"""Immutable states of a running monitor; a refused state changes nothing."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping, Sequence, Set
from operator import getitem
from types import MappingProxyType
from typing import Any, NamedTuple, TypeAlias

import msgspec

from rulec.monitoring.online.bound_rules import BoundRules, Letters
from rulec.monitoring.online.four_valued import FourValued, MonitorEdge, conjunction
from rulec.monitoring.online.rule_group import (
    GroupNode,
    OtherVerdictError,
    PreparedRule,
    RuleGroup,
)
from rulec.value_display import short_repr


class VerdictChange(NamedTuple):
    """Change of a rule's verdict for some objects by a state.

    Objects that have just come count as having held so far. ``ended`` says that their time together
    ended with the state before: one of them is no longer there.
    """

    rule: str
    binding: Mapping[str, str]
    before: FourValued
    verdict: FourValued
    ended: bool = False

    def __reduce__(self) -> tuple[type[VerdictChange], tuple[Any, ...]]:
        # A read-only view of a dictionary cannot be pickled.
        return VerdictChange, (self.rule, dict(self.binding), *self[2:])


class SoFar(msgspec.Struct, frozen=True, gc=False):
    """The verdicts as of a state.

    ``state`` is its number, from 0. ``verdict`` is that of all hard rules together, ``rules`` has
    each rule's, soft ones included, ``changes`` what is new, in the order of rules and objects.
    """

    __repr__ = short_repr

    # A struct is made several times as quickly as a dataclass or a named tuple.
    state: int
    verdict: FourValued
    rules: Mapping[str, FourValued]
    changes: tuple[VerdictChange, ...] = ()

    def __reduce__(self) -> tuple[type[SoFar], tuple[Any, ...]]:
        return SoFar, (self.state, self.verdict, dict(self.rules), self.changes)


class MonitorState(msgspec.Struct, frozen=True, eq=False):
    """State of a monitor for fixed objects, without the state's number.

    ``nodes`` are the states of each group's machines for each binding, in the order of the groups.
    ``n_violations`` is how many bindings have violated their rule for good. ``after`` is a cache of
    the steps that follow, by the keys of states.
    """

    bound_rules: BoundRules
    nodes: tuple[GroupNode, ...]
    verdict: FourValued
    rules: Mapping[str, FourValued]
    n_violations: int
    after: dict[Hashable, StepResult] = msgspec.field(default_factory=dict)


_NONE_KNOWN: Mapping[str, FourValued] = MappingProxyType({})

StepResult: TypeAlias = tuple[MonitorState, tuple[VerdictChange, ...]]
"""The next state of a monitor, and what changes by the step."""


def initial_state(bound_rules: BoundRules) -> MonitorState:
    """The monitor's state before the first state of a trace."""
    start = {
        bound_rule.prepared.name: [bound_rule.prepared.start] * len(bound_rule.bindings)
        for bound_rule in bound_rules.rules
    }
    return state_at(bound_rules, nodes_at(bound_rules, start), frozenset(), 0)


def nodes_at(
    bound_rules: BoundRules, edges: Mapping[str, Sequence[MonitorEdge]]
) -> tuple[GroupNode, ...]:
    """The nodes with these edges, given for each rule and binding."""
    nodes: list[GroupNode] = []
    for group in bound_rules.groups.groups:
        by_rule = [edges[prepared.name] for prepared in group.rules]
        nodes += [group.node(of_binding) for of_binding in zip(*by_rule, strict=True)]
    return tuple(nodes)


def take_step(current: MonitorState, bound_rules: BoundRules, letters: Letters) -> StepResult:
    """Take one step with these letters, for the rules as bound now.

    Takes no longer for a long past than for a short one.
    """
    changes: list[VerdictChange] = []
    if bound_rules is current.bound_rules:
        before = current.nodes
        try:
            nodes = tuple(map(getitem, before, letters))
        except OtherVerdictError:
            pass
        else:
            rules = current.rules
            return MonitorState(
                bound_rules, nodes, current.verdict, rules, current.n_violations
            ), ()
    else:
        edges, changes = carry_over(current.bound_rules, current.nodes, bound_rules)
        before = nodes_at(bound_rules, edges)
    nodes = tuple([node.successor(letter) for node, letter in zip(before, letters, strict=True)])
    changes += _changes(bound_rules, before, nodes)
    violated_rules = {rule for rule, verdict in current.rules.items() if verdict == "violated"}
    violated_rules.update(change.rule for change in changes if change.verdict == "violated")
    n_violations = current.n_violations + sum(change.verdict == "violated" for change in changes)
    # A rule's verdict changes only if it does so for an object that stays, comes or leaves.
    unchanged = current.rules.keys() - {change.rule for change in changes}
    known = {rule: current.rules[rule] for rule in unchanged}
    return state_at(bound_rules, nodes, violated_rules, n_violations, known), tuple(changes)


def carry_over(
    bound_rules: BoundRules, nodes: Sequence[GroupNode], into: BoundRules
) -> tuple[dict[str, list[MonitorEdge]], list[VerdictChange]]:
    """First edges of bindings, by rule, after the objects have changed.

    A binding goes on if its objects have stayed, that is, are there under the same names and of the
    same types; others start. There are also the changes by bindings that end.
    """
    stayed = {name for name, kind in bound_rules.objects.items() if into.objects.get(name) == kind}
    entered: dict[str, list[MonitorEdge]] = {}
    ended: list[VerdictChange] = []
    for before, after in zip(bound_rules.rules, into.rules, strict=True):
        prepared = after.prepared
        known = {}
        for items, edge in zip(before.bindings, before.edges(nodes), strict=True):
            if stayed.issuperset(items):
                known[items] = edge
            elif edge.verdict == "pending":
                binding = MappingProxyType(prepared.bound(items))
                ended.append(VerdictChange(prepared.name, binding, "pending", "violated", True))
        entered[prepared.name] = [known.get(items, prepared.start) for items in after.bindings]
    return entered, ended


def _changes(
    bound_rules: BoundRules, before: Sequence[GroupNode], after: Sequence[GroupNode]
) -> Iterator[VerdictChange]:
    changed: dict[RuleGroup, list[int]] = {}
    for place, (node_before, node) in enumerate(zip(before, after, strict=True)):
        if node_before.verdicts != node.verdicts:
            changed.setdefault(node.group, []).append(place)
    for bound_rule in bound_rules.rules:
        prepared, number = bound_rule.prepared, bound_rule.number
        for place in changed.get(bound_rule.group, ()):
            old, new = before[place].edges[number].verdict, after[place].edges[number].verdict
            if old != new:
                items = bound_rule.bindings[place - bound_rule.places.start]
                binding = MappingProxyType(prepared.bound(items))
                yield VerdictChange(prepared.name, binding, old, new)


def state_at(
    bound_rules: BoundRules,
    nodes: tuple[GroupNode, ...],
    violated_rules: Set[str],
    n_violations: int,
    known: Mapping[str, FourValued] = _NONE_KNOWN,
) -> MonitorState:
    """The monitor's state with these nodes, where some rules' verdicts are ``known``.

    ``violated_rules`` are violated for good, by objects now present or not.
    """
    rules = {
        bound_rule.prepared.name: known.get(bound_rule.prepared.name)
        or _verdict_on(bound_rule.prepared, bound_rule.edges(nodes), violated_rules)
        for bound_rule in bound_rules.rules
    }
    verdict = conjunction(rules[rule] for rule in bound_rules.hard)
    return MonitorState(bound_rules, nodes, verdict, MappingProxyType(rules), n_violations)


def _verdict_on(
    prepared: PreparedRule, edges: Sequence[MonitorEdge], violated_rules: Set[str]
) -> FourValued:
    if prepared.name in violated_rules:
        return "violated"
    verdict = conjunction({edge.verdict for edge in edges})
    # What all that are present have satisfied for good another may still come and violate.
    rule = prepared.rule
    if verdict == "satisfied" and rule.variables and rule.machine.accepting_sink != 0:
        return "holds so far"
    return verdict
