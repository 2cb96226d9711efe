"""Bindings of a rule's variables to a trace's objects."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.diagnostics import SourceLocation
from rulec.resource_limits import CHOICES
from rulec.rulebook.rules.axiom_instances import bound_to
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.vocabulary_model import number_of_choices

MANY = 1 << 13
"""From this many choices of objects for three or more variables on, only some are built.

These are the choices that may not be kept.
"""


@dataclass(frozen=True, slots=True)
class Binding:
    """Objects for a rule's variables, from state ``first`` to ``last`` (inclusive)."""

    objects: Mapping[str, str]
    first: int
    last: int


@dataclass(frozen=True, slots=True)
class Cast:
    """The objects of a trace with their types, and the states in which they are ``present``.

    Objects without a stretch in ``present`` are in all states. ``place`` is where they were read.
    """

    objects: Mapping[str, str]
    vocabulary: Vocabulary
    n_states: int
    present: Mapping[str, tuple[int, int]]
    place: SourceLocation | None = None

    def bindings(self, rule: CompiledRule) -> Iterator[Binding]:
        """All bindings of a rule's variables to distinct objects of their types.

        A binding applies to the stretch in which all its objects are present; it is left out if its
        objects are never present together. A rule without variables has one binding, the empty one.

        Raises RulecError R0718 if there are more than the limit `choices`.
        """
        types = types_of(rule)
        if len(types) > 1:
            number = number_of_choices(types, self.objects, self.vocabulary)
            CHOICES.within(number, self.place, f"rule `{rule.name}`")
        for chosen in bound_to(rule.variables, self.objects, self.vocabulary):
            binding = binding_of(chosen, self.present, self.n_states)
            if binding.first <= binding.last:
                yield binding

    def has_many(self, types: Sequence[str]) -> bool:
        """Whether there are too many choices of objects of these types to build them all."""
        return len(types) > 2 and number_of_choices(types, self.objects, self.vocabulary) > MANY


def types_of(rule: CompiledRule) -> tuple[str, ...]:
    """The types of a rule's variables."""
    return tuple([variable.type for variable in rule.variables])


def in_usual_order(chosen: Iterable[tuple[str, ...]], cast: Cast) -> list[tuple[str, ...]]:
    """Choices of objects in the order of ``Cast.bindings``."""
    return sorted(chosen, key=usual_order(cast))


def usual_order(cast: Cast) -> Callable[[tuple[str, ...]], list[int]]:
    """The sort key of that order."""
    place_of = {item: place for place, item in enumerate(cast.objects)}
    return lambda items: [place_of[item] for item in items]


def binding_of(
    objects: Mapping[str, str], present: Mapping[str, tuple[int, int]], n_states: int
) -> Binding:
    """The binding to these objects; it ends before it begins if they are never present together."""
    stretches = [present.get(item, (0, n_states - 1)) for item in objects.values()]
    first = max((start for start, _ in stretches), default=0)
    last = min((end for _, end in stretches), default=n_states - 1)
    return Binding(objects, first, last)
