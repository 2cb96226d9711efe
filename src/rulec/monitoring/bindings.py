"""Bindings of a rule's variables to a trace's objects."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.vocabulary_model import choices


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
    for chosen in choices([variable.type for variable in rule.variables], objects, vocabulary):
        binding = binding_of(dict(zip(names, chosen, strict=True)), present, n_states)
        if binding.first <= binding.last:
            yield binding


def binding_of(
    objects: Mapping[str, str], present: Mapping[str, tuple[int, int]], n_states: int
) -> Binding:
    """The binding to these objects, which ends before it begins if they never meet."""
    stretches = [present.get(item, (0, n_states - 1)) for item in objects.values()]
    first = max((start for start, _ in stretches), default=0)
    last = min((end for _, end in stretches), default=n_states - 1)
    return Binding(objects, first, last)
