"""A monitor's verdicts on rules and rulebooks, who comes and goes, and what is no snapshot."""

import json
from dataclasses import replace
from fractions import Fraction

import pytest

import rulec
from rulec.api.named_monitor import Monitor
from rulec.automata.compiler import compile_rulebook
from rulec.diagnostics import RulecError, SourceLocation
from rulec.logic.formula import Constant
from rulec.monitoring.online.monitor_sources import replay_trace
from rulec.monitoring.online.monitor_state import SoFar
from rulec.monitoring.verdict import Violation
from rulec.rulebook.loader import parse_rulebook
from rulec.trace import Trace
from support.builders.rulebooks import P, Q, always, book, eventually, far, implies, near, no, rule

CAR, CARS = {"a": "car"}, {"a": "car", "b": "car"}
NEVER_FAR = rule("never_far", always(no(far("x"))), "x: car")
COMES_NEAR = rule("comes_near", eventually(near("x")), "x: car")
ANSWERED = rule("answered", always(implies(P, eventually(Q))))


def monitor(*rules):
    return Monitor(compile_rulebook(book(*rules)))


def verdicts(judge, *steps):
    """Of the rulebook, behind states given as the places of the objects that are there."""
    return [
        judge.step({"place": places, "q": False}, dict.fromkeys(places, "car")).verdict
        for places in steps
    ]


def test_before_the_first_state_nothing_is_known_but_what_is_always_so():
    so_far = monitor(rule("A", P), rule("B", Constant(True), "x: car")).so_far
    assert (so_far.state, so_far.rules) == (-1, {"A": "holds so far", "B": "satisfied"})


def test_a_rule_on_the_world_alone_can_be_satisfied_for_good():
    judge = monitor(rule("A", eventually(P)))
    assert [judge.step({"p": p}).verdict for p in (False, True, False)] == [
        "pending",
        "satisfied",
        "satisfied",
    ]


def test_what_all_have_satisfied_another_may_still_violate():
    judge = monitor(COMES_NEAR)
    assert verdicts(judge, {"a": "near"}, {"a": "far"}) == ["holds so far", "holds so far"]
    assert verdicts(judge, {"a": "far", "b": "far"}) == ["pending"]


def test_a_rulebook_is_as_good_as_its_worst_hard_rule():
    soft = rule("soft", always(no(far("x"))), "x: car", strength="soft")
    found = monitor(soft, COMES_NEAR).step({"place": {"a": "far"}}, CAR)
    assert (found.verdict, found.rules) == (
        "pending",
        {"soft": "violated", "comes_near": "pending"},
    )
    assert monitor(soft).step({"place": {"a": "far"}}, CAR).verdict == "satisfied"


def test_who_leaves_while_something_is_pending_has_violated_it():
    judge = monitor(COMES_NEAR)
    assert verdicts(judge, {"a": "far"}, {"a": "gone"}, {}) == ["pending", "pending", "violated"]
    (change,) = judge.so_far.changes
    assert change == ("comes_near", {"x": "a"}, "pending", "violated", True)
    assert judge.violations == (Violation("comes_near", "hard", {"x": "a"}, None),)


def test_a_violation_outlasts_its_objects():
    judge = monitor(NEVER_FAR)
    assert verdicts(judge, {"a": "far"}, {}, {"b": "near"}) == ["violated"] * 3
    assert judge.violations == (Violation("never_far", "hard", {"x": "a"}, 0),)


def test_who_comes_back_begins_anew():
    judge = monitor(rule("begins_near", near("x"), "x: car"))
    assert verdicts(judge, {"a": "near"}, {"a": "far"}, {}, {"a": "near"}) == ["holds so far"] * 4
    assert verdicts(judge, {}, {"a": "far"}) == ["holds so far", "violated"]


def test_who_is_of_another_type_is_another():
    judge = monitor(rule("begins_near", near("x"), "x: thing"))
    judge.step({"place": {"a": "near"}}, {"a": "car"})
    assert judge.step({"place": {"a": "far"}}, {"a": "thing"}).verdict == "violated"


def test_a_pair_begins_when_both_are_there_and_ends_when_one_leaves():
    judge = monitor(rule("pair", eventually(near("y")), "x: car", "y: car"))
    assert verdicts(judge, {"a": "far"}, {"a": "far", "b": "near"}) == ["holds so far", "pending"]
    assert [one.binding for one in judge.so_far.changes] == [
        {"x": "a", "y": "b"},
        {"x": "b", "y": "a"},
    ]
    judge.step({"place": {"b": "far"}}, {"b": "car"})
    assert [one.binding for one in judge.violations] == [{"x": "b", "y": "a"}]


def test_who_changes_the_mapping_of_objects_that_it_has_given_is_understood():
    judge, objects = monitor(COMES_NEAR), {"a": "car"}
    judge.step({"place": {"a": "far"}}, objects)
    objects["b"] = "car"
    found = judge.step({"place": {"a": "near", "b": "far"}}, objects)
    assert [(one.binding["x"], one.verdict) for one in found.changes] == [
        ("a", "satisfied"),
        ("b", "pending"),
    ]


def test_an_interrupted_step_is_none(monkeypatch):
    judge = monitor(NEVER_FAR)
    judge.step({"place": {"a": "near"}}, CAR)
    before = judge.snapshot()

    def interrupted(*_):
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr("rulec.monitoring.online.running_monitor.Violation", interrupted)
        with pytest.raises(KeyboardInterrupt):
            judge.step({"place": {"a": "far"}}, CAR)
    assert judge.snapshot() == before
    assert judge.step({"place": {"a": "far"}}, CAR).state == 1
    assert len(judge.violations) == 1


def test_what_an_interrupted_step_has_noted_was_none():
    class Interrupted(Monitor):
        def __setattr__(self, name, value):
            if name == "_now" and vars(self).get("_violations"):
                raise KeyboardInterrupt
            super().__setattr__(name, value)

    judge = monitor(NEVER_FAR)
    judge.step({"place": {"a": "near"}}, CAR)
    judge.__class__ = Interrupted
    with pytest.raises(KeyboardInterrupt):
        judge.step({"place": {"a": "far"}}, CAR)
    judge.__class__ = Monitor
    assert judge.violations == ()
    judge.step({"place": {"a": "near"}}, CAR)
    judge.step({"place": {"a": "far"}}, CAR)
    assert [violation.step for violation in judge.violations] == [2]


@pytest.mark.parametrize(
    ("state", "objects", "code"),
    [
        ([], CAR, "R0501"),
        ({}, ["a"], "R0501"),
        ({"plaice": {"a": "near"}}, CAR, "R0502"),
        ({"place": {"a": "nearly"}}, CAR, "R0503"),
        ({"place": {"a": "near"}, "p": 1}, CAR, "R0503"),
        ({"place": {"a": ["near"]}}, CAR, "R0503"),
        ({"place": "near"}, CAR, "R0503"),
        ({}, CAR, "R0504"),
        ({"place": {}}, CAR, "R0504"),
        ({"place": {"a": "near"}}, {"a": "bus"}, "R0505"),
        ({"place": {"a": "near", "b": "near"}}, CAR, "R0505"),
        # Names that are no text, as Python code may have them.
        ({7: True}, CAR, "R0502"),
        ({"place": {7: "near"}}, CAR, "R0505"),
        ({"place": {}}, {7: "car"}, "R0504"),
    ],
)
def test_what_is_no_state_is_said_with_its_place_and_changes_nothing(state, objects, code):
    judge = monitor(NEVER_FAR)
    judge.step({"place": {"a": "near"}}, CAR)
    before = judge.snapshot()
    with pytest.raises(RulecError) as refused:
        judge.step(state, objects, SourceLocation("drive.jsonl", 7))
    (diagnostic,) = refused.value.diagnostics
    assert (diagnostic.code, diagnostic.place) == (code, SourceLocation("drive.jsonl", 7))
    assert judge.snapshot() == before


FACTS = parse_rulebook(
    """
rulebook facts
type car
signal standing(c: car), turning(c: car) default false
signal horn default false
fact not (standing(c) and turning(c))
fact count c: car (turning(c)) <= 1
hard rule no_horn (c: car) { require always not (horn and (standing(c) or turning(c))) }
"""
)


@pytest.mark.parametrize(
    "state",
    [
        {"standing": {"a": True}, "turning": {"a": True}},
        {"turning": {"a": True, "b": True}},
    ],
)
def test_a_state_that_cannot_be_is_refused(state):
    judge = Monitor(compile_rulebook(FACTS))
    judge.step({"turning": {"a": True}}, CARS)
    with pytest.raises(RulecError, match="state 1 cannot be") as refused:
        judge.step(state, CARS)
    assert refused.value.diagnostics[0].code == "R0508"
    assert judge.so_far.state == 0


def test_a_state_that_cannot_be_is_refused_where_no_fact_counts():
    """Then letters are read off values that are remembered."""
    rulebook = replace(FACTS, axioms=FACTS.axioms[:1])
    judge = Monitor(compile_rulebook(rulebook))
    judge.step({"standing": {"a": False}, "turning": {"a": True}}, CAR)
    with pytest.raises(RulecError, match="state 1 cannot be"):
        judge.step({"standing": {"a": True}, "turning": {"a": True}}, CAR)
    assert judge.so_far.state == 0


@pytest.mark.parametrize(
    ("fact", "verdict"),
    [("", "holds so far"), ("fact not (standing(c) and turning(c))", "satisfied")],
)
def test_only_what_can_be_may_follow(fact, verdict):
    judge = Monitor(
        compile_rulebook(
            parse_rulebook(
                "rulebook facts type car signal standing(c: car), turning(c: car) default false "
                f"{fact} hard rule either (c: car) "
                "{ require always not (standing(c) and turning(c)) }"
            )
        )
    )
    assert judge.step({"turning": {"a": True}}, CAR).verdict == verdict


TIMED = parse_rulebook(
    "rulebook timed signal p default false "
    "hard rule soon { require always (p implies eventually[<= 1 s] not p) }"
)


def test_bounds_in_seconds_go_by_the_step():
    found = []
    for step in (Fraction(1), Fraction(1, 2)):
        judge = Monitor(rulec.compile_rulebook(TIMED, step_s=step))
        assert judge.step_s == step
        found.append([judge.step({"p": True}).verdict for _ in range(3)])
    assert found == [["pending", "violated", "violated"], ["pending", "pending", "violated"]]


def test_another_step_than_the_rules_were_compiled_for_is_refused():
    with pytest.raises(RulecError) as refused:
        Monitor(rulec.compile_rulebook(TIMED, step_s=1), 0.5)
    assert refused.value.diagnostics[0].code == "R0507"


def test_a_recorded_trace_is_taken_state_by_state():
    """What it says of objects that are not there is no matter, as for `verify`."""
    places = [{"place": {"a": "far", "b": "near"}}, {"place": {"a": "near", "b": "far"}}]
    trace = Trace("t", 1.0, CARS, tuple(places), {"b": (0, 0)})
    judge = replay_trace(trace, compile_rulebook(book(NEVER_FAR)))
    assert judge.objects == {"a": "car"}
    assert judge.violations == (Violation("never_far", "hard", {"x": "a"}, 0),)


def saved():
    """Behind a violation, with somebody there and something pending."""
    judge = monitor(NEVER_FAR, COMES_NEAR, ANSWERED)
    judge.step({"place": {"b": "far"}, "q": True}, {"b": "car"})
    judge.step({"place": {"a": "gone"}, "q": False}, {"a": "car"})
    return judge.snapshot()


def restored(data):
    return Monitor.restore(compile_rulebook(book(NEVER_FAR, COMES_NEAR, ANSWERED)), data)


def test_a_snapshot_is_json_and_says_all():
    judge = restored(json.loads(json.dumps(saved())))
    assert judge.so_far == SoFar(
        1,
        "violated",
        {"never_far": "violated", "comes_near": "violated", "answered": "holds so far"},
        (),
    )
    assert judge.violations == (
        Violation("never_far", "hard", {"x": "b"}, 0),
        Violation("comes_near", "hard", {"x": "b"}, None),
    )
    assert judge.objects == {"a": "car"}


def with_(path, value):
    def damage(data):
        *way, last = path
        for key in way:
            data = data[key]
        data[last] = value

    return damage


def without(key):
    return lambda data: data.pop(key)


DAMAGES = [
    with_(["format"], "rulec compiled rulebook"),
    with_(["version"], 3),
    with_(["machines"], "0" * 64),
    with_(["step_s"], "0"),
    with_(["step_s"], "1/0"),
    with_(["states"], -1),
    with_(["states"], 0),
    with_(["objects"], {"a": "bus"}),
    with_(["objects"], {}),
    with_(["objects"], {"a": "car", "b": "car"}),
    with_(["rules", 0, "rule"], "somebody"),
    with_(["rules", 0, "bindings", 0, "objects"], ["b"]),
    with_(["rules", 0, "bindings", 0, "state"], 7),
    with_(["rules", 0, "bindings", 0, "verdict"], "fine"),
    with_(["rules", 0, "bindings", 0, "verdict"], "violated"),
    with_(["rules", 0, "bindings"], []),
    with_(["violations", 0, "rule"], "somebody"),
    with_(["violations", 0, "binding"], {"y": "b"}),
    with_(["violations", 0, "step"], 2),
    without("rules"),
    without("format"),
]


@pytest.mark.parametrize("damage", DAMAGES)
def test_what_is_no_snapshot_of_these_rules_is_refused(damage):
    data = saved()
    damage(data)
    with pytest.raises(RulecError) as refused:
        restored(data)
    assert [one.code for one in refused.value.diagnostics] == ["R0510"]


def test_rules_of_another_step_are_named_as_that(tmp_path):
    path = tmp_path / "soon.rules"
    path.write_text(
        "rulebook soon\nsignal p, q\n"
        "hard rule r { require always (p implies eventually[<= 2 s] q) }\n"
    )
    saved = Monitor(rulec.compile_rulebook(path, step_s=1), 1).snapshot()
    with pytest.raises(RulecError) as refused:
        Monitor.restore(rulec.compile_rulebook(path, step_s=Fraction(1, 10)), saved)
    (problem,) = refused.value.diagnostics
    assert (problem.code, problem.message) == (
        "R0510",
        "this monitor was saved for a step of 1 s, and these rules are compiled for 1/10 s",
    )
    assert "`step_s`" in problem.help


@pytest.mark.parametrize("data", [None, [], 1, "text", {}])
def test_what_is_no_snapshot_at_all_is_refused(data):
    with pytest.raises(RulecError, match="not a saved monitor"):
        restored(data)


def test_whose_rules_it_was_saved_with_is_said():
    other = compile_rulebook(book(NEVER_FAR))
    with pytest.raises(RulecError, match="an earlier or later `test`"):
        Monitor.restore(other, saved())
    with pytest.raises(RulecError, match="rulebook `test`, not of `esterle2019`"):
        Monitor.restore(rulec.compile_rulebook("esterle2019"), saved())


def test_nothing_is_kept_of_the_past_but_where_machines_stand():
    """A snapshot is all that a monitor knows; in time it counts states and no more."""
    judge, sizes = monitor(NEVER_FAR, COMES_NEAR, ANSWERED), []
    cycle = [{"a": "near"}, {"a": "gone", "b": "near"}, {"b": "near"}]
    for _ in range(50):
        verdicts(judge, *cycle)
        sizes.append({**judge.snapshot(), "states": 0})
    assert sizes[0] == sizes[-1]
    assert judge.so_far.state == 149


BELOW_ZERO = """rulebook below
quantity drift in m
hard rule kept { require always drift > -2 m }
hard rule right { require eventually drift >= 0 m }"""


@pytest.mark.parametrize("drift", [-1e30, -3, -2, -1.5, -1, 0, 0.5])
def test_limits_below_zero_tell_numbers_apart(drift):
    rules = compile_rulebook(parse_rulebook(BELOW_ZERO))
    monitor = Monitor(rules)
    monitor.step({"drift": -1})
    so_far = monitor.step({"drift": drift})
    assert so_far.rules == {
        "kept": "holds so far" if drift > -2 else "violated",
        "right": "satisfied" if drift >= 0 else "pending",
    }
    # What is violated for good outweighs what is pending.
    worst = "violated" if drift <= -2 else "pending" if drift < 0 else "holds so far"
    assert so_far.verdict == worst
