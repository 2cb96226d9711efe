"""Where a monitor stands: frozen, so that a state that is refused changes nothing."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Set
from types import MappingProxyType
from typing import NamedTuple, TypeAlias

from rulec.runtime.online.prefix import Edge, Prefix, together
from rulec.runtime.online.scene import Letters, Ready, Scene

Edges: TypeAlias = list[Edge]


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

    ``edges`` say where the machine of each binding of each rule stands, in the order of the scene's
    crowds. ``n_violations`` is how many bindings have violated their rule for good.
    """

    scene: Scene
    edges: Edges
    so_far: SoFar
    n_violations: int


def beginning(scene: Scene) -> Standing:
    """Before the first state."""
    edges = [crowd.ready.links.start for crowd in scene.crowds for _ in crowd.bindings]
    return standing_at(-1, scene, edges, frozenset(), 0)


def standing_at(
    state: int, scene: Scene, edges: Edges, lost: Set[str], n_violations: int
) -> Standing:
    """Behind a state; ``lost`` are the rules that have been violated for good by then."""
    return Standing(scene, edges, _so_far(state, scene, edges, lost, ()), n_violations)


def onward(now: Standing, scene: Scene, letters: Letters) -> Standing:
    """Behind one more state, with a scene that may be another, and what its crowds read.

    Takes no longer for a long past than for a short one.
    """
    last = now.so_far
    if scene is now.scene:
        after = [edge.onward[letter] for edge, letter in zip(now.edges, letters, strict=True)]
        # Edges that are alike are identical: then no machine has moved.
        if after == now.edges:
            so_far = SoFar(last.state + 1, last.verdict, last.rules)
            return Standing(scene, after, so_far, now.n_violations)
        before, changes = now.edges, list[Change]()
    else:
        before, changes = carried_over(now.scene, now.edges, scene)
        after = [edge.onward[letter] for edge, letter in zip(before, letters, strict=True)]
    changes += changes_between(scene, before, after)
    if scene is not now.scene or changes:
        lost = {rule for rule, verdict in last.rules.items() if verdict == "violated"}
        lost.update(one.rule for one in changes if one.verdict == "violated")
        so_far = _so_far(last.state + 1, scene, after, lost, tuple(changes))
    else:
        so_far = SoFar(last.state + 1, last.verdict, last.rules)
    violated = sum(one.verdict == "violated" for one in changes)
    return Standing(scene, after, so_far, now.n_violations + violated)


def carried_over(scene: Scene, edges: Edges, into: Scene) -> tuple[Edges, list[Change]]:
    """Where the bindings of a scene stand at first that follows upon another.

    A binding goes on if its objects have stayed, that is, are there under the same names and of the
    same types; others start. There are also the changes by bindings that end.
    """
    stayed = {name for name, kind in scene.objects.items() if into.objects.get(name) == kind}
    entered: Edges = []
    ended: list[Change] = []
    for before, after in zip(scene.crowds, into.crowds, strict=True):
        ready = after.ready
        known = {}
        for items, edge in zip(before.bindings, edges[before.place], strict=True):
            if stayed.issuperset(items):
                known[items] = edge
            elif edge.verdict == "pending":
                bound = ready.bound(items)
                ended.append(Change(ready.rule.name, bound, "pending", "violated", True))
        entered += [known.get(items, ready.links.start) for items in after.bindings]
    return entered, ended


def changes_between(scene: Scene, before: Edges, after: Edges) -> Iterator[Change]:
    """The bindings with another verdict than before."""
    if [edge.verdict for edge in before] == [edge.verdict for edge in after]:
        return
    for crowd in scene.crowds:
        name, place = crowd.ready.rule.name, crowd.place
        for items, old, new in zip(crowd.bindings, before[place], after[place], strict=True):
            if old.verdict != new.verdict:
                yield Change(name, crowd.ready.bound(items), old.verdict, new.verdict)


def _so_far(
    state: int, scene: Scene, edges: Edges, lost: Set[str], changes: tuple[Change, ...]
) -> SoFar:
    """``lost`` are the rules that have been violated for good, by objects now there or not."""
    rules = {
        crowd.ready.rule.name: _verdict_on(crowd.ready, edges[crowd.place], lost)
        for crowd in scene.crowds
    }
    hard = (crowd.ready.rule for crowd in scene.crowds if crowd.ready.rule.strength == "hard")
    verdict = together(rules[rule.name] for rule in hard)
    return SoFar(state, verdict, MappingProxyType(rules), changes)


def _verdict_on(ready: Ready, edges: Edges, lost: Set[str]) -> Prefix:
    if ready.rule.name in lost:
        return "violated"
    found = together({edge.verdict for edge in edges})
    # What all who are there have satisfied for good another may still come and violate.
    if found == "satisfied" and ready.rule.variables and ready.rule.machine.safe != 0:
        return "holds so far"
    return found
