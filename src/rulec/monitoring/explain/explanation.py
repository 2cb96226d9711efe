"""Explanations of violations: values of reads and subformulas by state."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Protocol

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.mealy_monitor import IMPOSSIBLE, MealyMonitor
from rulec.automata.thresholds import exact_step
from rulec.diagnostics import RulecError
from rulec.logic import formula as ltl
from rulec.logic.bounds import in_steps
from rulec.logic.causes import instants_among
from rulec.logic.kleene import objects_counted
from rulec.logic.printing import formula_text, term_text
from rulec.logic.semantics import Semantics, extended_by_columns
from rulec.monitoring.bindings import Binding, binding_of
from rulec.monitoring.explain.broken_stretch import broken_stretch, is_broken_before
from rulec.monitoring.explain.explained_states import states_to_explain
from rulec.monitoring.explain.margins import Margin, choosing_comparisons
from rulec.monitoring.explain.nearest_satisfying import Repair, nearest_satisfying
from rulec.monitoring.explain.observed_states import ObservedStates, known_value
from rulec.monitoring.implied_values import with_derived_values
from rulec.monitoring.letter_reader import LetterReader
from rulec.monitoring.limits import LIMITS
from rulec.monitoring.state_validation import has_partial_values
from rulec.monitoring.state_view import StateView
from rulec.monitoring.uncertainty.one_completion import completed, favourable, with_all_defaults
from rulec.monitoring.uncertainty.untold_names import untold_names, with_untold
from rulec.monitoring.verdict import Violation
from rulec.monitoring.verify import letter_reader_of
from rulec.trace import Trace, Value
from rulec.value_display import short_repr
from rulec.vocabulary import Quantity, Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN_TYPES, Interval
from rulec.witnesses.letter_functions import letter_of


@dataclass(frozen=True, slots=True)
class Observation:
    """Read of a rule, such as ``position(v1)``, with its values by state.

    A value that is unknown is None, a number may be an interval. ``unit`` is a quantity's.
    ``objects`` are, for a count, those that counted in each state. ``margins`` are, for a signal
    that was decided by a number, by how much, as far as is known, ``measured`` is the one where the
    signal decides last.
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
    measured: Margin | None = None


@dataclass(frozen=True, slots=True)
class Part:
    """Subformula at a ``depth`` of nesting, with its truth by state.

    ``changed``: is its value in the decisive state another than in the one before? ``decides``: is
    it one of those that, at some instant, make the formula come out as it does? ``margins`` are a
    comparison's by state, ``measured`` is that of the last state up to the decisive one, shown or
    not, in which it decides.
    """

    formula: ltl.Formula
    text: str
    depth: int
    values: tuple[bool, ...]
    changed: bool
    decides: bool
    margins: tuple[Margin | None, ...] = ()
    measured: Margin | None = None


@dataclass(frozen=True, slots=True)
class Explanation:
    """A violation state by state.

    ``states`` are the numbers of the states that are shown, ``decisive`` is the one after which
    nothing could save the rule any more, or the last one. ``facts`` and ``parts`` have a value for
    each of ``states``; the first part is the formula itself, each stands before what it is made of.
    ``lasts`` are the first and the last state of the stretch in which what always, or never, has to
    be is broken, or in which what never must be takes its course; of other rules the decisive
    state. ``repair`` is what states would have had to say for the rule to be kept, their places
    being their numbers in the trace; None if nothing would have helped, or nobody has looked.
    ``looked_at`` are the first and the last state of the window that was looked at in a trace that
    is too long, else None.
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
    looked_at: tuple[int, int] | None = None

    def margins(self) -> list[Margin]:
        """By how much: the comparisons of quantities that decide, where they do so last.

        What only says when the rule asks for anything, such as that ego drives at all, is none, nor
        what chooses what it asks for, such as that a sign tells a limit, where others are left.
        """
        when = set() if self.rule.trigger is None else set(ltl.atoms_of(self.rule.trigger))
        decisive = [part for part in self.parts if part.decides and part.formula not in when]
        signals = {part.formula.name for part in decisive if isinstance(part.formula, ltl.Atom)}
        margins = [fact.measured for fact in self.facts if fact.text.partition("(")[0] in signals]
        choosing = choosing_comparisons(self.rule.formula)
        compared = [part for part in decisive if part.margins]
        asks = [part for part in compared if part.formula not in choosing] or compared
        margins += [part.measured for part in asks]
        return [margin for margin in dict.fromkeys(margins) if margin is not None]

    def __str__(self) -> str:
        """The rule, since when it cannot be kept, by how much, and what would have kept it."""
        rule, about = self.rule, self.violation.binding
        law = f" [{rule.cite}]" if rule.cite else ""
        bound = ", ".join(f"{name} = {item}" for name, item in about.items())
        bound = f" for {bound}" if bound else ""
        lines = [f"{rule.strength} rule {rule.name}{law}{bound}: violated in state {self.decisive}"]
        lines += [rule.says] if rule.says else []
        lines += map(str, self.margins())
        at = self.states.index(self.decisive)
        lines += [
            f"{fact.text}: {_in_a_word(fact.values[at], fact.unit)}"
            for fact in self.facts
            if fact.decides
        ]
        return "\n  ".join(lines)


def _in_a_word(value: Value | Interval | None, unit: str) -> str:
    if isinstance(value, Interval):
        text = f"{value.low:g} to {value.high:g}"
    else:
        text = "unknown" if value is None else str(value).lower()
    return f"{text} {unit}".rstrip()


class Deciding(Protocol):
    """The numbers by which a signal about objects was decided."""

    def margin(self, item: str, state: int) -> Margin | None:
        """The margin for an object in a state of the trace."""


def explain(
    violation: Violation,
    trace: Trace,
    rulebook: CompiledRulebook,
    decided_by: Mapping[str, Deciding] = MappingProxyType({}),
    *,
    repaired: bool = True,
) -> Explanation:
    """Explain a violation that ``verify`` reported for this trace and rulebook.

    What is unknown is shown as such; as every completion violates the rule, one stands for all:
    that by which the rule is most likely kept, so that known values are seen to decide.
    ``decided_by``: signal -> the numbers behind it, for those
    that were decided by any. A repair is looked for only if it is to be ``repaired``, and
    never in a trace of which a window is looked at.
    """
    declared = rulebook.vocabulary
    given = trace = with_derived_values(trace, declared)
    rule = next((rule for rule in rulebook.rules if rule.name == violation.rule), None)
    if rule is None:
        raise ValueError(f"{rulebook.name} has no rule `{violation.rule}`, which was violated")
    untold = untold_names(declared, trace.told)
    if untold or trace.ends == "cut" or any(map(has_partial_values, trace.states)):
        facts = [axiom.formula for axiom in rulebook.axioms]
        supposed = favourable(rule.formula, declared, facts)
        trace = completed(trace, declared, supposed)
        rulebook = replace(rulebook, vocabulary=with_all_defaults(declared, supposed, untold))
    binding = binding_of(violation.binding, trace.present, len(trace.states))
    reader = letter_reader_of(trace, rulebook)
    stretch = range(binding.first, binding.last + 1)
    decisive = binding.last if violation.step is None else violation.step
    numbers = _looked_at(reader, rule, binding, decisive)
    place = bisect_left(numbers, decisive)
    states = tuple(sorted(set(shown_states(stretch, decisive)).intersection(numbers)))
    declared = with_untold(declared, untold)
    observed = ObservedStates(
        [reader.view(number) for number in numbers],
        binding.objects,
        [bisect_left(numbers, number) for number in states],
        place,
        lambda index: StateView(given.states[numbers[index]], {}, declared),
    )
    whole = len(numbers) == len(stretch)
    repair = None
    if whole and repaired:
        repair = nearest_satisfying(rule.machine, observed.word(rule.machine))
    subject = Explained(violation, rule, rulebook.vocabulary, rulebook.semantics, trace.step_s)
    explanation = explanation_of(subject, observed, numbers, decided_by)
    return replace(
        explanation,
        repair=repair
        and tuple([replace(change, place=binding.first + change.place) for change in repair]),
        looked_at=None if whole else _window(numbers, place),
    )


@dataclass(frozen=True, slots=True)
class Explained:
    """What is explained: a violation of a rule, in a trace of such steps (s)."""

    violation: Violation
    rule: CompiledRule
    vocabulary: Vocabulary
    semantics: Semantics
    step_s: float


def explanation_of(
    subject: Explained,
    observed: ObservedStates,
    numbers: Sequence[int],
    decided_by: Mapping[str, Deciding],
) -> Explanation:
    """The explanation by observed states with these ``numbers``, without a repair."""
    rule, semantics = subject.rule, subject.semantics
    place, n_states = observed.decisive, len(numbers)
    truths = {atom: observed.truths(atom) for atom in dict.fromkeys(ltl.atoms_of(rule.formula))}
    formula = in_steps(rule.formula, exact_step(subject.step_s))
    known = extended_by_columns(formula, truths, n_states, semantics)
    values = {part: column[:n_states] for part, column in known.items()}
    first, last = broken_stretch(formula, values, truths, place, numbers)
    early = is_broken_before(first, formula, values) and _is_violated_before(rule.machine, observed)
    instants = instants_among(known, formula, n_states, semantics, first if early else 0)
    deciding = {part: _last_until(place, at) for part, at in instants.items() if True in at}
    states = tuple([numbers[index] for index in observed.shown])
    decided_at = {
        part.name: numbers[index] for part, index in deciding.items() if isinstance(part, ltl.Atom)
    }
    return Explanation(
        rule=rule,
        violation=subject.violation,
        states=states,
        decisive=numbers[place],
        facts=tuple(
            _with_margins(fact, decided_by, states, decided_at)
            for fact in _facts(truths, deciding.keys(), observed)
        ),
        parts=tuple(_parts((rule.formula, formula), values, deciding, observed)),
        repair=None,
        vocabulary=subject.vocabulary,
        lasts=(numbers[first], numbers[last]),
    )


def _is_violated_before(machine: MealyMonitor, observed: ObservedStates) -> bool:
    """Whether a machine takes the states to be violated, or impossible, before the decisive one.

    Surely they are not, but what stands for what is unknown, or was before the first state, may say
    so. That is not what the verdict rests on.
    """
    state = 0
    for digits in observed.word(machine, observed.decisive):
        own = machine.letters[letter_of(digits, machine.reads)]
        if own == IMPOSSIBLE:
            return True
        state = machine.successors[state][own]
        if state == machine.rejecting_sink:
            return True
    return False


def _last_until(place: int, instants: Sequence[bool]) -> int:
    """The last of the instants that is not beyond a place; if all of them are, that place."""
    return next((instant for instant in range(place, -1, -1) if instants[instant]), place)


def _looked_at(
    reader: LetterReader, rule: CompiledRule, binding: Binding, decisive: int
) -> Sequence[int]:
    """The numbers of the states that are looked at."""

    def word(first: int, last: int) -> tuple[int, ...]:
        try:
            return reader.word(rule, binding.objects, first, last)
        except RulecError:
            # One completion of what is unknown may contradict facts.
            return (0,)

    stretch = range(binding.first, binding.last + 1)
    return states_to_explain(rule.machine, stretch, decisive, word)


def _window(numbers: Sequence[int], place: int) -> tuple[int, int]:
    """The first and the last of the numbers around a place that follow one upon the other."""
    first = place
    while first and numbers[first - 1] == numbers[first] - 1:
        first -= 1
    return numbers[first], numbers[-1]


def _with_margins(
    fact: Observation,
    decided_by: Mapping[str, Deciding],
    states: Sequence[int],
    decided_at: Mapping[str, int],
) -> Observation:
    name, _, rest = fact.text.partition("(")
    if name not in decided_by:
        return fact
    numbers, item = decided_by[name], rest.removesuffix(")")
    margins = tuple([numbers.margin(item, state) for state in states])
    measured = numbers.margin(item, decided_at[name]) if name in decided_at else None
    return replace(fact, margins=margins, measured=measured)


def shown_states(stretch: range, decisive: int) -> tuple[int, ...]:
    """The numbers of the states of a stretch that an explanation shows."""
    if len(stretch) <= LIMITS.states_shown:
        return tuple(stretch)
    last = min(decisive + 1, stretch[-1])
    first = max(stretch[0], last - LIMITS.states_shown + 2)
    return tuple(sorted({stretch[0], *range(first, last + 1)}))


def _facts(
    truths: Mapping[ltl.Proposition, list[bool]],
    deciding: Set[ltl.Formula],
    observed: ObservedStates,
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


def _parts(
    formulas: tuple[ltl.Formula, ltl.Formula],
    truths: Mapping[ltl.Formula, list[bool]],
    deciding: Mapping[ltl.Formula, int],
    observed: ObservedStates,
    depth: int = 0,
) -> Iterator[Part]:
    written, stepped = formulas
    margins: tuple[Margin | None, ...] = ()
    measured = None
    if isinstance(written, ltl.Comparison):
        margins = observed.margins(written)
        if margins and stepped in deciding:
            measured = observed.margin(written, deciding[stepped])
    yield Part(
        formula=written,
        text=formula_text(written),
        depth=depth,
        values=tuple(truths[stepped][n] for n in observed.shown),
        changed=observed.changes(truths[stepped]),
        decides=stepped in deciding,
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
        yield from _parts(both, truths, deciding, observed, depth + 1)
