"""How probable it is that a maneuver keeps each rule, if obstacles have several predictions.

What an obstacle does is independent of what the others do. Whatever they do, ego goes through the
same cells. It keeps a rule for some objects if its trace does and none of these objects hits it.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from math import prod

from rulec.automata.compiled import CompiledRule
from rulec.automata.facts import counts
from rulec.logic.formula import Comparison, Count, Formula, atoms_of
from rulec.maneuvers.applying import in_words, past_for
from rulec.maneuvers.events import Event, none_of
from rulec.maneuvers.judging import Maneuvers
from rulec.partition.worlds import PredictedPath, predicted_path
from rulec.runtime.binding import Binding, bindings
from rulec.runtime.cheapest import Maneuver
from rulec.runtime.instances import HARD, SOFT
from rulec.runtime.letters import Columns
from rulec.runtime.verify import run

MOST_WORLDS = 10_000
"""So many worlds are looked at one by one for a rule that counts objects, and no more."""


@dataclass(frozen=True, slots=True)
class ForObjects:
    """The probability that a rule is kept for these objects, the scenario's."""

    binding: Mapping[str, str]
    kept: Fraction


@dataclass(frozen=True, slots=True)
class RuleChance:
    """The probability that a rule is kept for all objects, and those below 1 for some of them.

    None if the rule counts objects, and these can do more together than can be looked at.
    """

    rule: CompiledRule
    kept: Fraction | None
    bindings: tuple[ForObjects, ...]


@dataclass(frozen=True, slots=True)
class Chances:
    """The probabilities that nobody hits ego, that besides every hard rule is kept, and each rule.

    ``hard`` is None if that of one of the hard rules is.
    """

    clear: Fraction
    hard: Fraction | None
    rules: tuple[RuleChance, ...]


def chances(found: Maneuvers, maneuver: Maneuver) -> Chances:
    """The probabilities of one of the maneuvers: exact. Raises RulecError as ``best`` does."""
    return _Judge(found, predicted_path(found.graph, maneuver.nodes)).chances()


class _Judge:
    def __init__(self, found: Maneuvers, path: PredictedPath) -> None:
        self._book = found.rules
        self._path = path
        obstacles = {name: one.obstacle for name, one in path.predicted.items()}
        self._words = in_words(found.graph, path.traces, obstacles, found.rules.vocabulary)
        self._states = [state for (state,) in self._words.states]
        self._past = past_for(found.graph, found.paths, found.rules, (*HARD, *SOFT), found.after)

    def chances(self) -> Chances:
        weights = self._path.weights
        hit = {self._event([name]) for name in self._path.hit}
        hard: set[Event] | None = set(hit)
        rules = []
        for rule in self._book.rules:
            lost = self._lost(rule)
            if lost is None:
                rules.append(RuleChance(rule, None, ()))
                hard = None if rule.strength == "hard" else hard
                continue
            events = {event for about in lost.values() for event in about}
            names = [variable.name for variable in rule.variables]
            rules.append(
                RuleChance(
                    rule,
                    none_of(events, weights),
                    tuple(
                        ForObjects(dict(zip(names, objects, strict=True)), none_of(about, weights))
                        for objects, about in lost.items()
                        if objects
                    ),
                )
            )
            if rule.strength == "hard" and hard is not None:
                hard |= events
        clear = none_of(hit, weights)
        return Chances(clear, None if hard is None else none_of(hard, weights), tuple(rules))

    def _event(self, names: Collection[str]) -> Event:
        """That these do as they are predicted to; what is certain does not count."""
        who = [self._path.predicted[name] for name in names]
        return frozenset((one.of, one.number) for one in who if len(self._path.weights[one.of]) > 1)

    def _lost(self, rule: CompiledRule) -> dict[tuple[str, ...], set[Event]] | None:
        """For which of the scenario's objects a rule is not kept in which events."""
        if counts(rule.formula):
            return self._lost_counting(rule)
        columns = self._columns(self._words.objects)
        lost: dict[tuple[str, ...], set[Event]] = {}
        for binding in self._bindings(rule, self._words.objects):
            names = list(binding.objects.values())
            event = self._event(names)
            together = len({one for one, _ in event}) == len(event)
            if together and not self._keeps(rule, binding, columns):
                lost.setdefault(self._of(names), set()).add(event)
        return lost

    def _lost_counting(self, rule: CompiledRule) -> dict[tuple[str, ...], set[Event]] | None:
        """The same where it matters what all objects of some types do: world by world."""
        types = {*(variable.type for variable in rule.variables), *_counted(rule.formula)}
        matters = {
            name
            for name, kind in self._words.objects.items()
            if any(self._book.vocabulary.is_subtype(kind, one) for one in types)
        }
        about = {self._path.predicted[name].of for name in matters}
        uncertain = {
            of: tuple(own) for of, own in self._path.weights.items() if of in about and len(own) > 1
        }
        if prod(map(len, uncertain.values())) > MOST_WORLDS:
            return None
        lost: dict[tuple[str, ...], set[Event]] = {}
        for numbers in product(*uncertain.values()):
            world = dict(zip(uncertain, numbers, strict=True))
            there = {
                name: kind for name, kind in self._words.objects.items() if self._is_in(world, name)
            }
            hit = not self._path.hit.isdisjoint(matters.intersection(there))
            columns = self._columns(there)
            for binding in self._bindings(rule, there):
                if hit or not self._keeps(rule, binding, columns):
                    of = self._of(binding.objects.values())
                    lost.setdefault(of, set()).add(frozenset(world.items()))
        return lost

    def _is_in(self, world: Mapping[str, int], name: str) -> bool:
        one = self._path.predicted[name]
        return world.get(one.of, one.number) == one.number

    def _of(self, names: Iterable[str]) -> tuple[str, ...]:
        return tuple([self._path.predicted[name].of for name in names])

    def _columns(self, objects: Mapping[str, str]) -> Columns:
        return Columns(
            self._states,
            self._book.vocabulary,
            "the maneuver's cell of layer {}".format,
            objects=objects,
            present=self._words.present,
            facts=self._book.facts,
        )

    def _bindings(self, rule: CompiledRule, objects: Mapping[str, str]) -> Iterator[Binding]:
        there = self._words.present
        return bindings(rule, self._book.vocabulary, objects, there, len(self._states))

    def _keeps(self, rule: CompiledRule, binding: Binding, columns: Columns) -> bool:
        """Is it kept for these objects? Not if one of them hits ego."""
        names = binding.objects.values()
        about = (rule.name, self._of(names))
        goes_on = binding.first == 0
        if goes_on and about in self._past.settled:
            return True
        if not self._path.hit.isdisjoint(names):
            return False
        word = columns.word(rule, binding.objects, binding.first, binding.last)
        start = self._past.states.get(about, 0) if goes_on else 0
        return run(rule.machine, word, start)[0]


def _counted(formula: Formula) -> Iterator[str]:
    """The types of the objects that a formula counts."""
    for one in atoms_of(formula):
        for _, term in one.terms if isinstance(one, Comparison) else ():
            if isinstance(term, Count):
                yield term.type
                yield from _counted(term.body)
