"""Explanations of violations: values of reads and subformulas by state."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.mealy_monitor import IMPOSSIBLE, MealyMonitor
from rulec.automata.thresholds import exact_step
from rulec.diagnostics import RulecError
from rulec.logic import formula as ltl
from rulec.logic.bounds import in_steps
from rulec.logic.causes import instants_among
from rulec.monitoring.bindings import Binding, binding_of
from rulec.monitoring.explain.explained_parts import (
    Deciding,
    Observation,
    Part,
    facts_of,
    parts_of,
    with_margins,
)
from rulec.monitoring.explain.margins import Margin, choosing_comparisons
from rulec.monitoring.explain.nearest_satisfying import Repair, nearest_satisfying
from rulec.monitoring.explain.observed_states import ObservedStates, ObservedWord
from rulec.monitoring.explain.turning_margins import turning
from rulec.monitoring.implied_values import with_derived_values
from rulec.monitoring.limits import LIMITS
from rulec.monitoring.state_validation import has_partial_values
from rulec.monitoring.state_view import StateView
from rulec.monitoring.told_names import untold_names, with_untold
from rulec.monitoring.uncertainty.known_words import KnownLetters
from rulec.monitoring.uncertainty.one_completion import completed, favourable, with_all_defaults
from rulec.monitoring.verdict import Violation
from rulec.trace import Trace, Value
from rulec.value_display import short_repr
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.partial_values import Interval
from rulec.witnesses.letter_functions import letter_of


@dataclass(frozen=True, slots=True)
class Explanation:
    """A violation, explained state by state.

    ``states`` are the numbers of the states shown. ``decisive`` is the state after which the rule
    could no longer be kept, or the last state. ``facts`` and ``parts`` have a value for each of
    ``states``; the first part is the whole formula, and each part comes before its operands.
    ``lasts`` are the first and last state of the stretch in which a condition that must hold
    always, or never, is broken, or in which a forbidden sequence takes place; for other rules both
    are the decisive state. ``repair`` has the values that would have kept the rule, by the numbers
    of their states in the trace; it is None if nothing would have helped, or if no repair was
    searched for. ``looked_at`` are the first and last state of the window that was evaluated in a
    very long trace, else None.
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
        """The comparisons of quantities that decide, each where it decides last."""
        return [margin for margin, _ in self.measured()]

    def measured(self) -> list[tuple[Margin, int]]:
        """The margins of the comparisons that decide, each with the state where it decides last.

        A comparison is left out if it only says when the rule applies, such as that ego drives at
        all. One that only selects what the rule requires, such as whether a sign gives a limit, is
        left out if others remain.
        """
        when = set() if self.rule.trigger is None else set(ltl.atoms_of(self.rule.trigger))
        decisive = [part for part in self.parts if part.decides and part.formula not in when]
        signals = {part.formula.name for part in decisive if isinstance(part.formula, ltl.Atom)}
        margins = [fact.measured for fact in self.facts if fact.text.partition("(")[0] in signals]
        choosing = choosing_comparisons(self.rule.formula)
        compared = [part for part in decisive if part.margins]
        asks = [part for part in compared if part.formula not in choosing] or compared
        asks = [part for part in self.parts if part.turns][:1] or asks
        margins += [part.measured for part in asks]
        # Of one margin in several states, the first
        return list({own[0]: own for own in reversed(margins) if own is not None}.values())[::-1]

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


def explain(
    violation: Violation,
    trace: Trace,
    rulebook: CompiledRulebook,
    decided_by: Mapping[str, Deciding] = MappingProxyType({}),
    *,
    repaired: bool = True,
) -> Explanation:
    """Explain a violation that ``verify`` reported for this trace and rulebook.

    Unknown values are shown as unknown. As every completion violates the rule, one is evaluated for
    all of them: the one that makes the rule most likely to be kept, so that the known values are
    seen to decide. ``decided_by`` maps a signal to the numbers by which it was decided, if any. A
    repair is searched for only if ``repaired``, and never if only a window of the trace is
    evaluated.
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
    reader = KnownLetters(with_derived_values(trace, rulebook.vocabulary), rulebook)
    stretch = range(binding.first, binding.last + 1)
    decisive = binding.last if violation.step is None else violation.step
    numbers = _looked_at(reader, rule, binding, decisive)
    place = bisect_left(numbers, decisive)
    states = tuple(sorted(set(shown_states(stretch, decisive)).intersection(numbers)))
    declared = with_untold(declared, untold)
    observed = ObservedStates(
        [reader.view(number) for number in numbers],
        binding.objects,
        numbers,
        shown=[bisect_left(numbers, number) for number in states],
        decisive=place,
        given=lambda index: StateView(given.states[numbers[index]], {}, declared),
    )
    whole = len(numbers) == len(stretch)
    repair = None
    if whole and repaired:
        repair = nearest_satisfying(rule.machine, observed.word(rule.machine))
    atoms = dict.fromkeys(ltl.atoms_of(rule.formula))
    truths = {atom: observed.truths(atom) for atom in atoms}
    word = ObservedWord(truths, len(numbers), rulebook.semantics)
    formula = in_steps(rule.formula, exact_step(trace.step_s))
    observations, parts, lasts = _evaluated(rule, formula, word, observed, decided_by)
    return Explanation(
        rule=rule,
        violation=violation,
        states=states,
        decisive=decisive,
        facts=observations,
        parts=parts,
        repair=repair
        and tuple([replace(change, place=binding.first + change.place) for change in repair]),
        vocabulary=rulebook.vocabulary,
        lasts=lasts,
        looked_at=None if whole else _window(numbers, place),
    )


def _evaluated(
    rule: CompiledRule,
    formula: ltl.Formula,
    word: ObservedWord,
    observed: ObservedStates,
    decided_by: Mapping[str, Deciding],
) -> tuple[tuple[Observation, ...], tuple[Part, ...], tuple[int, int]]:
    """The facts and the parts of a rule, and the first and last state in which it is broken.

    The ``formula`` is the rule's, with bounds in steps.
    """
    place, n_states, numbers = observed.decisive, word.n_states, observed.numbers
    known = word.parts(formula)
    values = {part: column[:n_states] for part, column in known.items()}
    first, last = broken_stretch(formula, values, word, observed)
    early = is_broken_before(first, formula, values) and _is_violated_before(rule.machine, observed)
    instants = instants_among(known, formula, n_states, word.semantics, first if early else 0)
    deciding = {part: _last_until(place, at) for part, at in instants.items() if True in at}
    when = set() if rule.trigger is None else set(ltl.atoms_of(rule.trigger))
    turned = turning(formula, word, instants, observed, when=when)
    decided_at = {
        part.name: numbers[index] for part, index in deciding.items() if isinstance(part, ltl.Atom)
    }
    states = [numbers[index] for index in observed.shown]
    facts = [
        with_margins(fact, decided_by, states, decided_at)
        for fact in facts_of(word.truths, deciding.keys(), observed)
    ]
    parts = parts_of((rule.formula, formula), values, deciding, observed, turned=turned)
    return tuple(facts), tuple(parts), (numbers[first], numbers[last])


def _is_violated_before(machine: MealyMonitor, observed: ObservedStates) -> bool:
    """Whether a machine takes the rule to be violated, or a state to be impossible, too early.

    That is, before the decisive state. It is not really so, but the values that replace unknown
    ones, or stand for the time before the first state, may say so. The verdict does not rest on
    that.
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
    """The last of the instants up to a place; the place itself if all are beyond it."""
    return next((instant for instant in range(place, -1, -1) if instants[instant]), place)


def _looked_at(
    reader: KnownLetters, rule: CompiledRule, binding: Binding, decisive: int
) -> Sequence[int]:
    """The numbers of the states that are evaluated."""

    def word(first: int, last: int) -> tuple[int, ...]:
        try:
            return reader.word(rule, binding.objects, first, last)
        except RulecError:
            # A completion of the unknown values may contradict axioms.
            return (0,)

    stretch = range(binding.first, binding.last + 1)
    return states_to_explain(rule.machine, stretch, decisive, word)


def _window(numbers: Sequence[int], place: int) -> tuple[int, int]:
    """The first and last of the consecutive numbers around a place."""
    first = place
    while first and numbers[first - 1] == numbers[first] - 1:
        first -= 1
    return numbers[first], numbers[-1]


def states_to_explain(
    machine: MealyMonitor,
    stretch: range,
    decisive: int,
    word: Callable[[int, int], Sequence[int]],
) -> Sequence[int]:
    """The numbers of the states that explain a violation with this decisive state, ascending.

    Of a long ``stretch`` these are a window around the decisive state, the first state, and the
    fewest states before the window that bring the machine into the same state as the whole stretch:
    where the machine returns to a state, what lies in between makes no difference. So these states
    alone violate the rule, with the same decisive state. ``word`` gives the letter classes from one
    state to another (inclusive).
    """
    window = range(
        max(stretch.start, decisive - LIMITS.states_explained),
        min(stretch.stop, decisive + LIMITS.states_explained + 1),
    )
    if len(stretch) <= 2 * LIMITS.states_explained or window.start == stretch.start:
        return stretch[: window.stop - stretch.start] if len(window) < len(stretch) else stretch
    first, *letters = word(stretch.start, window.start - 1)
    state = machine.successors[0][first]
    way, length_at = [stretch.start], {state: 1}
    for number, letter in enumerate(letters, stretch.start + 1):
        state = machine.successors[state][letter]
        if state in length_at:
            del way[length_at[state] :]
            length_at = {at: n for at, n in length_at.items() if n <= len(way)}
        else:
            way.append(number)
            length_at[state] = len(way)
    return [*way, *window]


def shown_states(stretch: range, decisive: int) -> tuple[int, ...]:
    """The numbers of the states of a stretch that an explanation shows."""
    if len(stretch) <= LIMITS.states_shown:
        return tuple(stretch)
    last = min(decisive + 1, stretch[-1])
    first = max(stretch[0], last - LIMITS.states_shown + 2)
    return tuple(sorted({stretch[0], *range(first, last + 1)}))


def broken_stretch(
    formula: ltl.Formula,
    values: Mapping[ltl.Formula, list[bool]],
    word: ObservedWord,
    observed: ObservedStates,
) -> tuple[int, int]:
    """The stretch around the decisive state in which an outermost always or never is broken.

    A forbidden sequence of phases, such as overtaking, lasts from the latest state in which it can
    have begun to the decisive one. The stretch ends where states have been left out.
    """
    decisive, numbers = observed.decisive, observed.numbers
    for part, wanted in _bodies(formula):
        if not wanted and _has_phases(part):
            # The last phase may only require that something continues
            for n_states in (decisive + 1, decisive + 2):
                done = word.up_to(decisive, n_states).parts(part)[part]
                begins = [n for n in range(decisive, -1, -1) if done[n]]
                if begins:
                    return begins[0], decisive
        column = values[part]
        broken = [n for n in range(decisive, -1, -1) if column[n] is not wanted]
        if broken:
            first = last = broken[0]
            while (
                first > 0
                and column[first - 1] is not wanted
                and numbers[first - 1] == numbers[first] - 1
            ):
                first -= 1
            while last + 1 < len(column) and column[last + 1] is not wanted:
                last += 1
            return first, max(last, decisive)
    return decisive, decisive


def is_broken_before(
    first: int, formula: ltl.Formula, values: Mapping[ltl.Formula, list[bool]]
) -> bool:
    """Whether the body of an outermost always or never is broken in a state before ``first``."""
    return any(
        wanted is not value for part, wanted in _bodies(formula) for value in values[part][:first]
    )


def _bodies(formula: ltl.Formula) -> Iterator[tuple[ltl.Formula, bool]]:
    """The conditions that must be true, or false, in all states, each with which of both."""
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


def _has_phases(formula: ltl.Formula) -> bool:
    match formula:
        case ltl.Unary(_, operand):
            return _has_phases(operand)
        case ltl.Binary(operator, left, right):
            phases = operator is ltl.BinaryOperator.THEN
            return phases or _has_phases(left) or _has_phases(right)
        case _:
            return False
