"""Why a rule is violated: what it read in each state, and how its formula came out in parts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from rulec.automata.compiled import CompiledRule, CompiledRulebook
from rulec.logic.formula import Atom, Binary, Formula, Unary, atoms_of
from rulec.logic.printing import in_words
from rulec.logic.semantics import values_of_parts
from rulec.runtime.binding import Binding, bindings
from rulec.runtime.letters import value_in
from rulec.runtime.verdict import Violation
from rulec.trace import Trace, Value
from rulec.vocabulary import Vocabulary

MOST_STATES = 10
"""A longer stretch is shown by its first state and those up to the one behind the decisive one."""


@dataclass(frozen=True, slots=True)
class Fact:
    """Something that the rule reads, such as ``position(v1)``, and its value in each state."""

    text: str
    values: tuple[Value, ...]


@dataclass(frozen=True, slots=True)
class Part:
    """A part of the formula, ``depth`` operators inside it, and whether it holds in each state."""

    text: str
    depth: int
    values: tuple[bool, ...]


@dataclass(frozen=True, slots=True)
class Explanation:
    """A violation state by state.

    ``states`` are the numbers of the states that are shown, ``decisive`` is the one after which
    nothing could save the rule any more, or the last one. ``facts`` and ``parts`` have a value for
    each of ``states``; the first part is the formula itself, each stands before what it is made of.
    """

    rule: CompiledRule
    violation: Violation
    states: tuple[int, ...]
    decisive: int
    facts: tuple[Fact, ...]
    parts: tuple[Part, ...]


def explain(violation: Violation, trace: Trace, rulebook: CompiledRulebook) -> Explanation:
    """Explain one of the violations that ``verify`` found in this trace by this rulebook."""
    rule = next(rule for rule in rulebook.rules if rule.name == violation.rule)
    binding = _binding(violation, rule, trace, rulebook.vocabulary)
    stretch = range(binding.first, binding.last + 1)
    decisive = binding.last if violation.step is None else violation.step
    states = _shown(stretch, decisive)
    values = {
        atom: [_value(atom, binding, trace, number, rulebook.vocabulary) for number in stretch]
        for atom in dict.fromkeys(atoms_of(rule.formula))
    }
    word = [
        frozenset(atom for atom, column in values.items() if column[n] == (atom.value or True))
        for n in range(len(stretch))
    ]
    columns = [number - binding.first for number in states]
    return Explanation(
        rule,
        violation,
        states,
        decisive,
        tuple(_facts(values, binding, columns)),
        tuple(_parts(rule.formula, values_of_parts(rule.formula, word), columns, 0)),
    )


def _binding(
    violation: Violation, rule: CompiledRule, trace: Trace, vocabulary: Vocabulary
) -> Binding:
    everyone = bindings(rule, vocabulary, trace.objects, trace.present, len(trace.states))
    return next(found for found in everyone if found.objects == violation.binding)


def _shown(stretch: range, decisive: int) -> tuple[int, ...]:
    if len(stretch) <= MOST_STATES:
        return tuple(stretch)
    last = min(decisive + 1, stretch[-1])
    first = max(stretch[0], last - MOST_STATES + 2)
    return tuple(sorted({stretch[0], *range(first, last + 1)}))


def _value(
    atom: Atom, binding: Binding, trace: Trace, number: int, vocabulary: Vocabulary
) -> Value:
    items = [binding.objects[variable] for variable in atom.arguments]
    declaration = vocabulary.declarations[atom.name]
    value = value_in(trace.states[number], atom.name, items, declaration)
    assert value is not None, "verify has read this value"
    return value


def _facts(
    values: dict[Atom, list[Value]], binding: Binding, columns: Sequence[int]
) -> Iterator[Fact]:
    seen = set()
    for atom, column in values.items():
        items = tuple(binding.objects[variable] for variable in atom.arguments)
        fact = str(Atom(atom.name, items))
        if fact not in seen:
            seen.add(fact)
            yield Fact(fact, tuple(column[n] for n in columns))


def _parts(
    formula: Formula, holds: Mapping[Formula, list[bool]], columns: Sequence[int], depth: int
) -> Iterator[Part]:
    yield Part(in_words(formula), depth, tuple(holds[formula][n] for n in columns))
    match formula:
        case Unary(_, operand):
            yield from _parts(operand, holds, columns, depth + 1)
        case Binary(_, left, right):
            yield from _parts(left, holds, columns, depth + 1)
            yield from _parts(right, holds, columns, depth + 1)
        case _:
            return
