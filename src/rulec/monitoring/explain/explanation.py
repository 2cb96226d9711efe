"""Explanations of violations: values of reads and subformulas by state."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, replace

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.mealy_monitor import MealyMonitor, NumberRead
from rulec.automata.thresholds import exact
from rulec.logic import formula as ltl
from rulec.logic.bounds import in_steps
from rulec.logic.causes import deciding_instants
from rulec.logic.kleene import Unknown, holds, objects_counted, weighted_sum
from rulec.logic.printing import formula_text, term_text
from rulec.logic.semantics import values_of_parts
from rulec.monitoring.binding import Binding, bindings
from rulec.monitoring.explain.nearest_satisfying import Repair, nearest_satisfying
from rulec.monitoring.limits import LIMITS
from rulec.monitoring.state_view import StateView
from rulec.monitoring.verdict import Violation
from rulec.monitoring.verify import letter_reader_of
from rulec.trace import Trace, Value
from rulec.value_display import short_repr
from rulec.vocabulary import Quantity as QuantityDeclaration
from rulec.vocabulary import Vocabulary


@dataclass(frozen=True, slots=True)
class Observation:
    """Read of a rule, such as ``position(v1)``, with its values by state.

    ``unit`` is a quantity's. ``objects`` are, for a count, those that counted in each state.
    ``changed``: does the rule tell the value in the decisive state from the one before?
    ``decides``: does a part that decides read it?
    """

    text: str
    values: tuple[Value, ...]
    changed: bool
    decides: bool
    unit: str = ""
    objects: tuple[tuple[str, ...], ...] | None = None


@dataclass(frozen=True, slots=True)
class Part:
    """Subformula at a ``depth`` of nesting, with its truth by state.

    ``changed``: is its value in the decisive state another than in the one before? ``decides``: is
    it one of those that, at some instant, make the formula come out as it does?
    """

    formula: ltl.Formula
    text: str
    depth: int
    values: tuple[bool, ...]
    changed: bool
    decides: bool


@dataclass(frozen=True, slots=True)
class Explanation:
    """A violation state by state.

    ``states`` are the numbers of the states that are shown, ``decisive`` is the one after which
    nothing could save the rule any more, or the last one. ``facts`` and ``parts`` have a value for
    each of ``states``; the first part is the formula itself, each stands before what it is made of.
    ``repair`` is what states would have had to say for the rule to be kept, their places being
    their numbers in the trace; None if nothing would have helped.
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


def explain(violation: Violation, trace: Trace, rulebook: CompiledRulebook) -> Explanation:
    """Explain a violation that ``verify`` reported for this trace and rulebook."""
    rule = next(rule for rule in rulebook.rules if rule.name == violation.rule)
    binding = _binding(violation, rule, trace, rulebook.vocabulary)
    columns = letter_reader_of(trace, rulebook)
    stretch = range(binding.first, binding.last + 1)
    decisive = binding.last if violation.step is None else violation.step
    states = _shown(stretch, decisive)
    observed = _ObservedStates(
        [columns.view(number) for number in stretch],
        binding.objects,
        [number - binding.first for number in states],
        decisive - binding.first,
    )
    truths = {atom: observed.truths(atom) for atom in dict.fromkeys(ltl.atoms_of(rule.formula))}
    word = [
        frozenset(atom for atom, column in truths.items() if column[n]) for n in range(len(stretch))
    ]
    formula = in_steps(rule.formula, exact(trace.step_s))
    values = values_of_parts(formula, word, rulebook.semantics)
    instants = deciding_instants(formula, word, rulebook.semantics)
    decides = {part for part, at in instants.items() if any(at)}
    return Explanation(
        rule=rule,
        violation=violation,
        states=states,
        decisive=decisive,
        facts=tuple(_facts(truths, decides, observed)),
        parts=tuple(
            _parts(
                written=rule.formula,
                stepped=formula,
                truths=values,
                deciding=decides,
                observed=observed,
                depth=0,
            )
        ),
        repair=_repair(rule.machine, observed, binding.first),
        vocabulary=rulebook.vocabulary,
    )


def _repair(
    machine: MealyMonitor, observed: _ObservedStates, first: int
) -> tuple[Repair, ...] | None:
    result = nearest_satisfying(
        machine, [observed.letter(machine, view) for view in observed.views]
    )
    return result and tuple([replace(repair, place=first + repair.place) for repair in result])


def _binding(
    violation: Violation, rule: CompiledRule, trace: Trace, vocabulary: Vocabulary
) -> Binding:
    candidates = bindings(rule, vocabulary, trace.objects, trace.present, len(trace.states))
    return next(binding for binding in candidates if binding.objects == violation.binding)


def _shown(stretch: range, decisive: int) -> tuple[int, ...]:
    if len(stretch) <= LIMITS.states_shown:
        return tuple(stretch)
    last = min(decisive + 1, stretch[-1])
    first = max(stretch[0], last - LIMITS.states_shown + 2)
    return tuple(sorted({stretch[0], *range(first, last + 1)}))


@dataclass(frozen=True, slots=True)
class _ObservedStates:
    """States of a binding, all of whose values are known.

    ``shown`` are the indices of the states to show, ``decisive`` is one of them.
    """

    views: Sequence[StateView]
    bound: Mapping[str, str]
    shown: Sequence[int]
    decisive: int

    def truths(self, proposition: ltl.Proposition) -> list[bool]:
        """Truth of a proposition in each state."""
        return [holds(proposition, self.bound, view) is True for view in self.views]

    def values(self, name: str, arguments: Sequence[str]) -> list[Value]:
        """The value of a declaration in each state."""
        items = tuple(self.bound[variable] for variable in arguments)
        result = [view.value(name, items) for view in self.views]
        return [value for value in result if not isinstance(value, Unknown)]

    def letter(self, machine: MealyMonitor, view: StateView) -> tuple[int, ...]:
        """The letter that a machine reads of a state, digit by digit."""
        digits = []
        for read in machine.reads:
            if isinstance(read, NumberRead):
                number = weighted_sum(read.terms, self.bound, view)
                assert not isinstance(number, Unknown), "verify has read it"
                digits.append(read.digit(number))
            else:
                items = tuple([self.bound[variable] for variable in read.variables])
                value = view.value(read.name, items)
                assert not isinstance(value, Unknown), "verify has read it"
                digits.append(read.digit(value))
        return tuple(digits)

    def counted(self, term: ltl.Count) -> list[tuple[str, ...]]:
        """The objects that count in each state."""
        result = [objects_counted(term, self.bound, view) for view in self.views]
        return [objects for objects in result if not isinstance(objects, Unknown)]

    def changes(self, values: Sequence[object]) -> bool:
        """Tell whether the decisive state's value differs from the one before."""
        return self.decisive > 0 and values[self.decisive] != values[self.decisive - 1]


def _facts(
    truths: Mapping[ltl.Proposition, list[bool]],
    deciding: Set[ltl.Formula],
    observed: _ObservedStates,
) -> Iterator[Observation]:
    """Observations of all reads, in order of first mention."""
    readers: dict[ltl.Atom | ltl.Term, list[ltl.Proposition]] = {}
    for proposition in truths:
        for read in _read_by(proposition):
            readers.setdefault(read, []).append(proposition)
    for read, propositions in readers.items():
        # A number always changes a little; what counts is whether it passes a limit.
        passes = isinstance(read, ltl.Atom) or any(
            observed.changes(truths[proposition]) for proposition in propositions
        )
        decides = not deciding.isdisjoint(propositions)
        if isinstance(read, ltl.Count):
            objects = observed.counted(read)
            yield Observation(
                term_text(read),
                tuple(len(objects[n]) for n in observed.shown),
                passes and observed.changes([len(object_) for object_ in objects]),
                decides,
                objects=tuple(objects[n] for n in observed.shown),
            )
        else:
            values = observed.values(read.name, read.arguments)
            items = tuple(observed.bound[variable] for variable in read.arguments)
            declaration = observed.views[0].vocabulary.declarations[read.name]
            yield Observation(
                str(ltl.Atom(read.name, items)),
                tuple(values[n] for n in observed.shown),
                passes and observed.changes(values),
                decides,
                declaration.unit if isinstance(declaration, QuantityDeclaration) else "",
            )


def _read_by(proposition: ltl.Proposition) -> list[ltl.Atom | ltl.Term]:
    if isinstance(proposition, ltl.Comparison):
        return [term for _, term in proposition.terms]
    return [ltl.Atom(proposition.name, proposition.arguments)]


def _parts(
    written: ltl.Formula,
    stepped: ltl.Formula,
    truths: Mapping[ltl.Formula, list[bool]],
    deciding: Set[ltl.Formula],
    observed: _ObservedStates,
    depth: int,
) -> Iterator[Part]:
    """Subformulas as written, with the truth of those in steps."""
    values = truths[stepped]
    shown = tuple(values[n] for n in observed.shown)
    text, decides = formula_text(written), stepped in deciding
    yield Part(
        formula=written,
        text=text,
        depth=depth,
        values=shown,
        changed=observed.changes(values),
        decides=decides,
    )
    match written, stepped:
        case ltl.Unary(_, operand), ltl.Unary(_, same):
            yield from _parts(
                written=operand,
                stepped=same,
                truths=truths,
                deciding=deciding,
                observed=observed,
                depth=depth + 1,
            )
        case ltl.Binary(_, left, right), ltl.Binary(_, same_left, same_right):
            yield from _parts(
                written=left,
                stepped=same_left,
                truths=truths,
                deciding=deciding,
                observed=observed,
                depth=depth + 1,
            )
            yield from _parts(
                written=right,
                stepped=same_right,
                truths=truths,
                deciding=deciding,
                observed=observed,
                depth=depth + 1,
            )
        case _:
            return
