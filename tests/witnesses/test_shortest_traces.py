"""Shortest traces: they get the verdicts that they are shown for, and none is shorter."""

from fractions import Fraction
from itertools import product

from hypothesis import given
from hypothesis import strategies as st

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.automata.mealy_monitor import MealyMonitor, NumberRead, Read, Threshold
from rulec.book_tests.example_runs import run_rulebook_examples
from rulec.logic.formula import Atom, Count, QuantityTerm
from rulec.logic.semantics import holds
from rulec.monitoring.uncertainty.known_words import run
from rulec.rulebook.loader import parse_rulebook
from rulec.rulebook.rulebook_model import Example, Rulebook, Variable
from rulec.vocabulary import Enumeration, ObjectType, Vocabulary
from rulec.vocabulary import Quantity as DeclaredQuantity
from rulec.witnesses.shortest_traces import shortest_traces
from support.builders.measured_vocabulary import MEASURED, gap, number
from support.builders.rulebooks import P, Q, always, book, compile_here, eventually, no, rule
from support.generators.random_formulas import VOCABULARY, formulas


def letters(trace):
    """The atoms that hold in each state."""
    return [
        frozenset(
            Atom(name, variables, value if isinstance(value, str) else None)
            for (name, variables), value in state.items()
            if value is not False
        )
        for state in trace.states
    ]


def test_numbers_are_not_below_zero_where_others_do():
    rulebook = Rulebook(
        "test", MEASURED, (rule("r", always(number("", "=", 0, (1, gap("v")))), "v: car"),)
    )
    found = shortest_traces(compile_here(rulebook).rules[0], MEASURED)
    assert found.rejected.states == ({("gap", ("v",)): 1.0},)


@given(formulas)
def test_their_verdicts_and_their_length(formula):
    one = rule("r", formula, "x: car")
    rulebook = book(one)
    compiled = compile_here(rulebook)
    machine = compiled.rules[0].machine
    traces = shortest_traces(compiled.rules[0], VOCABULARY)
    for trace, accepts in ((traces.accepted, True), (traces.rejected, False)):
        if trace is None:
            assert machine.accepting_sink == 0 if not accepts else machine.rejecting_sink == 0
            continue
        assert holds(formula, letters(trace)) is accepts
        example = Example(accepts, trace.states)
        shown = book(rule_with(one, example))
        assert run_rulebook_examples(shown, compiled).outcomes[0].passed
    if traces.rejected is not None:
        symbols = range(len(machine.successors[0]))
        for length in range(1, min(len(traces.rejected.states), 5)):
            for word in product(symbols, repeat=length):
                assert run(machine, word)[0]


def rule_with(one, example):
    return type(one)(one.name, one.strength, one.variables, one.formula, examples=(example,))


@given(formulas)
def test_the_accepted_one_differs_in_one_state_where_that_is_possible(formula):
    compiled = compile_here(book(rule("r", formula, "x: car"))).rules[0]
    traces = shortest_traces(compiled, VOCABULARY)
    if traces.accepted is None or traces.rejected is None:
        return
    accepted, rejected = traces.accepted.states, traces.rejected.states
    pairs = list(zip(accepted, rejected, strict=False))
    near = len(accepted) == len(rejected) and sum(a != b for a, b in pairs) == 1
    if not near:
        machine = compiled.machine
        word = [machine.letters[_letter(machine, state)] for state in rejected]
        for place in range(len(word)):
            for symbol in range(len(machine.successors[0])):
                assert not run(machine, [*word[:place], symbol, *word[place + 1 :]])[0]


def _letter(machine, facts):
    letter, stride = 0, 1
    for read in machine.reads:
        letter += stride * read.digit(facts[read.name, read.variables])
        stride *= read.size
    return letter


def test_the_nearest_miss_is_shown():
    compiled = compile_here(book(rule("r", always(no(P))))).rules[0]
    traces = shortest_traces(compiled, VOCABULARY)
    assert letters(traces.rejected) == [{P}]
    assert letters(traces.accepted) == [set()]


TRAM = parse_rulebook("""rulebook sample
signal tram, moves, stands default false
constant tram
hard rule turned { require never (moves and not tram and previously (stands and tram)) }
hard rule moved { require never (tram and not stands and previously stands) }
""")


def test_what_cannot_change_does_not_change():
    """The plainest state that is forbidden would do, after one that its class is plainest for."""
    turned, moved = compile_here(TRAM).rules
    # Nothing but a tram that becomes none would be forbidden: there is no such drive.
    assert shortest_traces(turned, TRAM.vocabulary).rejected is None
    traces = shortest_traces(moved, TRAM.vocabulary)
    for trace in (traces.rejected, traces.accepted):
        assert [state["tram", ()] for state in trace.states] == [True, True]


def test_no_trace_is_rejected_or_accepted():
    for formula, none in ((eventually(Q), None), (no(eventually(Q)), None)):
        traces = shortest_traces(compile_here(book(rule("r", formula))).rules[0], VOCABULARY)
        assert traces.accepted is not none
        assert traces.rejected is not none


SPEED, LIMIT = QuantityTerm("speed"), QuantityTerm("limit")
NUMBERS = Vocabulary(
    "numbers",
    {"road_user": ObjectType("road_user"), "bus": ObjectType("bus", "road_user")},
    {
        "speed": DeclaredQuantity("speed", (), "km/h", 30.0),
        "limit": DeclaredQuantity("limit", (), "km/h"),
        "station": Enumeration("station", ("road_user",), ("behind", "beside")),
    },
)


def of_numbers(reads, bad, variables=()):
    """The rule that no state may have one of the letters ``bad``."""
    total = 1
    for read in reads:
        total *= read.size
    machine = MealyMonitor(
        reads,
        tuple(int(letter in bad) for letter in range(total)),
        ((0, 1), (1, 1)),
        ((True, False), (False, False)),
        rejecting_sink=1,
        accepting_sink=None,
    )
    return CompiledRule("r", "hard", variables, "", "", P, machine, "")


def at_least(limit):
    return Threshold(Fraction(limit), inclusive=True)


def test_numbers_on_the_right_side_of_their_thresholds():
    speeds = NumberRead(((Fraction(1), SPEED),), (at_least(50), at_least(100)))
    over = NumberRead(
        ((Fraction(1), LIMIT), (Fraction(-1), SPEED)), (Threshold(Fraction(0), inclusive=True),)
    )
    # Letter 2 is 100 km/h or more and more than the limit.
    traces = shortest_traces(of_numbers((speeds, over), {2}), NUMBERS)
    (rejected,), (accepted,) = traces.rejected.states, traces.accepted.states
    assert rejected["speed", ()] >= 100
    assert rejected["speed", ()] > rejected["limit", ()] >= 0
    assert accepted["speed", ()] < 100 or accepted["limit", ()] >= 100


def test_a_default_is_kept_where_it_can_be():
    speeds = NumberRead(((Fraction(1), SPEED),), (at_least(50),))
    traces = shortest_traces(of_numbers((speeds,), {1}), NUMBERS)
    assert traces.accepted.states[0] == {("speed", ()): 30.0}
    assert traces.rejected.states[0] == {("speed", ()): 50.0}


def test_what_no_world_can_be_in_violates_nothing():
    speeds = NumberRead(((Fraction(1), SPEED),), (at_least(50),))
    doubled = NumberRead(((Fraction(1), SPEED), (Fraction(-2), LIMIT)), (at_least(0),))
    halves = NumberRead(((Fraction(1), LIMIT),), (at_least(100),))
    # At 50 km/h at most, but at least twice a limit of 100 km/h or more.
    traces = shortest_traces(of_numbers((speeds, doubled, halves), {2 + 4}), NUMBERS)
    assert traces.rejected is None


@given(st.sets(st.integers(0, 3), min_size=1, max_size=3))
def test_counted_objects_are_there(bad):
    body = Atom("station", ("x",), "behind")
    count = Count("x", "road_user", body)
    reads = (
        Read("station", ("b",), ("behind",), others=True),
        NumberRead(((Fraction(1), count),), (at_least(1),)),
    )
    compiled = of_numbers(reads, bad, (Variable("b", "bus"),))
    traces = shortest_traces(compiled, NUMBERS)
    for trace, is_bad in ((traces.accepted, False), (traces.rejected, True)):
        for state in trace.states if trace else ():
            assert not trace.required
            everyone = ["b", *(further.name for further in trace.objects)]
            behind = [name for name in everyone if state["station", (name,)] == "behind"]
            # The bus itself is one of the objects of the moment.
            letter = (state["station", ("b",)] != "behind") + 2 * (len(behind) >= 1)
            assert (letter in bad) is is_bad
    # A bus behind, and nobody behind: there is no such state, whatever it would violate.
    assert (traces.rejected is None) is (bad == {0})
    assert (traces.accepted is None) is (bad >= {1, 2, 3})


TO_ITSELF = """rulebook r
type a
signal p default false
quantity d(x: a, y: a) in m default 0
hard rule r (v: a) {{ require always (p or every x: a ({condition}d(v, x) - d(x, v) != 1 m)) }}
"""


def test_a_difference_of_a_number_and_itself_is_zero():
    rules = parse_rulebook(TO_ITSELF.format(condition="x = v implies "))
    assert shortest_traces(compile_here(rules).rules[0], rules.vocabulary).rejected is None
    rules = parse_rulebook(TO_ITSELF.format(condition=""))
    traces = shortest_traces(compile_here(rules).rules[0], rules.vocabulary)
    # One beside the rule's own
    assert len(traces.rejected.objects) == 1


def test_a_count_that_always_fits_beside_one_that_may_not():
    rules = parse_rulebook(
        "rulebook r type a signal p(x: a) default false hard rule r { "
        "require always (count x: a (p(x)) <= 1 and count x: a (not p(x)) >= 0) }"
    )
    traces = shortest_traces(compile_here(rules).rules[0], rules.vocabulary)
    assert len(traces.rejected.objects) == 2
