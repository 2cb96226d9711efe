"""Where a monitor stands: frozen, so that a state that is refused changes nothing."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence, Set
from types import MappingProxyType
from typing import NamedTuple

from rulec.runtime.online.prefix import Edge, Prefix, together
from rulec.runtime.online.scene import Letters, Scene
from rulec.runtime.online.team import Node, Ready


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


class SoFar(NamedTuple):
    """What a state has led to.

    ``state`` is its number, from 0. ``verdict`` is that of all hard rules together, ``rules`` has
    each rule's, soft ones included, ``changes`` what is new, in the order of rules and objects.
    """

    state: int
    verdict: Prefix
    rules: Mapping[str, Prefix]
    changes: tuple[Change, ...] = ()


class Standing(NamedTuple):
    """Everything that a monitor knows.

    ``nodes`` say where the machines of each team stand for each binding, in the order of the
    scene's teams. ``n_violations`` is how many bindings have violated their rule for good.
    """

    scene: Scene
    nodes: list[Node]
    so_far: SoFar
    n_violations: int


def beginning(scene: Scene) -> Standing:
    """Before the first state."""
    start = {
        crowd.ready.rule.name: [crowd.ready.links.start] * len(crowd.bindings)
        for crowd in scene.crowds
    }
    return standing_at(-1, scene, start, frozenset(), 0)


def standing_at(
    state: int,
    scene: Scene,
    edges: Mapping[str, Sequence[Edge]],
    lost: Set[str],
    n_violations: int,
) -> Standing:
    """Behind a state; ``lost`` are the rules that have been violated for good by then."""
    nodes = nodes_at(scene, edges)
    return Standing(scene, nodes, _so_far(state, scene, nodes, lost, ()), n_violations)


def nodes_at(scene: Scene, edges: Mapping[str, Sequence[Edge]]) -> list[Node]:
    """The nodes where the machines stand at these edges, given for each rule and binding."""
    found: list[Node] = []
    for team in scene.teams.teams:
        each = [edges[ready.rule.name] for ready in team.rules]
        found += [team.node(one) for one in zip(*each, strict=True)]
    return found


def onward(now: Standing, scene: Scene, letters: Letters) -> Standing:
    """Behind one more state, with a scene that may be another, and what its teams read.

    Takes no longer for a long past than for a short one.
    """
    last = now.so_far
    if scene is now.scene:
        before, changes = now.nodes, list[Change]()
        after = [node[letter] for node, letter in zip(before, letters, strict=True)]
        # Nodes that are alike are identical: then no machine has moved.
        if after == before or not _differ(before, after):
            so_far = SoFar(last.state + 1, last.verdict, last.rules)
            return Standing(scene, after, so_far, now.n_violations)
    else:
        edges, changes = carried_over(now.scene, now.nodes, scene)
        before = nodes_at(scene, edges)
        after = [node[letter] for node, letter in zip(before, letters, strict=True)]
    changes += _changes(scene, before, after)
    lost = {rule for rule, verdict in last.rules.items() if verdict == "violated"}
    lost.update(one.rule for one in changes if one.verdict == "violated")
    so_far = _so_far(last.state + 1, scene, after, lost, tuple(changes))
    violated = sum(one.verdict == "violated" for one in changes)
    return Standing(scene, after, so_far, now.n_violations + violated)


def carried_over(
    scene: Scene, nodes: Sequence[Node], into: Scene
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
                bound = ready.bound(items)
                ended.append(Change(ready.rule.name, bound, "pending", "violated", True))
        entered[ready.rule.name] = [known.get(items, ready.links.start) for items in after.bindings]
    return entered, ended


def _differ(before: Sequence[Node], after: Sequence[Node]) -> bool:
    """Has any binding another verdict than before?"""
    for old, new in zip(before, after, strict=True):
        if old is not new and old.verdicts != new.verdicts:
            return True
    return False


def _changes(scene: Scene, before: Sequence[Node], after: Sequence[Node]) -> Iterator[Change]:
    """The bindings with another verdict than before."""
    for crowd in scene.crowds:
        edges = zip(crowd.bindings, crowd.edges(before), crowd.edges(after), strict=True)
        for items, old, new in edges:
            if old.verdict != new.verdict:
                bound = crowd.ready.bound(items)
                yield Change(crowd.ready.rule.name, bound, old.verdict, new.verdict)


def _so_far(
    state: int, scene: Scene, nodes: Sequence[Node], lost: Set[str], changes: tuple[Change, ...]
) -> SoFar:
    """``lost`` are the rules that have been violated for good, by objects now there or not."""
    rules = {
        crowd.ready.rule.name: _verdict_on(crowd.ready, crowd.edges(nodes), lost)
        for crowd in scene.crowds
    }
    hard = (crowd.ready.rule for crowd in scene.crowds if crowd.ready.rule.strength == "hard")
    verdict = together(rules[rule.name] for rule in hard)
    return SoFar(state, verdict, MappingProxyType(rules), changes)


def _verdict_on(ready: Ready, edges: Sequence[Edge], lost: Set[str]) -> Prefix:
    if ready.rule.name in lost:
        return "violated"
    found = together({edge.verdict for edge in edges})
    # What all who are there have satisfied for good another may still come and violate.
    if found == "satisfied" and ready.rule.variables and ready.rule.machine.safe != 0:
        return "holds so far"
    return found
