"""Predictions of an obstacle that a counting rule cannot tell apart."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

from rulec.automata.axiom_instances import counts
from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.logic.formula import Comparison, Count, Formula, atoms_of
from rulec.logic.free_names import variables_of
from rulec.logic.kleene import holds
from rulec.monitoring.state_view import StateView
from rulec.monitoring.verify import Binding
from rulec.partition.prediction_worlds import PredictedPath
from rulec.trace import TraceGraph
from rulec.vocabulary import Vocabulary


class PredictionClasses:
    """Classes of predictions by their contribution to counts, on one path."""

    def __init__(
        self,
        rule: CompiledRule,
        path: PredictedPath,
        words: TraceGraph,
        vocabulary: Vocabulary,
    ) -> None:
        self._terms = list(dict.fromkeys(_terms(rule.formula)))
        self._path = path
        self._moments = [StateView(state, words.objects, vocabulary) for (state,) in words.states]
        self._words = words
        self._truth = cache(self._is_counted)

    def groups(self, obstacle: str, binding: Binding) -> list[list[int]]:
        """An obstacle's predictions that do not hit ego, in groups.

        Those of a group count alike in every state, for a rule that is about other objects.
        """
        result: dict[object, list[int]] = {}
        for number in self._path.weights[obstacle]:
            names = [
                name
                for name, predicted in self._path.predicted.items()
                if (predicted.of, predicted.number) == (obstacle, number)
            ]
            if self._path.hit.isdisjoint(names):
                result.setdefault(self._counted(names, number, binding), []).append(number)
        return list(result.values())

    def _counted(self, names: list[str], number: int, binding: Binding) -> object:
        """Contribution to every count, term by term and state by state."""
        if any(counts(term.body) for term in self._terms):
            # What it makes of others is not known without them
            return number
        return tuple(
            [
                sum(self._truth(term, layer, name, self._bound(term, binding)) for name in names)
                for term in self._terms
                for layer in range(binding.first, binding.last + 1)
            ]
        )

    def _bound(self, term: Count, binding: Binding) -> tuple[tuple[str, str], ...]:
        """The other objects that a term speaks of."""
        free = dict.fromkeys(variables_of(term.body))
        return tuple(
            [
                (variable, binding.objects[variable])
                for variable in free
                if variable != term.variable
            ]
        )

    def _is_counted(
        self, term: Count, layer: int, name: str, bound: tuple[tuple[str, str], ...]
    ) -> bool:
        moment = self._moments[layer]
        first, last = self._words.present.get(name, (0, len(self._moments) - 1))
        if name not in moment.objects or not first <= layer <= last:
            return False
        if not moment.vocabulary.is_subtype(moment.objects[name], term.type):
            return False
        # If it is not known, whoever reads it is told so
        return holds(term.body, {**dict(bound), term.variable: name}, moment) is True


def counted_types(formula: Formula) -> Iterator[str]:
    """The types of the objects that a formula counts."""
    for term in _terms(formula):
        yield term.type
        yield from counted_types(term.body)


def _terms(formula: Formula) -> Iterator[Count]:
    for atom in atoms_of(formula):
        for _, term in atom.terms if isinstance(atom, Comparison) else ():
            if isinstance(term, Count):
                yield term
