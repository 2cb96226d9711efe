"""Where a monitor stands: frozen, so that a state that is refused changes nothing."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping, Sequence, Set
from operator import getitem
from types import MappingProxyType
from typing import NamedTuple, TypeAlias

import msgspec

from rulec.monitoring.online.bound_rules import BoundRules, Letters
from rulec.monitoring.online.four_valued import Edge, Prefix, together
from rulec.monitoring.online.rule_group import Node, OtherVerdictError, Ready, RuleGroup


class Change(NamedTuple):
    """A rule's verdict for some objects is not what it was before this state.

    Objects that have just come count as having held so far. ``ended`` says that their time together
    ended with the state before: one of them is no longer there.
    """

    rule: str
    binding: Mapping[str, str]
    before: Prefix
    verdict: Prefix
    ended: bool = False


class SoFar(msgspec.Struct, frozen=True, gc=False):
    """What a state has led to.

    ``state`` is its number, from 0. ``verdict`` is that of all hard rules together, ``rules`` has
    each rule's, soft ones included, ``changes`` what is new, in the order of rules and objects.
    """

    # A struct is made several times as quickly as a dataclass or a named tuple.
    state: int
    verdict: Prefix
    rules: Mapping[str, Prefix]
    changes: tuple[Change, ...] = ()


class MonitorState(msgspec.Struct, frozen=True, eq=False):
    """Everything that a monitor knows while nobody comes or goes, but for the number of the state.

    ``nodes`` say where the machines of each team stand for each binding, in the order of the
    scene's teams. ``n_violations`` is how many bindings have violated their rule for good.
    ``after`` is what is remembered of the standings behind this one, by the keys of states.
    """

    scene: BoundRules
    nodes: tuple[Node, ...]
    verdict: Prefix
    rules: Mapping[str, Prefix]
    n_violations: int
    after: dict[Hashable, Onward] = msgspec.field(default_factory=dict)


Onward: TypeAlias = tuple[MonitorState, tuple[Change, ...]]
"""Where a state leads, and what changes by it."""


def beginning(scene: BoundRules) -> MonitorState:
    """Before the first state."""
    start = {
        crowd.ready.rule.name: [crowd.ready.links.start] * len(crowd.bindings)
        for crowd in scene.crowds
    }
    return standing_at(scene, start, frozenset(), 0)


def standing_at(
    scene: BoundRules, edges: Mapping[str, Sequence[Edge]], lost: Set[str], n_violations: int
) -> MonitorState:
    """Behind a state; ``lost`` are the rules that have been violated for good by then."""
    return _standing(scene, nodes_at(scene, edges), lost, n_violations, {})


def nodes_at(scene: BoundRules, edges: Mapping[str, Sequence[Edge]]) -> tuple[Node, ...]:
    """The nodes where the machines stand at these edges, given for each rule and binding."""
    found: list[Node] = []
    for team in scene.teams.teams:
        each = [edges[ready.rule.name] for ready in team.rules]
        found += [team.node(one) for one in zip(*each, strict=True)]
    return tuple(found)


def onward(here: MonitorState, scene: BoundRules, letters: Letters) -> Onward:
    """Behind one more state, with a scene that may be another, and what its teams read.

    Takes no longer for a long past than for a short one.
    """
    changes: list[Change] = []
    if scene is here.scene:
        before = here.nodes
        try:
            nodes = tuple(map(getitem, before, letters))
        except OtherVerdictError:
            pass
        else:
            return MonitorState(scene, nodes, here.verdict, here.rules, here.n_violations), ()
    else:
        edges, changes = carried_over(here.scene, here.nodes, scene)
        before = nodes_at(scene, edges)
    nodes = tuple([node.behind(letter) for node, letter in zip(before, letters, strict=True)])
    changes += _changes(scene, before, nodes)
    lost = {rule for rule, verdict in here.rules.items() if verdict == "violated"}
    lost.update(one.rule for one in changes if one.verdict == "violated")
    violated = here.n_violations + sum(one.verdict == "violated" for one in changes)
    # A rule says something else only if it does so of somebody who stays, comes or leaves.
    unchanged = here.rules.keys() - {one.rule for one in changes}
    known = {rule: here.rules[rule] for rule in unchanged}
    after = _standing(scene, nodes, lost, violated, known)
    return after, tuple(changes)


def carried_over(
    scene: BoundRules, nodes: Sequence[Node], into: BoundRules
) -> tuple[dict[str, list[Edge]], list[Change]]:
    """Where the bindings of a scene stand at first that follows upon another, by rule.

    A binding goes on if its objects have stayed, that is, are there under the same names and of the
    same types; others start. There are also the changes by bindings that end.
    """
    stayed = {name for name, kind in scene.objects.items() if into.objects.get(name) == kind}
    entered: dict[str, list[Edge]] = {}
    ended: list[Change] = []
    for before, after in zip(scene.crowds, into.crowds, strict=True):
        ready = after.ready
        known = {}
        for items, edge in zip(before.bindings, before.edges(nodes), strict=True):
            if stayed.issuperset(items):
                known[items] = edge
            elif edge.verdict == "pending":
                bound = MappingProxyType(ready.bound(items))
                ended.append(Change(ready.rule.name, bound, "pending", "violated", True))
        entered[ready.rule.name] = [known.get(items, ready.links.start) for items in after.bindings]
    return entered, ended


def _changes(scene: BoundRules, before: Sequence[Node], after: Sequence[Node]) -> Iterator[Change]:
    """The bindings with another verdict than before."""
    places: dict[RuleGroup, list[int]] = {}
    for place, (here, there) in enumerate(zip(before, after, strict=True)):
        if here.verdicts != there.verdicts:
            places.setdefault(there.team, []).append(place)
    for crowd in scene.crowds:
        for place in places.get(crowd.team, ()):
            old, new = before[place].edges[crowd.number], after[place].edges[crowd.number]
            if old.verdict != new.verdict:
                bound = MappingProxyType(
                    crowd.ready.bound(crowd.bindings[place - crowd.place.start])
                )
                yield Change(crowd.ready.rule.name, bound, old.verdict, new.verdict)


def _standing(
    scene: BoundRules,
    nodes: tuple[Node, ...],
    lost: Set[str],
    n_violations: int,
    known: Mapping[str, Prefix],
) -> MonitorState:
    """``lost`` are the rules that have been violated for good, by objects now there or not.

    Of some rules the verdict is ``known``.
    """
    rules = {
        crowd.ready.rule.name: known.get(crowd.ready.rule.name)
        or _verdict_on(crowd.ready, crowd.edges(nodes), lost)
        for crowd in scene.crowds
    }
    verdict = together(rules[rule] for rule in scene.hard)
    return MonitorState(scene, nodes, verdict, MappingProxyType(rules), n_violations)


def _verdict_on(ready: Ready, edges: Sequence[Edge], lost: Set[str]) -> Prefix:
    if ready.rule.name in lost:
        return "violated"
    found = together({edge.verdict for edge in edges})
    # What all who are there have satisfied for good another may still come and violate.
    if found == "satisfied" and ready.rule.variables and ready.rule.machine.accepting_sink != 0:
        return "holds so far"
    return found
