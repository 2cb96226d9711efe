"""The subjects of reads and formulas, and which of them are unknown in a state."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Protocol, TypeAlias

from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.logic import formula as ltl
from rulec.logic.kleene import PartialState
from rulec.vocabulary.partial_values import UNKNOWN_TYPES, PartialValue

Subject: TypeAlias = tuple[str, tuple[str, ...]]
"""The name of a declaration, with the objects that it is about."""


class MissingValueError(Exception):
    """Some completion needs a value that is neither given nor has a default."""

    def __init__(self, name: str, objects: tuple[str, ...]) -> None:
        super().__init__(name)
        self.subject = name, objects


class PartialView(PartialState, Protocol):
    """A state, like a ``StateView``, with possibly partial values."""

    def given(self, name: str, items: tuple[str, ...]) -> PartialValue | None:
        """The value in the state, possibly partial, or the declared default."""


def unknown_in_read(
    read: Read | NumberRead, binding: Mapping[str, str], view: PartialView
) -> frozenset[Subject]:
    """The unknown subjects of a read."""
    return frozenset(x for x in subjects_of_read(read, binding, view) if is_unknown(x, view))


def subjects_of_read(
    read: Read | NumberRead, binding: Mapping[str, str], view: PartialView
) -> Iterator[Subject]:
    """What a read depends on, with repetitions."""
    if isinstance(read, Read):
        yield read.name, tuple([binding[variable] for variable in read.variables])
    else:
        for _, term in read.terms:
            yield from subjects_in(term, binding, view)


def unknown_subjects(
    part: ltl.Formula | ltl.Term, environment: Mapping[str, str], view: PartialView
) -> frozenset[Subject]:
    """The unknown subjects in a formula or a term."""
    return frozenset(x for x in subjects_in(part, environment, view) if is_unknown(x, view))


def is_unknown(subject: Subject, view: PartialView) -> bool:
    """Whether no single value is known."""
    return type(view.given(*subject)) in UNKNOWN_TYPES


def subjects_in(
    part: ltl.Formula | ltl.Term, environment: Mapping[str, str], view: PartialView
) -> Iterator[Subject]:
    """The subjects in a formula or a term, for these objects and those that may count."""
    match part:
        case ltl.Atom(name, arguments) | ltl.QuantityTerm(name, arguments):
            yield name, tuple([environment[variable] for variable in arguments])
        case ltl.Count(variable, _, body):
            for item in candidates(part, view):
                yield from subjects_in(body, {**environment, variable: item}, view)
        case ltl.Comparison(terms):
            for _, term in terms:
                yield from subjects_in(term, environment, view)
        case ltl.Unary(_, operand):
            yield from subjects_in(operand, environment, view)
        case ltl.Binary(_, left, right):
            yield from subjects_in(left, environment, view)
            yield from subjects_in(right, environment, view)


def candidates(count: ltl.Count, view: PartialView) -> Iterator[str]:
    """The objects that may count."""
    return (
        name for name, own in view.objects.items() if view.vocabulary.is_subtype(own, count.type)
    )
