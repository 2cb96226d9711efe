"""Bindings of a rule's variables to a trace's objects."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.diagnostics import SourceLocation
from rulec.resource_limits import CHOICES
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.vocabulary_model import choices, number_of_choices

MANY = 1 << 13
"""From so many choices of objects for three variables and more on, only those are made that may
not be kept."""


@dataclass(frozen=True, slots=True)
class Binding:
    """Objects for a rule's variables, from state ``first`` to ``last`` (inclusive)."""

    objects: Mapping[str, str]
    first: int
    last: int


def bindings(
    rule: CompiledRule,
    vocabulary: Vocabulary,
    objects: Mapping[str, str],
    present: Mapping[str, tuple[int, int]],
    n_states: int,
) -> Iterator[Binding]:
    """All bindings of a rule's variables to distinct objects of their types.

    A binding counts on the stretch in which all its objects are present; one whose objects are
    never present together is left out. A rule without variables has one binding, the empty one.
    """
    names = [variable.name for variable in rule.variables]
    types = [variable.type for variable in rule.variables]
    for chosen in choices(types, objects, vocabulary, f"rule `{rule.name}`"):
        binding = binding_of(dict(zip(names, chosen, strict=True)), present, n_states)
        if binding.first <= binding.last:
            yield binding


def check_choices(
    rule: CompiledRule,
    vocabulary: Vocabulary,
    objects: Mapping[str, str],
    place: SourceLocation | None,
) -> None:
    """Raise RulecError R0718 if a rule's bindings to a trace's objects are beyond the limit."""
    types = [variable.type for variable in rule.variables]
    if len(types) > 1:
        number = number_of_choices(types, objects, vocabulary)
        CHOICES.within(number, place, f"rule `{rule.name}`")


def has_many(rule: CompiledRule, vocabulary: Vocabulary, objects: Mapping[str, str]) -> bool:
    """Whether a rule's bindings are too many to make them all."""
    types = [variable.type for variable in rule.variables]
    return len(types) > 2 and number_of_choices(types, objects, vocabulary) > MANY


def binding_of(
    objects: Mapping[str, str], present: Mapping[str, tuple[int, int]], n_states: int
) -> Binding:
    """The binding to these objects, which ends before it begins if they never meet."""
    stretches = [present.get(item, (0, n_states - 1)) for item in objects.values()]
    first = max((start for start, _ in stretches), default=0)
    last = min((end for _, end in stretches), default=n_states - 1)
    return Binding(objects, first, last)
