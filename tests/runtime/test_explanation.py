"""Explanations: the right states, and values that are those of direct evaluation."""

from books import Q, always, book, compile_here, eventually, far, implies, near, no, rule
from hypothesis import assume, given
from words import formulas, letters, words

from rulec.logic.formula import Binary, Unary, atoms_of
from rulec.logic.semantics import truth_values
from rulec.runtime.explanation import MOST_STATES, explain
from rulec.runtime.verify import verify
from rulec.trace import Trace

CARS = {"car1": "car", "car2": "car"}


def parts_of(formula):
    yield formula
    match formula:
        case Unary(_, operand):
            yield from parts_of(operand)
        case Binary(_, left, right):
            yield from parts_of(left)
            yield from parts_of(right)


def trace_of(word):
    return Trace("t", 1.0, {"car1": "car"}, tuple(word))


@given(formulas, words)
def test_the_formulas_values_are_those_of_direct_evaluation(formula, word):
    x = ("x: car",) if any(atom.arguments for atom in atoms_of(formula)) else ()
    rules = compile_here(book(rule("A", formula, *x)))
    trace = trace_of(word)
    violations = verify(trace, rules).violations
    assume(violations)
    explained = explain(violations[0], trace, rules)
    assert explained.states == tuple(range(len(word)))
    assert list(explained.parts[0].values) == truth_values(formula, letters(word))
    assert not explained.parts[0].values[0]
    expected = [truth_values(part, letters(word)) for part in parts_of(formula)]
    assert [list(part.values) for part in explained.parts] == expected
    assert {fact.text for fact in explained.facts} == {
        f"{atom.name}(car1)" if atom.arguments else atom.name for atom in atoms_of(formula)
    }


def place(text):
    return {"place": {"car1": {"n": "near", "f": "far"}[text]}, "q": False}


def test_a_long_trace_is_shown_around_the_decisive_state():
    rules = compile_here(book(rule("A", always(no(near("x"))), "x: car")))
    trace = trace_of([place("f")] * 40 + [place("n")] + [place("f")] * 40)
    (violation,) = verify(trace, rules).violations
    explained = explain(violation, trace, rules)
    assert violation.step == explained.decisive == 40
    assert explained.states == (0, *range(33, 42))
    assert len(explained.states) == MOST_STATES
    assert explained.facts[0].values == ("far",) * 8 + ("near", "far")


def test_without_a_step_the_end_decides():
    rules = compile_here(book(rule("A", eventually(Q))))
    trace = trace_of([place("f")] * 3)
    (violation,) = verify(trace, rules).violations
    assert violation.step is None
    assert explain(violation, trace, rules).decisive == 2


def test_the_bound_objects_and_their_stretch():
    rules = compile_here(
        book(rule("A", always(implies(near("x"), no(far("y")))), "x: car", "y: car"))
    )
    states = [{"place": {"car1": "near", "car2": "far"}, "q": False}] * 4
    trace = Trace("t", 1.0, CARS, tuple(states), {"car2": (1, 2)})
    (violation,) = verify(trace, rules).violations
    explained = explain(violation, trace, rules)
    assert explained.states == (1, 2)
    assert [fact.text for fact in explained.facts] == ["place(car1)", "place(car2)"]
