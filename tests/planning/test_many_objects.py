"""Ten and more objects that come and go, against a second reading of the same traces.

What the rules mean is written down again here, as plain loops over states and objects.
"""

from dataclasses import replace
from fractions import Fraction
from functools import cache
from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.automata.compiler import compile_rulebook
from rulec.logic.formula import (
    Binary,
    BinaryOperator,
    Comparison,
    Count,
    QuantityTerm,
    Same,
    Unary,
    UnaryOperator,
)
from rulec.monitoring.batch.verify import verify
from rulec.planning.product.graph_product import explore
from rulec.planning.product.node_transformers import node_transformers
from rulec.planning.product.possible_instances import instances
from rulec.rulebook.rulebook_model import Rulebook
from rulec.trace import Trace, TraceGraph
from rulec.vocabulary import Enumeration, ObjectType, Vocabulary
from rulec.vocabulary import Quantity as QuantityItem
from support.builders.rulebooks import always, both, eventually, far, implies, near, no, rule

VOCABULARY = Vocabulary(
    "road",
    {"thing": ObjectType("thing"), "car": ObjectType("car", "thing")},
    {
        "place": Enumeration("place", ("thing",), ("near", "far", "gone")),
        "gap": QuantityItem("gap", ("thing",), "m"),
        "speed": QuantityItem("speed", (), "m/s", 0.2),
    },
)


def number(relation, limit, *terms):
    terms = tuple((Fraction(factor), term) for factor, term in terms)
    return Comparison(terms, relation, Fraction(limit), text=f"sum {relation} {limit}")


def gap(variable):
    return QuantityTerm("gap", (variable,))


def until(left, right):
    return Binary(BinaryOperator.UNTIL, left, right)


def next_(formula):
    return Unary(UnaryOperator.NEXT, formula)


TIGHT = Fraction(3, 10)
COMPANY = Count("y", "car", both(near("y"), no(Same("y", "v"))))
SETTLED = Count("y", "thing", both(near("y"), number("<", TIGHT, (1, gap("y")))))
CROWD = Count(
    "x", "car", number(">=", 2, (1, Count("y", "thing", both(far("y"), no(Same("x", "y"))))))
)

MIXED = number("<=", TIGHT, (1, gap("v")), (-1, gap("w")), (2, QuantityTerm("speed")))

RULES = (
    rule("apart", always(implies(near("v"), no(far("w")))), "v: car", "w: car"),
    rule("order", until(no(far("w")), near("v")), "v: car", "w: thing"),
    rule("margin", always(number(">=", TIGHT, (1, gap("v")))), "v: thing"),
    rule("sum", always(implies(near("v"), MIXED)), "v: car", "w: car"),
    rule("company", always(implies(number(">=", 2, (1, COMPANY)), next_(no(near("v"))))), "v: car"),
    rule("empty", eventually(number("=", 0, (1, SETTLED)))),
    rule("crowd", always(number("<", 3, (1, CROWD)))),
)


@cache
def compiled(semantics):
    rulebook = Rulebook("test", VOCABULARY, RULES, semantics=semantics)
    return compile_rulebook(rulebook)


class Reading:
    """A trace, read by somebody else."""

    def __init__(self, trace, *, finite):
        self.trace = trace
        self.finite = finite
        self.n = len(trace.states)

    def there(self, item, i):
        first, last = self.trace.present.get(item, (0, self.n - 1))
        return first <= i <= last

    def cars(self, i):
        return [x for x in self.things(i) if self.trace.objects[x] == "car"]

    def things(self, i):
        return [x for x in self.trace.objects if self.there(x, i)]

    def near(self, x, i):
        return self.trace.states[i]["place"][x] == "near"

    def far(self, x, i):
        return self.trace.states[i]["place"][x] == "far"

    def tenths(self, x, i):
        """A gap in tenths, which are whole numbers here."""
        return round(10 * self.trace.states[i]["gap"][x])

    def speed(self, i):
        return round(10 * self.trace.states[i].get("speed", 0.2))

    def after(self, i, last):
        """The state after one in a stretch that ends with ``last``; None if there is none."""
        if i < last:
            return i + 1
        return None if self.finite else last

    # Each judges states ``a`` to ``b``.

    def apart(self, a, b, v, w):
        return all(not (self.near(v, i) and self.far(w, i)) for i in range(a, b + 1))

    def order(self, a, b, v, w):
        for i in range(a, b + 1):
            if self.near(v, i):
                return True
            if self.far(w, i):
                return False
        return False

    def margin(self, a, b, v):
        return min(self.tenths(v, i) for i in range(a, b + 1)) >= 3

    def sum(self, a, b, v, w):
        return all(
            not self.near(v, i) or self.tenths(v, i) - self.tenths(w, i) + 2 * self.speed(i) <= 3
            for i in range(a, b + 1)
        )

    def company(self, a, b, v):
        for i in range(a, b + 1):
            if len([y for y in self.cars(i) if y != v and self.near(y, i)]) >= 2:
                onward = self.after(i, b)
                if onward is None or self.near(v, onward):
                    return False
        return True

    def empty(self, a, b):
        return any(
            not [y for y in self.things(i) if self.near(y, i) and self.tenths(y, i) < 3]
            for i in range(a, b + 1)
        )

    def crowd(self, a, b):
        for i in range(a, b + 1):
            far = [y for y in self.things(i) if self.far(y, i)]
            if sum(len([y for y in far if y != x]) >= 2 for x in self.cars(i)) >= 3:
                return False
        return True

    def violated(self):
        """Rule and objects of every violation."""
        found = []
        for one in RULES:
            types = [variable.type for variable in one.variables]
            for chosen in product(self.trace.objects, repeat=len(types)):
                fits = all(
                    t in ("thing", self.trace.objects[x])
                    for t, x in zip(types, chosen, strict=True)
                )
                together = [i for i in range(self.n) if all(self.there(x, i) for x in chosen)]
                if not fits or len(set(chosen)) < len(chosen) or not together:
                    continue
                if not getattr(self, one.name)(together[0], together[-1], *chosen):
                    found.append((one.name, chosen))
        return sorted(found)


@st.composite
def traces(draw, least=10):
    kinds = draw(st.lists(st.sampled_from(["car", "car", "thing"]), min_size=least, max_size=13))
    objects = {f"o{number}": kind for number, kind in enumerate(kinds)}
    n = draw(st.integers(1, 6))
    present = {}
    for name in objects:
        if draw(st.booleans()):
            first = draw(st.integers(0, n - 1))
            present[name] = (first, draw(st.integers(first, n - 1)))
    states = []
    # Few are near or far at a time, so that rules are kept, too.
    places = st.sampled_from(["gone"] * draw(st.integers(0, 8)) + ["near", "far"])
    gaps = st.sampled_from([0.1, 0.2, 0.3, 0.3, 0.4, 0.5, 1])
    for number_of_state in range(n):
        there = [
            name
            for name in objects
            if present.get(name, (0, n))[0] <= number_of_state <= present.get(name, (0, n))[1]
        ]
        state = {
            "place": {name: draw(places) for name in there},
            "gap": {name: draw(gaps) for name in there},
        }
        if draw(st.booleans()):
            state["speed"] = draw(st.sampled_from([0.0, 0.1, 0.3, -0.1]))
        states.append(state)
    return Trace("t", 1.0, objects, tuple(states), present)


@pytest.mark.parametrize("semantics", ["stutter", "finite"])
@given(trace=traces())
def test_verdicts_are_those_of_the_second_reading(semantics, trace):
    found = verify(trace, compiled(semantics)).violations
    expected = Reading(trace, finite=semantics == "finite").violated()
    assert sorted((one.rule, tuple(one.binding.values())) for one in found) == expected


@pytest.mark.parametrize("name", [one.name for one in RULES])
def test_every_rule_is_kept_by_some_trace_and_violated_by_another(name):
    """The second reading itself can come out either way."""
    calm = {"place": {"a": "gone", "b": "near"}, "gap": {"a": 0.3, "b": 0.5}, "speed": 0.0}
    wild = {
        "place": {"a": "near", "b": "far", "c": "far", "d": "far", "e": "near", "f": "near"},
        "gap": {"a": 0.2, "b": -0.5, "c": 0.1, "d": 0, "e": 0.1, "f": 0.1},
    }
    objects = {"a": "car", "b": "car"}
    verdicts = []
    for state, there in ((calm, objects), (wild, dict.fromkeys("abcdef", "car"))):
        trace = Trace("t", 1.0, there, (state, state))
        violated = {one.rule for one in verify(trace, compiled("stutter")).violations}
        assert violated == {one for one, _ in Reading(trace, finite=False).violated()}
        verdicts.append(name in violated)
    assert verdicts == ([True, True] if name == "order" else [False, True])


def test_the_last_moment_of_a_stretch_has_no_next_one_under_finite():
    """Under stutter `company` can be kept in the last state, under finite it cannot."""
    state = {"place": {"a": "far", "b": "near", "c": "near"}, "gap": dict.fromkeys("abc", 1)}
    trace = Trace("t", 1.0, dict.fromkeys("abc", "car"), (state,))
    for semantics, expected in (("stutter", []), ("finite", [{"v": "a"}])):
        found = verify(trace, compiled(semantics)).violations
        assert [one.binding for one in found if one.rule == "company"] == expected


@pytest.mark.parametrize("semantics", ["stutter", "finite"])
@given(trace=traces(least=3))
def test_a_graph_of_one_path_counts_objects_as_its_trace_does(semantics, trace):
    onward = (((0,),),) * (len(trace.states) - 1)
    graph = TraceGraph(
        1.0,
        trace.objects,
        trace.present,
        tuple((state,) for state in trace.states),
        successors=onward,
        weights=onward,
        margins=onward,
        cost_unit=Fraction(1),
        start=0,
        goals=(0,),
    )
    rules = compiled(semantics)
    for one in rules.rules:
        alone = replace(rules, rules=(one,))
        kept = not verify(trace, alone).violations
        assert explore(node_transformers(graph, instances(graph, alone))).accepted == kept
