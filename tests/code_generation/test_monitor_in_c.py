"""Monitors in C say what Python's say, after every state, on random rulebooks and drives."""

import ctypes
import shutil
from fractions import Fraction

import pytest
from hypothesis import Phase, given, settings

import rulec
from rulec.api.named_monitor import Monitor
from rulec.code_generation.compiled_c.c_library import CLibrary, CMonitor
from rulec.code_generation.monitor_layout import monitor_layout
from rulec.code_generation.proof.monitor_proof import is_no_narrower
from rulec.code_generation.proof.probing_inputs import weighs
from rulec.diagnostics import RulecError
from rulec.rulebook.rules.axiom_instances import counts
from rulec.vocabulary.partial_values import UNKNOWN, Interval
from support.builders.monitored_books import BLAMED, WHO_IS_BLAMED
from support.builders.rulebooks import compile_here
from support.generators.blurred_traces import blurred
from support.generators.random_rulebooks import rulebook
from support.generators.random_traces import traces
from support.generators.seeds import seeds
from support.oracles.presence import there

needs_a_compiler = pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler")
EXCLUDED, UNTAKEN = 5, {1, 2, 3, 4, 5}


def values_in(value):
    if isinstance(value, dict):
        for inner in value.values():
            yield from values_in(inner)
    else:
        yield value


def is_plain(state):
    """All is known, and no number is so large that a double may not be it."""
    return not any(
        value is UNKNOWN
        or isinstance(value, Interval)
        or (not isinstance(value, bool | str) and not abs(value) < 1e9)
        for value in values_in(state)
    )


def without_intervals(value):
    if isinstance(value, dict):
        return {key: without_intervals(inner) for key, inner in value.items()}
    return UNKNOWN if isinstance(value, Interval) else value


@needs_a_compiler
@given(seeds)
@settings(phases=[Phase.generate], max_examples=settings().max_examples // 12)
def test_what_python_says(chance):
    step_s = chance.choice([Fraction(1), Fraction(1, 2)])
    book = rulebook(chance, step_s)
    compiled = compile_here(book, step_s)
    weighed = any(weighs(read) for rule in compiled.rules for read in rule.machine.reads)
    counting = any(counts(axiom.formula) for axiom in compiled.axioms)
    bounds = chance.choice([{}, {"thing": 1}, {"thing": 2, "car": 1}])
    library = CLibrary(monitor_layout(compiled, bounds), optimised=False)
    for trace in traces(chance, step_s):
        names = {name for state in trace.states for name in state}
        trace = blurred(chance, trace, names, most=chance.choice([0, 0, 3]))
        ours, theirs = Monitor(compiled, step_s), CMonitor(library)
        plain = True
        for number, state in enumerate(trace.states):
            state = without_intervals(state)
            objects = there(trace, number)
            try:
                said = ours.step(state, objects)
            except RulecError as error:
                # What is missing is not known in C; facts that count are not looked at.
                if error.diagnostics[0].code != "R0508" or counting:
                    break
                # What is not known together may contradict a fact that C takes by itself.
                found = theirs.step(state, objects)
                assert found.status == EXCLUDED or not is_plain(state)
                if found.status != EXCLUDED:
                    break
                continue
            found = theirs.step(state, objects)
            assert found.status == 0
            plain = plain and is_plain(state) and found.left_out == 0
            for rule in compiled.rules:
                own, other = said.rules[rule.name], found.rules[rule.name]
                assert is_no_narrower(other, own)
                assert own == other or not plain or any(map(weighs, rule.machine.reads))
            assert is_no_narrower(found.verdict, said.verdict)
            assert found.violations <= len(ours.violations)
            if plain and not weighed:
                assert found.violations == len(ours.violations)


@pytest.fixture(scope="module")
def esterle():
    return CLibrary(monitor_layout(rulec.compile_rulebook("esterle2019", step_s=1), {"vehicle": 2}))


def drive(monitor, *positions):
    return [
        monitor.step({"position": state}, dict.fromkeys(state, "vehicle")) for state in positions
    ]


@needs_a_compiler
def test_who_has_no_seat_is_reported_and_doubted(esterle):
    first, second = drive(CMonitor(esterle), {"a": "b", "b": "b"}, {"a": "b", "b": "b", "c": "b"})
    assert (first.left_out, first.verdict) == (0, "holds so far")
    assert second.left_out == 1
    assert second.verdict == ("holds so far", "violated")


@needs_a_compiler
@pytest.mark.parametrize("ids", [[1, 2, 3, 3], [1, 2, 3, 1], [1, 3, 2, 3]])
def test_who_is_given_twice_without_a_seat_is_refused(esterle, ids):
    monitor = CMonitor(esterle)
    drive(monitor, {"a": "b", "b": "b"})
    given = esterle.input_type()
    objects = (esterle.object_type * 4)()
    for one, number in zip(objects, ids, strict=True):
        one.type, one.id = esterle.layout.fields.types.index("vehicle"), number
    given.n_objects, given.objects = 4, objects
    assert monitor.take(given) == 3


@needs_a_compiler
def test_who_has_left_gives_away_the_seat(esterle):
    passing = [{"a": "b", "b": "b"}, {"b": "r", "c": "b"}, {"b": "f", "c": "b", "a": "b"}]
    *_, third = drive(CMonitor(esterle), *passing)
    assert (third.verdict, third.violations, third.left_out) == ("violated", 1, 1)


OVERTAKEN = """\
rulebook overtaken
type car
type bicycle
place(c: car) is one of behind, beside, in_front
signal seen(b: bicycle) default false

hard rule passed (c: car) { require always (in_front(c) implies once beside(c)) }
hard rule watched (c: car, b: bicycle) {
  require always (in_front(c) implies once (beside(c) and seen(b)))
}
"""
BICYCLE = {"bike": "bicycle"}


@pytest.fixture(scope="module")
def overtaken():
    book = rulec.compile_rulebook(rulec.parse_rulebook(OVERTAKEN), step_s=1)
    return CLibrary(monitor_layout(book, {"car": 1, "bicycle": 1}))


def places(monitor, *states):
    """The answers to states with a place of each car, and the other objects that are present."""
    return [
        monitor.step({"place": cars}, {**dict.fromkeys(cars, "car"), **others})
        for cars, others in states
    ]


@needs_a_compiler
def test_who_gets_a_seat_late_may_have_any_past(overtaken):
    *_, third, fourth, fifth = places(
        CMonitor(overtaken),
        ({"one": "behind", "two": "behind"}, BICYCLE),
        ({"one": "behind", "two": "beside"}, BICYCLE),
        ({"two": "in_front"}, BICYCLE),
        ({}, BICYCLE),
        ({"two": "in_front"}, BICYCLE),
    )
    for answer in (third, fourth):
        assert (answer.left_out, answer.violations) == (0, 0)
        assert set(answer.rules.values()) == {("holds so far", "violated")}
    # Nobody was left out of the state before: it has returned as a new object.
    assert (fifth.verdict, fifth.violations) == ("violated", 2)


@needs_a_compiler
def test_a_choice_with_a_new_object_begins_with_it(overtaken):
    *_, third = places(
        CMonitor(overtaken),
        ({"one": "behind", "two": "behind"}, {}),
        ({"one": "behind", "two": "beside"}, {}),
        ({"two": "in_front"}, BICYCLE),
    )
    assert third.rules == {"passed": ("holds so far", "violated"), "watched": "violated"}
    assert third.violations == 1


@needs_a_compiler
def test_a_refused_state_forgets_nobody_without_a_seat(overtaken):
    monitor = CMonitor(overtaken)
    places(monitor, ({"one": "behind", "two": "beside"}, {}))
    given = overtaken.input_type()
    given.n_objects = 1
    given.objects = (overtaken.object_type * 1)()
    given.objects[0].type = 99
    assert monitor.take(given) == 2
    (answer,) = places(monitor, ({"two": "in_front"}, {}))
    assert answer.rules["passed"] == ("holds so far", "violated")


@needs_a_compiler
def test_a_rule_is_about_whoever_has_its_worst_verdict():
    book = rulec.compile_rulebook(rulec.parse_rulebook(BLAMED), step_s=1)
    library = CLibrary(monitor_layout(book, {"car": 2}))
    about, monitor, blamed = library.call("about"), CMonitor(library), []
    for p, cars, _ in WHO_IS_BLAMED:
        given = library.input_type()
        given.p, given.n_objects = p, len(cars)
        given.objects = (library.object_type * 2)()
        for place, (number, q) in enumerate(cars.items()):
            given.objects[place].id, given.objects[place].q = number, q
        assert monitor.take(given) == 0
        blamed.append(about(monitor.state, 0, 0))
    assert blamed == [number for *_, number in WHO_IS_BLAMED]


@needs_a_compiler
def test_a_rule_without_variables_is_about_nobody(tmp_path):
    path = tmp_path / "mixed.rules"
    path.write_text(
        "rulebook mixed\ntype car\nsignal p, q(c: car)\n"
        "hard rule alone { require always p }\n"
        "hard rule other (c: car) { require always q(c) }\n"
    )
    library = CLibrary(monitor_layout(rulec.compile_rulebook(path, step_s=1), {"car": 2}))
    about = library.call("about")
    monitor = CMonitor(library)
    given = library.input_type()
    cars = (library.object_type * 1)()
    cars[0].id = 7
    given.n_objects, given.objects = 1, cars
    assert monitor.take(given) == 0
    state = monitor.state
    assert [about(state, rule, 0) for rule in (0, 1)] == [0, 7]
    assert about(state, 1, 1) == 0


@needs_a_compiler
@pytest.mark.parametrize(
    ("kinds", "ids", "status"), [([0, 99], [1, 2], 2), ([1, 1], [3, 3], 3), ([1, 1], [3, 4], 0)]
)
def test_what_is_no_input_is_refused_and_changes_nothing(esterle, kinds, ids, status):
    monitor = CMonitor(esterle)
    drive(monitor, {"a": "b"})
    before = bytes(monitor.state)
    given = esterle.input_type()
    objects = (esterle.object_type * 2)()
    for one, kind, number in zip(objects, kinds, ids, strict=True):
        one.type, one.id = kind, number
    given.n_objects, given.objects = 2, objects
    assert monitor.take(given) == status
    if status in UNTAKEN:
        # From here on in the state is what a step works with.
        kept = esterle.call("kept_size")()
        assert bytes(monitor.state)[:kept] == before[:kept]


@needs_a_compiler
def test_a_pointer_that_leads_nowhere(esterle):
    step = esterle.call("step")
    monitor = CMonitor(esterle)
    given = esterle.input_type()
    assert step(None, ctypes.byref(given), monitor.answer) == 1
    given.n_objects = 1
    assert monitor.take(given) == 1
    given.n_objects = 60_001
    given.objects = (esterle.object_type * 1)()
    assert monitor.take(given) == 4
