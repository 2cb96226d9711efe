"""Which facts hold of a rule's variables, and what is known with them."""

from itertools import product

from rulec.automata.alphabet import propositions_of
from rulec.automata.axiom_groups import axiom_groups
from rulec.logic.formula import Atom, atoms_of
from rulec.logic.semantics import holds
from rulec.rulebook.loader import parse_rulebook
from rulec.rulebook.rulebook_model import Variable
from rulec.rulebook.rules.axiom_instances import axiom_instances, linked

TOWN = """
rulebook town
type thing
type car is thing
type bus is car
signal follows(v: car, w: car), big(t: thing), fog, ice, p
place(t: thing) is one of near, far, gone
quantity speed in km/h
quantity gap(c: car) in m
option tight = on
"""


def town(*lines):
    return parse_rulebook("\n".join([TOWN, *lines]))


def said(book, *variables):
    typed = [Variable(*one.split(": ")) for one in variables]
    return [
        (one.variables, str(one.formula))
        for one in axiom_instances(typed, book.axioms, book.vocabulary)
    ]


def follows(one, other):
    return Atom("follows", (one, other))


def test_a_fact_is_said_of_distinct_variables_in_every_order():
    book = town("fact not (follows(v, w) and follows(w, v))")
    typed = [Variable("a", "car"), Variable("b", "bus")]
    found = axiom_instances(typed, book.axioms, book.vocabulary)
    assert [one.variables for one in found] == [("a", "b"), ("b", "a")]
    for one in found:
        assert set(propositions_of(one.formula)) == {follows("a", "b"), follows("b", "a")}
        assert not holds(one.formula, [{follows("a", "b"), follows("b", "a")}])
        assert holds(one.formula, [{follows("a", "b")}])
    assert axiom_instances(typed[:1], book.axioms, book.vocabulary) == ()


def test_variables_may_swap_their_names():
    """Renamed one after the other, both would become the same."""
    book = town("fact follows(v, w) implies not follows(w, v)")
    typed = [Variable("w", "car"), Variable("v", "car")]
    swapped = next(
        one
        for one in axiom_instances(typed, book.axioms, book.vocabulary)
        if one.variables == ("w", "v")
    )
    assert propositions_of(swapped.formula) == (follows("w", "v"), follows("v", "w"))


def test_only_what_is_certainly_of_the_type_counts():
    book = town("fact big(t) or ice", "fact not gap(c) > 5 m or fog")
    assert [names for names, _ in said(book, "x: bus")] == [("x",), ("x",)]
    assert [names for names, _ in said(book, "x: thing")] == [("x",)]


def test_a_fact_about_the_world_is_said_once_and_one_that_counts_never():
    book = town("fact not (fog and ice)", "fact some c: car (big(c)) implies fog")
    assert [names for names, _ in said(book)] == [()]
    assert [names for names, _ in said(book, "a: car", "b: car")] == [()]


def test_differences_of_numbers_stay_in_their_one_form():
    """Under other names the terms come in another order, and the relation turns around."""
    book = town(
        "fact gap(v) - gap(w) <= 5 m",
        "hard rule r (a: car, b: car) { require always (gap(a) - gap(b) >= -5 m) }",
    )
    turned = axiom_instances(book.rules[0].variables, book.axioms, book.vocabulary)[1]
    assert turned.variables == ("b", "a")
    assert propositions_of(turned.formula) == propositions_of(book.rules[0].formula)
    assert str(turned.formula) == "gap(b) - gap(a) <= 5 m"


def test_options_decide_what_is_a_fact():
    book = town("fact fog implies not tight")
    (one,) = axiom_instances((), book.axioms, book.vocabulary)
    assert not holds(one.formula, [{Atom("fog")}])
    assert holds(one.formula, [set()])


def test_facts_are_linked_by_what_they_speak_of():
    book = town(
        "fact not (fog and ice)",
        "fact near(t) implies big(t)",
        "fact far(t) implies p",
        "fact speed <= 50 km/h or ice",
    )
    found = axiom_instances([Variable("x", "thing")], book.axioms, book.vocabulary)
    groups = [[one.fact.formula for one in group] for group in linked(found)]
    formulas = [one.formula for one in book.axioms]
    assert groups == [formulas[1:3], [formulas[0], formulas[3]]]


def test_facts_are_linked_by_way_of_others():
    """The last one has to do with the first alone, which the second one has joined already."""
    book = town("fact not (p and fog)", "fact not (fog and ice)", "fact speed <= 50 km/h or p")
    (group,) = linked(axiom_instances((), book.axioms, book.vocabulary))
    assert {one.fact for one in group} == set(book.axioms)


def test_what_is_known_of_values_that_facts_bring_in():
    """The fact speaks of `near`, the rule of `far`: both are values of one enumeration."""
    book = town("fact near(t) or far(t) or big(t)")
    x, typed = ("x",), [Variable("x", "thing")]
    far, near, big = Atom("place", x, "far"), Atom("place", x, "near"), Atom("big", x)
    instances = axiom_instances(typed, book.axioms, book.vocabulary)
    (group,) = axiom_groups([far, Atom("fog")], instances, book.vocabulary)
    for values in product([False, True], repeat=3):
        letter = {one for one, true in zip([far, near, big], values, strict=True) if true}
        possible = not {far, near} <= letter and bool(letter)
        assert holds(group.known, [letter]) == possible
    # Fog has nothing to do with it.
    assert Atom("fog") not in set(atoms_of(group.known))


def test_the_objects_of_a_fact_are_not_those_that_it_counts():
    book = town(
        "define close(c: car) = gap(c) < 5 m",
        "fact some c: car (follows(c, v)) implies big(v)",
        "fact close(c) implies big(c)",
    )
    assert [one.variables for one in book.axioms] == [
        (Variable("v", "car"),),
        (Variable("c", "car"),),
    ]


def test_an_object_of_a_fact_is_of_the_narrowest_type_that_is_needed():
    for line in ("big(t) implies gap(t) < 5 m", "gap(t) < 5 m implies big(t)"):
        (fact,) = town(f"fact {line}").axioms
        assert fact.variables == (Variable("t", "car"),)
