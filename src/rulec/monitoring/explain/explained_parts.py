"""The rows of an explanation by state: values that a rule reads, and parts of its formula."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from typing import Protocol, TypeAlias

from rulec.logic import formula as ltl
from rulec.logic.kleene import objects_counted
from rulec.logic.printing import formula_text, term_text
from rulec.monitoring.explain.margins import Margin
from rulec.monitoring.explain.observed_states import ObservedStates, known_value
from rulec.trace import Value
from rulec.vocabulary import Quantity
from rulec.vocabulary.partial_values import UNKNOWN_TYPES, Interval

Measured: TypeAlias = tuple[Margin, int]
"""A margin, and the number of the state in which it was measured."""


@dataclass(frozen=True, slots=True)
class Observation:
    """A read of a rule, such as ``position(v1)``, with its values by state.

    An unknown value is None, a number may be an interval. ``unit`` is that of a quantity. For a
    count, ``objects`` are those that counted in each state. For a signal that was decided by a
    number, ``margins`` are its known margins by state, and ``measured`` is the one where the signal
    last decides, with the number of that state. ``changed``: the rule distinguishes the value in
    the decisive state from the one before. ``decides``: a part that decides reads it.
    """

    text: str
    values: tuple[Value | Interval | None, ...]
    changed: bool
    decides: bool
    unit: str = ""
    objects: tuple[tuple[str, ...], ...] | None = None
    margins: tuple[Margin | None, ...] = ()
    measured: Measured | None = None


@dataclass(frozen=True, slots=True)
class Part:
    """A subformula at a ``depth`` of nesting, with its truth by state.

    ``changed``: its value in the decisive state differs from the one before. ``decides``: at some
    instant it is one of the parts that determine the outcome of the formula. ``margins`` are a
    comparison's by state; ``measured`` is that of the last state up to the decisive one, shown or
    not, in which it decides, with the number of that state. A comparison ``turns`` if the rule
    would have been kept there, had its margin been closed; ``measured`` is then of that state.
    """

    formula: ltl.Formula
    depth: int
    values: tuple[bool, ...]
    changed: bool
    decides: bool
    margins: tuple[Margin | None, ...] = ()
    measured: Measured | None = None
    turns: bool = False

    @property
    def text(self) -> str:
        """The subformula in a rulebook's notation."""
        return formula_text(self.formula)


class Deciding(Protocol):
    """The numbers by which a signal about objects was decided."""

    def margin(self, item: str, state: int) -> Margin | None:
        """The margin for an object in a state of the trace."""


def facts_of(
    truths: Mapping[ltl.Proposition, int],
    deciding: Set[ltl.Formula],
    observed: ObservedStates,
) -> Iterator[Observation]:
    """The observations, from the ``truths`` of propositions, a bit per state."""
    readers: dict[ltl.Atom | ltl.Term, list[ltl.Proposition]] = {}
    for proposition in truths:
        if isinstance(proposition, ltl.Comparison):
            for _, term in proposition.terms:
                readers.setdefault(term, []).append(proposition)
        else:
            atom = ltl.Atom(proposition.name, proposition.arguments)
            readers.setdefault(atom, []).append(proposition)
    views, vocabulary = observed.views, observed.views[0].vocabulary
    for read, propositions in readers.items():
        # Numbers always change a little; what matters is whether they pass a limit.
        passes = isinstance(read, ltl.Atom) or any(
            observed.flips(truths[proposition]) for proposition in propositions
        )
        values: dict[int, Value | Interval | None]
        unit, objects = "", None
        if isinstance(read, ltl.Count):
            text = term_text(read)
            counted = {
                n: known_value(objects_counted(read, observed.bound, views[n]))
                for n in observed.looked_up
            }
            values = {n: len(those) for n, those in counted.items()}
            objects = tuple(counted[n] for n in observed.shown)
        else:
            text = str(ltl.Atom(read.name, observed.items(read.arguments)))
            values = {
                n: observed.value(read.name, read.arguments, views[n]) for n in observed.looked_up
            }
            items = observed.items(read.arguments)
            for index in values:
                given = observed.given(index).given(read.name, items)
                if given is None or type(given) in UNKNOWN_TYPES:
                    values[index] = given if isinstance(given, Interval) else None
            declaration = vocabulary.declarations[read.name]
            unit = declaration.unit if isinstance(declaration, Quantity) else ""
        yield Observation(
            text,
            values=tuple(values[n] for n in observed.shown),
            changed=passes and observed.changes(values),
            decides=not deciding.isdisjoint(propositions),
            unit=unit,
            objects=objects,
        )


def parts_of(
    formulas: tuple[ltl.Formula, ltl.Formula],
    truths: Mapping[ltl.Formula, list[bool]],
    deciding: Mapping[ltl.Formula, int],
    observed: ObservedStates,
    *,
    turned: Mapping[ltl.Formula, int],
    depth: int = 0,
) -> Iterator[Part]:
    """A formula and its parts, as written and with bounds in steps, each before its operands.

    For parts that decide, ``deciding`` has the index of the last state in which they do; ``turned``
    has the same for a comparison that ``turns``.
    """
    written, stepped = formulas
    margins: tuple[Margin | None, ...] = ()
    measured: Measured | None = None
    if isinstance(written, ltl.Comparison):
        margins = observed.margins(written)
        index = turned.get(stepped, deciding.get(stepped))
        if margins and index is not None:
            margin = observed.margin(written, index)
            measured = None if margin is None else (margin, observed.numbers[index])
    yield Part(
        formula=written,
        depth=depth,
        values=tuple(truths[stepped][n] for n in observed.shown),
        changed=observed.changes(truths[stepped]),
        decides=stepped in deciding,
        turns=stepped in turned,
        margins=margins,
        measured=measured,
    )
    match formulas:
        case ltl.Unary(_, operand), ltl.Unary(_, same):
            operands = [(operand, same)]
        case ltl.Binary(_, left, right), ltl.Binary(_, same_left, same_right):
            operands = [(left, same_left), (right, same_right)]
        case _:
            operands = []
    for both in operands:
        yield from parts_of(both, truths, deciding, observed, turned=turned, depth=depth + 1)


def with_margins(
    fact: Observation,
    decided_by: Mapping[str, Deciding],
    states: Sequence[int],
    decided_at: Mapping[str, int],
) -> Observation:
    """The observation, with the margins of the number by which it was decided, if any.

    ``states`` are the numbers of those shown, ``decided_at`` is the one in which a name decides
    last.
    """
    name, _, rest = fact.text.partition("(")
    if name not in decided_by:
        return fact
    numbers, item = decided_by[name], rest.removesuffix(")")
    margins = tuple([numbers.margin(item, state) for state in states])
    at = decided_at.get(name)
    margin = None if at is None else numbers.margin(item, at)
    measured = None if at is None or margin is None else (margin, at)
    return replace(fact, margins=margins, measured=measured)
