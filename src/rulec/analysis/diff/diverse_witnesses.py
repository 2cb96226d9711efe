"""Find traces that one rule forbids and another allows, one per reason.

A trace says of most things that they are as usual; what it says otherwise is its reason. A further
trace shows another reason if it does without something that each of those before it needs, so it is
looked for among the traces in which that is always as usual. Which things to do without is chosen
as for hitting sets (Reiter 1987), few first, so that plain reasons come first.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from fractions import Fraction

from rulec.analysis.counterexample import counterexample
from rulec.analysis.shared_compilation import AnalyzedRule
from rulec.automata.thresholds import exact
from rulec.logic.formula import Atom, Comparison, Formula, QuantityTerm, Unary, UnaryOperator
from rulec.monitoring.state_view import value_in
from rulec.rulebook.rulebook_model import Axiom, Variable
from rulec.trace import Trace
from rulec.vocabulary import Declaration, Enumeration, Signal, Vocabulary
from rulec.witnesses.state_synthesis import subjects_of
from rulec.witnesses.undecided import UndecidedError

MOST_SEARCHES = 12
"""No more searches for another reason are made."""


def diverse_witnesses(
    forbidding: AnalyzedRule, allowing: AnalyzedRule, first: Trace, most: int
) -> tuple[Trace, ...]:
    """Traces that only the first rule forbids, each for another reason.

    Args:
        forbidding: the rule that forbids them.
        allowing: the rule that allows them.
        first: one of them, the first of the answer.
        most: how many to look for.
    """
    vocabulary = forbidding.rulebook.vocabulary
    traces = [first]
    shown = [non_default_names(first, vocabulary)]
    waiting = deque(frozenset([name]) for name in sorted(shown[0]))
    asked: set[frozenset[str]] = set()
    while waiting and len(traces) < most and len(asked) < MOST_SEARCHES:
        defaulted = waiting.popleft()
        if defaulted in asked:
            continue
        known = next((names for names in shown if not names & defaulted), None)
        if known is None:
            asked.add(defaulted)
            trace = _without(defaulted, forbidding, allowing)
            if trace is None:
                continue
            known = non_default_names(trace, vocabulary)
            traces.append(trace)
            shown.append(known)
        waiting.extend(defaulted | {name} for name in sorted(known))
    return tuple(traces)


def non_default_names(trace: Trace, vocabulary: Vocabulary) -> frozenset[str]:
    """The declarations whose value in some state differs from their default."""
    return frozenset(
        name
        for (name, items), declaration in subjects_of(vocabulary, trace.objects)
        if declaration.default is not None
        if any(
            value_in(state, name, items, declaration) != declaration.default
            for state in trace.states
        )
    )


def _without(
    names: frozenset[str], forbidding: AnalyzedRule, allowing: AnalyzedRule
) -> Trace | None:
    try:
        return counterexample(
            forbidding, [allowing], tuple(_as_usual(names, forbidding.rulebook.vocabulary))
        )
    except UndecidedError:
        return None


def _as_usual(names: frozenset[str], vocabulary: Vocabulary) -> Iterator[Axiom]:
    """That these declarations have their defaults, for all objects."""
    for name in sorted(names):
        declaration = vocabulary.declarations[name]
        variables = tuple(
            Variable(f"o{number}", kind) for number, kind in enumerate(declaration.parameters)
        )
        arguments = tuple(variable.name for variable in variables)
        yield Axiom(variables, _has_default(name, arguments, declaration))


def _has_default(name: str, arguments: tuple[str, ...], declaration: Declaration) -> Formula:
    match declaration:
        case Enumeration(default=str(value)):
            return Atom(name, arguments, value)
        case Signal(default=True):
            return Atom(name, arguments)
        case Signal():
            return Unary(UnaryOperator.NOT, Atom(name, arguments))
    assert declaration.default is not None, "only what has a default can be as usual"
    number = exact(float(declaration.default))
    return Comparison(((Fraction(1), QuantityTerm(name, arguments)),), "=", number)
