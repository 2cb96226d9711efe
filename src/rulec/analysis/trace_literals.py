"""Traces as examples write them, as far as rules read them."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from rulec.analysis.counterexample import declarations_read
from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.logic.formula import Atom
from rulec.logic.printing import number_in_words
from rulec.monitoring.state_view import value_in
from rulec.trace import State, Trace
from rulec.vocabulary import Enumeration, Quantity, Vocabulary
from rulec.witnesses.state_synthesis import subjects_of


def trace_literal(trace: Trace, rules: Sequence[CompiledRule], vocabulary: Vocabulary) -> str:
    """A trace as a literal: ``{ behind(v); beside(v) and fog }``.

    What is not said has its default.
    """
    names = frozenset(name for rule in rules for name in declarations_read(rule))
    states = "; ".join(_state(state, trace, names, vocabulary) for state in trace.states)
    return f"{{ {states} }}"


def _state(state: State, trace: Trace, names: frozenset[str], vocabulary: Vocabulary) -> str:
    literals = []
    for (name, items), declaration in subjects_of(vocabulary, trace.objects):
        value = value_in(state, name, items, declaration)
        if name not in names or value is None or value == declaration.default:
            continue
        if len(set(items)) < len(items):
            continue
        if isinstance(declaration, Enumeration):
            literals.append(str(Atom(name, items, str(value))))
        elif isinstance(declaration, Quantity):
            number = number_in_words(Fraction(str(value)))
            literals.append(f"{Atom(name, items)} = {number} {declaration.unit}")
        else:
            literals.append(f"{'' if value else 'not '}{Atom(name, items)}")
    return " and ".join(literals) or "true"
