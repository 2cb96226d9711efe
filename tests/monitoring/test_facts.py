"""States that contradict facts: reported with the fact and its values, wherever they turn up."""

from dataclasses import replace

import pytest

from rulec.analysis.rule_traces import rule_traces
from rulec.analysis.shared_compilation import compile_shared
from rulec.automata.bundle.bundle_file import from_json, to_json
from rulec.automata.compiler import compile_rulebook
from rulec.book_tests.example_coverage import coverage
from rulec.book_tests.example_runs import run_rulebook_examples
from rulec.diagnostics import RulecError
from rulec.monitoring.batch.verify import verify
from rulec.planning.product.possible_instances import instances
from rulec.rulebook.loader import parse_rulebook
from rulec.trace import Trace, TraceGraph

QUEUE = parse_rulebook(
    """rulebook queue
type car
signal follows(v: car, w: car), loud(v: car) default false
signal horn
quantity speed(v: car) in km/h default 0
fact not (follows(v, w) and follows(w, v))
fact loud(v) implies horn
fact speed(v) <= 120 km/h
fact count c: car (loud(c)) <= 1
hard rule in_line (a: car, b: car) { require always (follows(a, b) implies next not follows(b, a)) }
hard rule calm (v: car) { require always (loud(v) implies speed(v) <= 100 km/h) }
hard rule fast (v: car) { require never (speed(v) > 50 km/h and speed(v) > 120 km/h) }
""",
    "queue.rules",
)
COMPILED = compile_rulebook(QUEUE)
CARS = {"v1": "car", "v2": "car"}


def problem(state, *before, objects=CARS, rulebook=COMPILED):
    with pytest.raises(RulecError) as caught:
        verify(Trace("t", 1, objects, (*before, state)), rulebook)
    (found,) = caught.value.diagnostics
    return found


def is_fine(state, objects=CARS):
    verify(Trace("t", 1, objects, (state,)), COMPILED)
    return True


BOTH = {"follows": {"v1": {"v2": True}, "v2": {"v1": True}}}
ONE = {"follows": {"v1": {"v2": True}}}


def test_a_state_is_named_with_the_fact_and_its_values():
    found = problem(BOTH, ONE, ONE)
    assert found.code == "R0508"
    assert found.message == (
        "state 2 cannot be: `not (follows(v1, v2) and follows(v2, v1))` holds in every state"
    )
    assert found.notes == (
        "here `follows(v1, v2)` is true, `follows(v2, v1)` is true",
        "rule `in_line` depends on it",
    )
    (label,) = found.labels
    assert (label.place.file, label.place.line) == ("queue.rules", 6)
    assert label.place.excerpt == "fact not (follows(v, w) and follows(w, v))"


def test_a_compiled_rulebook_says_where_the_fact_is_written():
    again = from_json(to_json(COMPILED).encode(), "queue.json")
    assert again == COMPILED
    found = problem(BOTH, rulebook=again)
    assert found.labels == ()
    assert "the fact is in queue.rules, line 6" in found.notes


def test_the_state_is_counted_from_the_beginning_of_the_trace():
    """The two are there together from state 1 on."""
    trace = Trace("t", 1, CARS, ({}, {}, BOTH), present={"v2": (1, 2)})
    with pytest.raises(RulecError, match="state 2 cannot be"):
        verify(trace, COMPILED)


def test_the_fact_that_is_named_is_one_that_the_rule_depends_on():
    """The object is a bus, but the rule is about cars."""
    book = parse_rulebook(
        "rulebook a type car type bus is car\n"
        "signal p(c: car), q(c: car), old(b: bus) default false\n"
        "fact old(b) or not p(b)\nfact p(c) implies not q(c)\n"
        "hard rule r (c: car) { require never (p(c) and q(c)) }"
    )
    state = {"p": {"v1": True}, "q": {"v1": True}}
    found = problem(state, objects={"v1": "bus"}, rulebook=compile_rulebook(book))
    assert found.message == "state 0 cannot be: `p(v1) implies not q(v1)` holds in every state"
    # What is only known of buses is not known of cars.
    trace = Trace("t", 1, {"v1": "bus"}, ({"p": {"v1": True}},))
    assert verify(trace, compile_rulebook(book)).satisfied


def test_numbers_beyond_what_can_be():
    found = problem({"speed": {"v2": 121}})
    assert found.message == "state 0 cannot be: `speed(v2) <= 120 km/h` holds in every state"
    assert found.notes[0] == "here `speed(v2)` is 121"
    assert is_fine({"speed": {"v2": 120}})


def test_what_a_rule_does_not_read_does_not_matter():
    """No rule reads `horn`, so it need not be given; nor does it matter that it contradicts."""
    assert is_fine({"loud": {"v1": True}})
    assert is_fine({"loud": {"v1": True}, "horn": False})


def test_facts_that_count_are_asked_of_the_objects_that_are_there():
    two = {"loud": {"v1": True, "v2": True}}
    found = problem(two)
    assert found.message == (
        "state 0 cannot be: `count c: car (loud(c)) <= 1` holds in every state"
    )
    assert found.notes == ("here `count c: car (loud(c))` is 2",)
    absent = Trace("t", 1, CARS, ({}, two), present={"v2": (0, 0)})
    verify(absent, COMPILED)


def test_facts_that_count_are_about_the_objects_of_each_moment():
    book = parse_rulebook(
        "rulebook a type car signal loud(c: car) default false\n"
        "fact loud(v) implies some c: car (c != v and loud(c))\n"
        "hard rule r (v: car) { require eventually loud(v) }"
    )
    compiled = compile_rulebook(book)
    two, one = {"loud": {"v1": True, "v2": True}}, {"loud": {"v1": True}}

    def states(*states, **present):
        return Trace("t", 1, CARS, states, present=present)

    # What is said of a car that is not there does not matter.
    assert verify(states(two, {"loud": {"v2": True}}, v2=(0, 0)), compiled).satisfied
    for wrong in (states({}, one), states({}, two, v2=(0, 0)), states({}, one, v1=(1, 1))):
        with pytest.raises(RulecError, match="state 1 cannot be: `loud\\(v1\\) implies some"):
            verify(wrong, compiled)


def test_facts_that_count_what_no_rule_reads_are_not_asked():
    book = parse_rulebook(
        "rulebook a type car signal loud(c: car), p default false\n"
        "fact count c: car (loud(c)) <= 1 hard rule r { require p }"
    )
    trace = Trace("t", 1, CARS, ({"p": True, "loud": {"v1": True, "v2": True}},))
    assert verify(trace, compile_rulebook(book)).violations == ()


def test_facts_that_exclude_a_state_only_together():
    book = parse_rulebook(
        "rulebook a signal p, q default false signal r\nfact r or not p\nfact q implies not r\n"
        "hard rule s { require always (p or q) accept { p and q } }"
    )
    found = problem({"p": True, "q": True}, objects={}, rulebook=compile_rulebook(book))
    assert found.message == (
        "state 0 cannot be: `r or not p` and `q implies not r` hold in every state"
    )
    # Given `r`, it is clear which of them it is.
    found = problem({"p": True, "q": True, "r": True}, objects={}, rulebook=compile_rulebook(book))
    assert found.message == "state 0 cannot be: `q implies not r` holds in every state"
    with pytest.raises(RulecError) as caught:
        run_rulebook_examples(book, compile_rulebook(book))
    (found,) = caught.value.diagnostics
    assert found.code == "R0306"
    assert found.message.startswith("this state cannot be: ")
    assert found.place.excerpt[found.place.column - 1 : found.place.end_column - 1] == "p and q"


def test_a_cell_of_a_graph_that_cannot_be():
    graph = TraceGraph(1, CARS, {}, ((ONE,), (ONE, BOTH)), (((0, 1),),), (((0, 0),),),
                       (((None, None),),), 1, 0, (0, 1))  # fmt: skip
    with pytest.raises(RulecError) as caught:
        instances(graph, COMPILED)
    (found,) = caught.value.diagnostics
    assert found.code == "R0508"
    assert found.message.startswith("a cell of layer 1 cannot be: ")


def test_facts_that_contradict_each_other_leave_no_state():
    with pytest.raises(RulecError) as caught:
        compile_rulebook(
            parse_rulebook(
                "rulebook a type car signal p(c: car), q(c: car), s default false\n"
                "fact p(c) or s\nfact q(c) and not q(d)\nhard rule r (a: car) { require p(a) }\n"
                "hard rule t (a: car, b: car) { require always p(a) or p(b) }\n"
                "hard rule u (a: car, b: car) { require s and never p(a) or p(b) }"
            )
        )
    (found,) = [one for one in caught.value.diagnostics if one.severity == "error"]
    assert found.code == "R0409"
    assert found.message == "`q(c) and not q(d)` can never be a fact"
    assert found.place.line == 3
    assert found.notes == ("there would be no state with 2 objects of type `car`",)


def test_what_a_check_leaves_open_the_compiler_finds():
    """It has no limit but time; here nothing has checked the facts together."""
    words = "rulebook a type car signal p(c: car), q(c: car) default false\n"
    rule = "hard rule r (a: car) { require always p(a) }"
    first, second = (
        parse_rulebook(f"{words}fact {fact}\n{rule}")
        for fact in ("p(c) and q(c)", "not (p(c) and q(c))")
    )
    with pytest.raises(RulecError) as caught:
        compile_rulebook(replace(first, axioms=first.axioms + second.axioms))
    (found,) = caught.value.diagnostics
    assert found.code == "R0409"
    assert found.message == (
        "these facts contradict each other: `p(c) and q(c)`, `not (p(c) and q(c))`"
    )
    assert found.notes == ("there would be no state with a `car`",)


def test_suggested_examples_and_shortest_traces_keep_to_the_facts():
    """Without facts, the shortest rejected trace of `calm` would be loud at 101 km/h or more."""
    _, calm, never = compile_shared([QUEUE], [{rule.name: rule for rule in QUEUE.rules}])[
        0
    ].values()
    (state,) = rule_traces(calm).rejected.states
    assert state["speed"]["v"] <= 120
    assert rule_traces(never).rejected is None
    book = parse_rulebook(
        "rulebook a signal p, q default false fact not (p and q)\n"
        "hard rule r { require always (p iff not q) accept { p; q } reject { not p } }"
    )
    compiled = compile_rulebook(book)
    assert compiled.rules[0].machine.letters == (0, 1, 1, -1)
    (found,) = coverage(run_rulebook_examples(book, compiled))
    assert found.missing_edges == ()


def test_what_facts_rule_out_is_not_missing_from_examples():
    book = parse_rulebook(
        "rulebook a signal p, q default false fact not p quantity speed in m/s default 0\n"
        "fact speed <= 3 m/s\n"
        "hard rule r { require always (p or q or speed > 3 m/s) accept { q } reject { not q } }"
    )
    (found,) = coverage(run_rulebook_examples(book, compile_rulebook(book)))
    assert found.missing_values == ()
    assert found.missing_edges == ()


def test_what_is_only_counted_shows_no_contradiction():
    """Only a fact that counts is about objects that a rule merely counts."""
    book = (
        "rulebook a type car signal leads(v: car) default false fact {}\n"
        "hard rule r {{ require always (count c: car (leads(c)) < 3) }}"
    )
    two = {"leads": {"v1": True, "v2": True}}
    pairs = compile_rulebook(parse_rulebook(book.format("not (leads(v) and leads(w))")))
    assert verify(Trace("t", 1, CARS, (two,)), pairs).satisfied
    counting = compile_rulebook(parse_rulebook(book.format("count c: car (leads(c)) < 2")))
    assert problem(two, rulebook=counting).code == "R0508"


def test_numbers_are_not_suggested_against_a_fact():
    """59 km/h would do for the rule, but without lights no car is that fast; 0 km/h does."""
    book = parse_rulebook(
        "rulebook a signal lights, near default false quantity speed in km/h default 0\n"
        "fact lights or speed < 50 km/h\n"
        "hard rule r { require always (near implies speed < 60 km/h and not lights) }"
    )
    (found,) = coverage(run_rulebook_examples(book, compile_rulebook(book)))
    suggested = [edge.states[-1] for edge in found.missing_edges if edge.accepted]
    assert [dict(state.says) for state in suggested] == [
        {("near", ()): False, ("lights", ()): False}
    ]
    assert suggested[0].besides == ()
