"""Immutable states of a running monitor, so that a refused state changes nothing."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping, Sequence, Set
from operator import getitem
from types import MappingProxyType
from typing import Any, NamedTuple, TypeAlias

import msgspec

from rulec.monitoring.online.bound_rules import Awake, BoundRules, Letters
from rulec.monitoring.online.encoding.state_shape import Items
from rulec.monitoring.online.four_valued import (
    FourValued,
    RunningVerdict,
    VerdictRange,
    best_of,
    conjunction,
    within,
    worst_of,
)
from rulec.monitoring.online.prepared_rule import PreparedRule
from rulec.monitoring.online.rule_group import (
    GroupNode,
    OtherVerdictError,
    RuleGroup,
)
from rulec.monitoring.online.rule_steps import Edge
from rulec.monitoring.online.running_constants import NO_CONSTANTS, KnownConstants
from rulec.value_display import short_repr


class VerdictChange(NamedTuple):
    """The change of a rule's verdict for some objects in a state.

    Objects that have just appeared count as having held so far. ``ended`` means that with the state
    before, their time together ended because one of them is no longer present.
    """

    rule: str
    binding: Mapping[str, str]
    before: RunningVerdict
    verdict: RunningVerdict
    ended: bool = False

    def __reduce__(self) -> tuple[type[VerdictChange], tuple[Any, ...]]:
        # A read-only view of a dictionary cannot be pickled.
        return VerdictChange, (self.rule, dict(self.binding), *self[2:])


class SoFar(msgspec.Struct, frozen=True, gc=False):
    """The verdicts as of a state.

    ``state`` is its number, from 0. ``verdict`` is that of all hard rules together; ``rules`` has
    that of each judged rule, including soft ones; ``changes`` are the new ones, in the order of
    rules and objects. With unknown values, a verdict may be a ``VerdictRange``; if some hard rule
    is not judged, the worst ``verdict`` is violated. ``exact`` is false if for some such rule the
    possible letters were overestimated, so that its range may really be narrower.
    """

    __repr__ = short_repr

    # Creating a struct is several times as fast as creating a dataclass or named tuple.
    state: int
    verdict: RunningVerdict
    rules: Mapping[str, RunningVerdict]
    changes: tuple[VerdictChange, ...] = ()
    exact: bool = True

    @property
    def best(self) -> FourValued:
        """The best possible verdict on all hard rules together."""
        return best_of(self.verdict)

    @property
    def worst(self) -> FourValued:
        """The worst possible verdict on all hard rules together."""
        return worst_of(self.verdict)

    def __reduce__(self) -> tuple[type[SoFar], tuple[Any, ...]]:
        return SoFar, (self.state, self.verdict, dict(self.rules), self.changes, self.exact)


class MonitorState(msgspec.Struct, frozen=True, eq=False):
    """The state of a monitor for fixed objects, without the number of the state.

    ``nodes`` are the states of each group's machines for each binding, in the order of the groups.
    ``n_violations`` is how many bindings have violated their rule for good. Rules that are
    ``doubted`` may have been violated by objects that have left; for rules that are ``inexact`` the
    possible letters were overestimated. ``exact`` is as in ``SoFar``. ``constants`` are those given
    so far, ``after`` caches the steps that follow, by the keys of states.
    """

    bound_rules: BoundRules
    nodes: tuple[GroupNode, ...]
    verdict: RunningVerdict
    rules: Mapping[str, RunningVerdict]
    n_violations: int
    doubted: frozenset[str] = frozenset()
    inexact: frozenset[str] = frozenset()
    exact: bool = True
    constants: KnownConstants = NO_CONSTANTS
    after: dict[Hashable, StepResult] = msgspec.field(default_factory=dict)


_NONE_KNOWN: Mapping[str, RunningVerdict] = MappingProxyType({})
_NONE: frozenset[str] = frozenset()
_OPEN_AT_END = frozenset({"satisfied", "holds so far"})

StepResult: TypeAlias = tuple[MonitorState, tuple[VerdictChange, ...]]
"""The next state of a monitor, and the changes in this step."""


def initial_state(bound_rules: BoundRules) -> MonitorState:
    """The monitor's state before the first state of a trace."""
    start = {
        bound_rule.prepared.name: [bound_rule.prepared.start] * len(bound_rule.bindings)
        for bound_rule in bound_rules.rules
    }
    return state_at(bound_rules, nodes_at(bound_rules, start), (_NONE, _NONE), 0)


def nodes_at(bound_rules: BoundRules, edges: Mapping[str, Sequence[Edge]]) -> tuple[GroupNode, ...]:
    """The nodes with these edges, given for each rule and binding."""
    nodes: list[GroupNode] = []
    for group in bound_rules.groups.groups:
        by_rule = [edges[prepared.name] for prepared in group.rules]
        nodes += [group.node(of_binding) for of_binding in zip(*by_rule, strict=True)]
    return tuple(nodes)


def take_step(current: MonitorState, bound_rules: BoundRules, letters: Letters) -> StepResult:
    """Take one step with these letters, for the rules as bound now.

    The cost does not depend on the length of the past.
    """
    changes: list[VerdictChange] = []
    if bound_rules is current.bound_rules:
        before = current.nodes
        try:
            nodes = tuple(map(getitem, before, letters))
        except OtherVerdictError:
            pass
        else:
            if nodes == before:
                return current, ()
            return msgspec.structs.replace(current, nodes=nodes, after={}), ()
    else:
        edges, changes = carry_over(current.bound_rules, current.nodes, bound_rules)
        before = nodes_at(bound_rules, edges)
    nodes = tuple([node.successor(letter) for node, letter in zip(before, letters, strict=True)])
    changes += _changes(bound_rules, before, nodes)
    violated_rules = {rule for rule, verdict in current.rules.items() if verdict == "violated"}
    violated_rules.update(change.rule for change in changes if change.verdict == "violated")
    n_violations = current.n_violations + sum(change.verdict == "violated" for change in changes)
    doubted = current.doubted.union(
        [change.rule for change in changes if change.ended and change.verdict != "violated"]
    )
    # A rule's verdict changes only if it changes for an object that stays, appears or leaves.
    unchanged = current.rules.keys() - {change.rule for change in changes}
    known = {rule: current.rules[rule] for rule in unchanged}
    lost = violated_rules, doubted
    return state_at(bound_rules, nodes, lost, n_violations, known), tuple(changes)


def with_inexact(state: MonitorState, rules: frozenset[str]) -> MonitorState:
    """The state, with these rules marked as inexact."""
    if not rules:
        return state
    exact = not any(isinstance(state.rules[rule], VerdictRange) for rule in rules)
    return msgspec.structs.replace(state, inexact=rules, exact=exact, after={})


def with_constants_known(state: MonitorState, constants: KnownConstants) -> MonitorState:
    """The state, with these constants given so far."""
    if state.constants is constants:
        return state
    return msgspec.structs.replace(state, constants=constants, after={})


def carry_over(
    bound_rules: BoundRules, nodes: Sequence[GroupNode], into: BoundRules
) -> tuple[dict[str, list[Edge]], list[VerdictChange]]:
    """The first edges of bindings, by rule, after the objects have changed.

    A binding continues if its objects have stayed, that is, are present under the same names and
    with the same types; other bindings start. Also returns the changes for bindings that end.
    """
    stayed = {name for name, kind in bound_rules.objects.items() if into.objects.get(name) == kind}
    entered: dict[str, list[Edge]] = {}
    ended: list[VerdictChange] = []
    for before, after in zip(bound_rules.rules, into.rules, strict=True):
        prepared = after.prepared
        known = {}
        for items, edge in zip(before.bindings, before.edges(nodes), strict=True):
            if stayed.issuperset(items):
                known[items] = edge
            elif edge.verdict == "pending" or isinstance(edge.verdict, VerdictRange):
                binding = MappingProxyType(prepared.bound(items))
                after_all = _at_the_end(edge.verdict, goes_on=prepared.is_cut)
                if after_all != "satisfied":
                    change = VerdictChange(prepared.name, binding, edge.verdict, after_all, True)
                    ended.append(change)
        entered[prepared.name] = [known.get(items, prepared.start) for items in after.bindings]
    return entered, ended


def awake(current: MonitorState, objects: Mapping[str, str]) -> Awake:
    """The choices of objects, all still present, for which a rule has left its start state."""
    bound_rules = current.bound_rules
    stayed = {name for name, kind in bound_rules.objects.items() if objects.get(name) == kind}
    choices: dict[tuple[str, ...], set[Items]] = {}
    for own in bound_rules.rules:
        if len(own.group.types) > 2:
            choices.setdefault(own.group.types, set()).update(
                items
                for items, edge in zip(own.bindings, own.edges(current.nodes), strict=True)
                if stayed.issuperset(items) and not own.prepared.is_at_start(edge)
            )
    return choices


def _at_the_end(verdict: RunningVerdict, *, goes_on: bool) -> RunningVerdict:
    """The final verdict when the objects are no longer present together.

    If their time together ``goes_on`` unobserved, it may still satisfy what is pending.
    """
    is_kept = goes_on or best_of(verdict) in _OPEN_AT_END
    best: FourValued = "satisfied" if is_kept else "violated"
    worst: FourValued = "satisfied" if worst_of(verdict) in _OPEN_AT_END else "violated"
    return within(best, worst)


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
    lost: tuple[Set[str], frozenset[str]],
    n_violations: int,
    known: Mapping[str, RunningVerdict] = _NONE_KNOWN,
) -> MonitorState:
    """The monitor's state with these nodes; some rules' verdicts may be ``known`` already.

    ``lost`` are rules violated for good, by objects now present or not, and rules that are doubted.
    """
    rules = {
        bound_rule.prepared.name: known.get(bound_rule.prepared.name)
        or _verdict_on(bound_rule.prepared, bound_rule.edges(nodes), lost)
        for bound_rule in bound_rules.rules
    }
    verdict = conjunction(rules[rule] for rule in bound_rules.hard)
    if bound_rules.groups.lacks_hard:
        verdict = within(best_of(verdict), "violated")
    read_only = MappingProxyType(rules)
    return MonitorState(bound_rules, nodes, verdict, read_only, n_violations, doubted=lost[1])


def _verdict_on(
    prepared: PreparedRule, edges: Sequence[Edge], lost: tuple[Set[str], Set[str]]
) -> RunningVerdict:
    violated, doubted = lost
    if prepared.name in violated:
        return "violated"
    verdict = conjunction({edge.verdict for edge in edges})
    # Objects that appear later may still violate what all present ones have satisfied for good.
    if prepared.rule.variables and prepared.start.verdict != "satisfied":
        if verdict == "satisfied":
            verdict = "holds so far"
        elif isinstance(verdict, VerdictRange) and verdict.best == "satisfied":
            verdict = within("holds so far", verdict.worst)
    return within(best_of(verdict), "violated") if prepared.name in doubted else verdict
