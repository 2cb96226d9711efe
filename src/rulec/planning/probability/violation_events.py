"""In which events a path through a graph loses a rule."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from itertools import product
from math import prod

from rulec.automata.axiom_instances import counts
from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.monitoring.letter_reader import LetterReader
from rulec.monitoring.verify import Binding, bindings, run
from rulec.partition.prediction_worlds import PredictedPath
from rulec.planning.maneuvers import Maneuvers
from rulec.planning.probability.event_probability import Event
from rulec.planning.probability.prediction_classes import PredictionClasses, counted_types
from rulec.planning.product.graph_instances import HARD, SOFT
from rulec.planning.rule_instances import in_rule_words, past_for

MOST_WORLDS = 10_000
"""So many worlds are looked at one by one for a rule that counts objects, and no more."""

Lost = dict[tuple[str, ...], set[Event]]
"""The scenario's objects that a rule is about, and the events in which it is lost for them."""


class ViolationEvents:
    """Events in which rules are violated on one path."""

    def __init__(self, maneuvers: Maneuvers, path: PredictedPath) -> None:
        self._book = maneuvers.rules
        self._path = path
        obstacles = {name: predicted.obstacle for name, predicted in path.predicted.items()}
        self._words = in_rule_words(
            maneuvers.graph, path.traces, obstacles, maneuvers.rules.vocabulary
        )
        self._states = [state for (state,) in self._words.states]
        self._past = past_for(
            maneuvers.graph, maneuvers.paths, maneuvers.rules, (*HARD, *SOFT), maneuvers.after
        )
        self._everybody = self._columns(self._words.objects)

    @property
    def hits(self) -> set[Event]:
        """The events in which an obstacle hits ego."""
        return {self._event([name]) for name in self._path.hit}

    def events(self, rule: CompiledRule) -> Lost | None:
        """Events in which a rule is violated; None if too many."""
        if counts(rule.formula):
            return self._counting(rule)
        lost: Lost = {}
        for binding in self._bindings(rule):
            if not self._keeps(rule, binding, self._everybody):
                names = binding.objects.values()
                lost.setdefault(self._of(names), set()).add(self._event(names))
        return lost

    def _counting(self, rule: CompiledRule) -> Lost | None:
        """Events of a rule that counts further objects.

        Only what they do differently in the rule's eyes makes a world of its own.
        """
        alike = PredictionClasses(rule, self._path, self._words, self._book.vocabulary)
        matters = [name for name in self._words.objects if self._concerns(rule, name)]
        hitting = [name for name in matters if name in self._path.hit]
        left = MOST_WORLDS
        lost: Lost = {}
        for binding in self._bindings(rule):
            names = binding.objects.values()
            event = self._event(names)
            about = {
                self._path.predicted[name].of: self._path.predicted[name].number for name in names
            }
            events = {event | self._event([name]) for name in hitting if self._is_in(about, name)}
            if event not in events:
                others = {
                    of: alike.groups(of, binding)
                    for of in {self._path.predicted[name].of for name in matters} - about.keys()
                }
                left -= prod(map(len, others.values()))
                if left < 0:
                    return None
                for chosen in product(*others.values()):
                    world = {of: group[0] for of, group in zip(others, chosen, strict=True)}
                    there = [
                        name
                        for name in self._words.objects
                        if self._is_in({**about, **world}, name)
                    ]
                    columns = self._columns({name: self._words.objects[name] for name in there})
                    if not self._keeps(rule, binding, columns):
                        open_ones = [
                            [(of, number) for number in group]
                            for of, group in zip(others, chosen, strict=True)
                            if len(others[of]) > 1
                        ]
                        events |= {event.union(combination) for combination in product(*open_ones)}
            if events:
                lost.setdefault(self._of(names), set()).update(events)
        return lost

    def _concerns(self, rule: CompiledRule, name: str) -> bool:
        """Test whether the rule is about an object's type, or counts it."""
        kind = self._words.objects[name]
        types = {*(variable.type for variable in rule.variables), *counted_types(rule.formula)}
        return any(self._book.vocabulary.is_subtype(kind, type_) for type_ in types)

    def _is_in(self, world: Mapping[str, int], name: str) -> bool:
        """Test whether an obstacle is there in a partial world."""
        predicted = self._path.predicted[name]
        return world.get(predicted.of, predicted.number) == predicted.number

    def _event(self, names: Collection[str]) -> Event:
        """Event that these predictions come true; certain ones are left out."""
        who = [self._path.predicted[name] for name in names]
        return frozenset(
            (predicted.of, predicted.number)
            for predicted in who
            if len(self._path.weights[predicted.of]) > 1
        )

    def _of(self, names: Iterable[str]) -> tuple[str, ...]:
        return tuple([self._path.predicted[name].of for name in names])

    def _columns(self, objects: Mapping[str, str]) -> LetterReader:
        return LetterReader(
            self._states,
            self._book,
            "the maneuver's cell of layer {}".format,
            objects=objects,
            present=self._words.present,
        )

    def _bindings(self, rule: CompiledRule) -> Iterator[Binding]:
        """Bindings whose objects' predictions can come true together."""
        vocabulary, objects = self._book.vocabulary, self._words.objects
        for binding in bindings(rule, vocabulary, objects, self._words.present, len(self._states)):
            who = [self._path.predicted[name] for name in binding.objects.values()]
            if len({predicted.of for predicted in who}) == len(
                {(predicted.of, predicted.number) for predicted in who}
            ):
                yield binding

    def _keeps(self, rule: CompiledRule, binding: Binding, columns: LetterReader) -> bool:
        """Verdict on a binding; a collision with its objects violates."""
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
