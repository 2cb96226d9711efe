"""Explanations of violations: values of reads and subformulas by state."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Protocol, TypeVar

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.mealy_monitor import MealyMonitor, NumberRead
from rulec.automata.thresholds import exact_step
from rulec.logic import formula as ltl
from rulec.logic.bounds import in_steps
from rulec.logic.causes import deciding_instants
from rulec.logic.kleene import Unknown, holds, objects_counted, weighted_sum
from rulec.logic.printing import formula_text, term_text
from rulec.logic.semantics import values_of_parts
from rulec.monitoring.bindings import bindings
from rulec.monitoring.explain.margins import Margin, margin_in
from rulec.monitoring.explain.nearest_satisfying import Letter, Repair, nearest_satisfying
from rulec.monitoring.limits import LIMITS
from rulec.monitoring.state_validation import has_partial_values
from rulec.monitoring.state_view import StateView
from rulec.monitoring.uncertainty.one_completion import completed, with_all_defaults
from rulec.monitoring.uncertainty.state_letters.possible_letters import untold_names, with_untold
from rulec.monitoring.verdict import Violation
from rulec.monitoring.verify import letter_reader_of
from rulec.trace import Trace, Value
from rulec.value_display import short_repr
from rulec.vocabulary import Quantity, Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN_TYPES, Interval

_Known = TypeVar("_Known")


@dataclass(frozen=True, slots=True)
class Observation:
    """Read of a rule, such as ``position(v1)``, with its values by state.

    A value that is unknown is None, a number may be an interval. ``unit`` is a quantity's.
    ``objects`` are, for a count, those that counted in each state. ``margins`` are, for a signal
    that was decided by a number, by how much, as far as is known.
    ``changed``: does the rule tell the value in the decisive state from the one before?
    ``decides``: does a part that decides read it?
    """

    text: str
    values: tuple[Value | Interval | None, ...]
    changed: bool
    decides: bool
    unit: str = ""
    objects: tuple[tuple[str, ...], ...] | None = None
    margins: tuple[Margin | None, ...] = ()


@dataclass(frozen=True, slots=True)
class Part:
    """Subformula at a ``depth`` of nesting, with its truth by state.

    ``changed``: is its value in the decisive state another than in the one before? ``decides``: is
    it one of those that, at some instant, make the formula come out as it does? ``margins`` are a
    comparison's by state.
    """

    formula: ltl.Formula
    text: str
    depth: int
    values: tuple[bool, ...]
    changed: bool
    decides: bool
    margins: tuple[Margin | None, ...] = ()


@dataclass(frozen=True, slots=True)
class Explanation:
    """A violation state by state.

    ``states`` are the numbers of the states that are shown, ``decisive`` is the one after which
    nothing could save the rule any more, or the last one. ``facts`` and ``parts`` have a value for
    each of ``states``; the first part is the formula itself, each stands before what it is made of.
    ``lasts`` are the first and the last state of the stretch in which what always, or never, has to
    be is broken; of other rules the decisive state. ``repair`` is what states would have had to say
    for the rule to be kept, their places being their numbers in the trace; None if nothing would
    have helped.
    """

    __repr__ = short_repr

    rule: CompiledRule
    violation: Violation
    states: tuple[int, ...]
    decisive: int
    facts: tuple[Observation, ...]
    parts: tuple[Part, ...]
    repair: tuple[Repair, ...] | None
    vocabulary: Vocabulary
    lasts: tuple[int, int]

    def margins(self) -> list[Margin]:
        """By how much: the comparisons of quantities that decide, in the decisive state."""
        at = self.states.index(self.decisive)
        margins = [fact.margins[at] for fact in self.facts if fact.decides and fact.margins]
        margins += [part.margins[at] for part in self.parts if part.decides and part.margins]
        return [margin for margin in dict.fromkeys(margins) if margin is not None]


class Deciding(Protocol):
    """The numbers by which a signal about objects was decided."""

    def margin(self, item: str, state: int) -> Margin | None:
        """The margin for an object in a state of the trace."""


def explain(
    violation: Violation,
    trace: Trace,
    rulebook: CompiledRulebook,
    decided_by: Mapping[str, Deciding] = MappingProxyType({}),
) -> Explanation:
    """Explain a violation that ``verify`` reported for this trace and rulebook.

    What is unknown is shown as such; as every completion violates the rule, one stands for all.
    Numbers have their middles there. ``decided_by``: signal -> the numbers behind it, for those
    that were decided by any.
    """
    given, declared = trace, rulebook.vocabulary
    untold = untold_names(declared, trace.told)
    if untold or trace.ends == "cut" or any(map(has_partial_values, trace.states)):
        trace = completed(trace, declared)
        rulebook = replace(rulebook, vocabulary=with_all_defaults(declared))
    rule = next(rule for rule in rulebook.rules if rule.name == violation.rule)
    candidates = bindings(
        rule, rulebook.vocabulary, trace.objects, trace.present, len(trace.states)
    )
    binding = next(binding for binding in candidates if binding.objects == violation.binding)
    reader = letter_reader_of(trace, rulebook)
    stretch = range(binding.first, binding.last + 1)
    decisive = binding.last if violation.step is None else violation.step
    states = _shown(stretch, decisive)
    observed = _ObservedStates(
        [reader.view(number) for number in stretch],
        binding.objects,
        [number - binding.first for number in states],
        decisive - binding.first,
        [StateView(given.states[n], {}, with_untold(declared, untold)) for n in stretch],
    )
    truths = {atom: observed.truths(atom) for atom in dict.fromkeys(ltl.atoms_of(rule.formula))}
    word = [
        frozenset(atom for atom, column in truths.items() if column[n]) for n in range(len(stretch))
    ]
    formula = in_steps(rule.formula, exact_step(trace.step_s))
    values = values_of_parts(formula, word, rulebook.semantics)
    instants = deciding_instants(formula, word, rulebook.semantics)
    deciding = {part for part, at in instants.items() if any(at)}
    lasts = _broken_stretch(formula, values, decisive - binding.first)
    repair = nearest_satisfying(rule.machine, observed.word(rule.machine))
    return Explanation(
        rule=rule,
        violation=violation,
        states=states,
        decisive=decisive,
        facts=tuple(
            _with_margins(fact, decided_by, states) for fact in _facts(truths, deciding, observed)
        ),
        parts=tuple(_parts((rule.formula, formula), values, deciding, observed)),
        repair=repair
        and tuple([replace(change, place=binding.first + change.place) for change in repair]),
        vocabulary=rulebook.vocabulary,
        lasts=(binding.first + lasts[0], binding.first + lasts[1]),
    )


def _broken_stretch(
    formula: ltl.Formula, values: Mapping[ltl.Formula, list[bool]], decisive: int
) -> tuple[int, int]:
    """The stretch around a state in which the body of an outermost always or never is broken."""
    for part, wanted in _bodies(formula):
        column = values[part]
        broken = [n for n in range(decisive, -1, -1) if column[n] is not wanted]
        if broken:
            first = last = broken[0]
            while first > 0 and column[first - 1] is not wanted:
                first -= 1
            while last + 1 < len(column) and column[last + 1] is not wanted:
                last += 1
            return first, max(last, decisive)
    return decisive, decisive


def _bodies(formula: ltl.Formula) -> Iterator[tuple[ltl.Formula, bool]]:
    """What has to be true, or false, in all states, and which of both."""
    match formula:
        case ltl.Unary(ltl.UnaryOperator.ALWAYS, body, None):
            yield body, True
        case ltl.Unary(ltl.UnaryOperator.NEVER, body, None):
            yield body, False
        case ltl.Binary(ltl.BinaryOperator.AND, left, right):
            yield from _bodies(left)
            yield from _bodies(right)
        case ltl.Binary(ltl.BinaryOperator.IMPLIES | ltl.BinaryOperator.OR, _, right):
            yield from _bodies(right)


def _with_margins(
    fact: Observation, decided_by: Mapping[str, Deciding], states: Sequence[int]
) -> Observation:
    name, _, rest = fact.text.partition("(")
    if name not in decided_by:
        return fact
    numbers = decided_by[name]
    margins = tuple([numbers.margin(rest.removesuffix(")"), state) for state in states])
    return replace(fact, margins=margins)


def _shown(stretch: range, decisive: int) -> tuple[int, ...]:
    if len(stretch) <= LIMITS.states_shown:
        return tuple(stretch)
    last = min(decisive + 1, stretch[-1])
    first = max(stretch[0], last - LIMITS.states_shown + 2)
    return tuple(sorted({stretch[0], *range(first, last + 1)}))


def _known(value: _Known | Unknown) -> _Known:
    assert not isinstance(value, Unknown), "verify has read it"
    return value


@dataclass(frozen=True, slots=True)
class _ObservedStates:
    """States of a binding, all of whose values are known.

    ``shown`` are the indices of the states to show, ``decisive`` is one of them. ``given`` are the
    states of which they are completions.
    """

    views: Sequence[StateView]
    bound: Mapping[str, str]
    shown: Sequence[int]
    decisive: int
    given: Sequence[StateView]

    def items(self, variables: Sequence[str]) -> tuple[str, ...]:
        """The objects of some variables."""
        return tuple([self.bound[variable] for variable in variables])

    def value(self, name: str, variables: Sequence[str], view: StateView) -> Value:
        """The value of a declaration in one of the states."""
        value = view.value(name, self.items(variables))
        assert not isinstance(value, Unknown), "verify has read it"
        return value

    def truths(self, proposition: ltl.Proposition) -> list[bool]:
        """Truth of a proposition in each state."""
        return [holds(proposition, self.bound, view) is True for view in self.views]

    def word(self, machine: MealyMonitor) -> list[Letter]:
        """The letters that a machine reads, digit by digit."""
        return [
            tuple(
                [
                    read.digit(_known(weighted_sum(read.terms, self.bound, view)))
                    if isinstance(read, NumberRead)
                    else read.digit(self.value(read.name, read.variables, view))
                    for read in machine.reads
                ]
            )
            for view in self.views
        ]

    def margins(self, comparison: ltl.Comparison) -> tuple[Margin | None, ...]:
        """The margins of a comparison in the states that are shown; none of one of counts."""
        if any(isinstance(term, ltl.Count) for _, term in comparison.terms):
            return ()
        margins = [margin_in(comparison, self.bound, self.given[number]) for number in self.shown]
        return tuple([None if isinstance(one, Unknown) else one for one in margins])

    def changes(self, values: Sequence[object]) -> bool:
        """Tell whether the decisive state's value differs from the one before."""
        return self.decisive > 0 and values[self.decisive] != values[self.decisive - 1]


def _facts(
    truths: Mapping[ltl.Proposition, list[bool]],
    deciding: Set[ltl.Formula],
    observed: _ObservedStates,
) -> Iterator[Observation]:
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
        # A number always changes a little; what counts is whether it passes a limit.
        passes = isinstance(read, ltl.Atom) or any(
            observed.changes(truths[proposition]) for proposition in propositions
        )
        values: list[Value | Interval | None]
        unit, objects = "", None
        if isinstance(read, ltl.Count):
            text = term_text(read)
            counted = [_known(objects_counted(read, observed.bound, view)) for view in views]
            values, objects = list(map(len, counted)), tuple(counted[n] for n in observed.shown)
        else:
            text = str(ltl.Atom(read.name, observed.items(read.arguments)))
            values = [observed.value(read.name, read.arguments, view) for view in views]
            items = observed.items(read.arguments)
            for index, view in enumerate(observed.given):
                given = view.given(read.name, items)
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


def _parts(
    formulas: tuple[ltl.Formula, ltl.Formula],
    truths: Mapping[ltl.Formula, list[bool]],
    deciding: Set[ltl.Formula],
    observed: _ObservedStates,
    depth: int = 0,
) -> Iterator[Part]:
    written, stepped = formulas
    yield Part(
        formula=written,
        text=formula_text(written),
        depth=depth,
        values=tuple(truths[stepped][n] for n in observed.shown),
        changed=observed.changes(truths[stepped]),
        decides=stepped in deciding,
        margins=observed.margins(written) if isinstance(written, ltl.Comparison) else (),
    )
    match formulas:
        case ltl.Unary(_, operand), ltl.Unary(_, same):
            operands = [(operand, same)]
        case ltl.Binary(_, left, right), ltl.Binary(_, same_left, same_right):
            operands = [(left, same_left), (right, same_right)]
        case _:
            operands = []
    for both in operands:
        yield from _parts(both, truths, deciding, observed, depth + 1)
