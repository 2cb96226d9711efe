"""Opportunities counted by hand, and on random rulebooks beside the verdict."""

import re
from dataclasses import replace
from fractions import Fraction
from io import BytesIO
from itertools import groupby, product
from random import Random

import pytest
from hypothesis import Phase, given, settings

from rulec.diagnostics import RulecError
from rulec.logic.free_names import names_in
from rulec.monitoring.batch.batch_verify import verify_items
from rulec.monitoring.batch.verify import verify
from rulec.monitoring.moments import drive_facts
from rulec.monitoring.moments.drive_facts import facts_of, facts_of_many
from rulec.monitoring.moments.exposure import Exposure
from rulec.rulebook.loader import parse_rulebook
from rulec.trace import Trace
from rulec.trace.formats.trace_files import kinds_in, read_chunks, write_traces
from rulec.vocabulary.partial_values import UNKNOWN
from support.builders.rulebooks import compile_here
from support.builders.short_states import state_of
from support.generators.blurred_traces import blurred
from support.generators.random_rulebooks import rulebook
from support.generators.random_traces import traces
from support.generators.seeds import seeds

HEAD = """
rulebook counted
type vehicle
signal red, go, siren, way_free, ordered default false
signal behind(v: vehicle), beside(v: vehicle), ahead(v: vehicle) default false
"""


def counted(
    rule, *states, objects=("a",), step_s=0.5, ends="complete", present=None, semantics="stutter"
):
    """The exposure to a rule of a trace whose states are the names that are true in each."""
    head = HEAD.replace("counted", f"counted semantics {semantics}")
    compiled = compile_here(parse_rulebook(head + rule), Fraction(step_s))
    trace = Trace(
        "t",
        step_s,
        dict.fromkeys(objects, "vehicle"),
        tuple(map(state_of, states)),
        present or {},
        ends=ends,
    )
    return facts_of(trace, compiled, verify(trace, compiled)).exposure["r"]


IMPLICATION = "hard rule r { require always (red implies not go) }"


def test_an_implication():
    """Two red lights, the first for two states; ego goes at the second one."""
    found = counted(IMPLICATION, "", "red", "red", "go", "red go", "")
    assert found == Exposure(2, 2, 1.5, 1.5, 1, 1)


def test_who_has_left_is_nobody_to_be_exposed_to():
    """The trigger holds in the second of two states, and where that is repeated for the verdict."""
    rule = "hard rule r (v: vehicle) { require always (previously behind(v) implies not red) }"
    found = counted(rule, "behind(a)", "behind(a)", "", "", present={"a": (0, 1)})
    assert found == Exposure(1, 1, 0.5, 0.5, 0, 0)


def test_a_rule_may_be_violated_at_several_opportunities():
    """The verdict knows one violation, the one that cannot be mended."""
    found = counted(IMPLICATION, "red go", "red go", "", "red", "", "red go")
    assert (found.opportunities, found.violated) == (3, 2)


def test_a_prohibition_is_read_as_an_implication():
    prohibition = "hard rule r { require never (red and go) }"
    found = counted(prohibition, "", "red", "red", "go", "red go", "")
    assert found == Exposure(2, 2, 1.5, 1.5, 1, 1)


def test_an_exception_takes_its_states_out():
    """Where somebody orders it, a red light is none: it parts the first stretch into two."""
    rule = "hard rule r { require never (red and go) unless ordered }"
    found = counted(rule, "red", "red ordered go", "red", "ordered", "red go")
    assert found == Exposure(3, 3, 1.5, 1.5, 1, 1)


SEQUENCE = """hard rule r (v: vehicle) {
  require never (behind(v) then beside(v) and red then ahead(v))
}"""


def test_a_sequence():
    """Ego is behind a twice and behind b once; at red it passes a, and b goes off."""
    found = counted(
        SEQUENCE,
        "behind(a) behind(b)",
        "behind(a) behind(b)",
        "beside(a) red beside(b)",
        "ahead(a)",
        "behind(a)",
        objects=("a", "b"),
    )
    # Two states behind both count once, and the last one behind a.
    assert found == Exposure(3, 3, 1.5, 1.5, 1, 1)


DUTY = "hard rule r { require always (siren implies eventually[<= 1 s] way_free) }"


def test_a_bounded_duty():
    """A siren for three states, free after one; then one that nobody made way for."""
    found = counted(DUTY, "siren", "siren way_free", "", "", "siren", "siren", "", "", "")
    assert found == Exposure(2, 2, 2.0, 2.0, 1, 1)


def test_a_duty_that_is_pending_when_the_recording_ends_is_open():
    found = counted(DUTY, "siren way_free", "", "siren", ends="cut")
    assert found == Exposure(2, 2, 1.0, 1.0, 0, 1)


def test_what_is_unknown_may_be_an_opportunity():
    """Known red parted by an unknown state is one for sure and may be two."""
    found = counted(IMPLICATION, "red", "?red", "red", "", "?red", "?red")
    assert found == Exposure(1, 3, 1.0, 2.5, 0, 0)


def test_what_may_be_violated():
    found = counted(IMPLICATION, "?red", "", "red ?go", "", "red go", "", "?red go")
    assert found == Exposure(2, 4, 1.0, 2.0, 1, 3)


def test_what_is_unknown_beside_a_known_opportunity_may_be_violated_with_it():
    """Red, if it was in the first state, was violated there, and again in the last one."""
    found = counted(IMPLICATION, "?red go", "red", "?red", "red go")
    assert found == Exposure(1, 2, 1.0, 2.0, 1, 2)
    # In between, it belongs to the one before, and there are not three
    found = counted(IMPLICATION, "red go", "?red go", "red", "?red go")
    assert found == Exposure(1, 2, 1.0, 2.0, 1, 2)
    assert counted(IMPLICATION, "red", "?red go", "red") == Exposure(1, 2, 1.0, 1.5, 0, 1)


def test_an_unknown_state_belongs_to_the_opportunity_at_which_it_is_worst():
    """Red came on again in the third state, and not only in the last one."""
    found = counted(IMPLICATION, "red go", "?red", "?red go", "red")
    assert found == Exposure(1, 2, 1.0, 2.0, 1, 2)
    # Of two such states, one each if another parts them
    found = counted(IMPLICATION, "red", "?red go", "?red", "?red go", "red")
    assert found == Exposure(1, 2, 1.0, 2.5, 0, 2)
    found = counted(IMPLICATION, "red", "?red go", "?red go", "red")
    assert found == Exposure(1, 2, 1.0, 2.0, 0, 1)


@given(seeds)
@settings(phases=[Phase.generate], max_examples=60)
def test_at_most_as_many_are_violated_as_in_the_worst_case(chance):
    """Of all ways to know what is unknown that have no more opportunities than are possible."""
    words = ["", "red", "?red", "?red", "red go", "?red go", "?red ?go", "go"]
    states = [chance.choice(words) for _ in range(chance.randint(1, 8))]
    found = counted(IMPLICATION, *states)
    groups = re.findall(r"[1?]+", "".join(map(_red, states)))
    most = [max(len(re.findall("1+", group)), 1) for group in groups]
    worst = sum(map(_worst, _parts_of(states), most))
    assert (found.perhaps_opportunities, found.perhaps_violated) == (sum(most), worst)


def _red(state):
    return "?" if "?red" in state else "1" if "red" in state else "0"


def _parts_of(states):
    """The parts of a trace in which it may always have been red."""
    for may_be, part in groupby(states, lambda state: _red(state) != "0"):
        if may_be:
            yield list(part)


def _worst(part, most):
    """The most violated opportunities of a part, with so many of them or fewer."""
    unknown = [place for place, state in enumerate(part) if "?red" in state]
    worst = 0
    for reds in product([False, True], repeat=len(unknown)):
        known = [True] * len(part)
        for place, red in zip(unknown, reds, strict=True):
            known[place] = red
        breaches = [
            any("go" in state for _, state in stretch)
            for red, stretch in groupby(zip(known, part, strict=True), lambda pair: pair[0])
            if red
        ]
        if len(breaches) <= most:
            worst = max(worst, sum(breaches))
    return worst


def test_an_open_rule_may_have_been_violated_and_is_not_for_sure():
    assert counted(IMPLICATION, "red ?go", "", "red") == Exposure(2, 2, 1.0, 1.0, 0, 1)


def test_without_a_trigger_each_choice_is_one_opportunity():
    rule = "hard rule r (v: vehicle) { require always behind(v) }"
    present = {"b": (1, 2)}
    states = ("behind(a)", "behind(a)", "behind(a) behind(b)", "behind(a)")
    found = counted(rule, *states, objects=("a", "b"), present=present)
    assert found == Exposure(2, 2, 2.0, 2.0, 1, 1)


def test_without_objects_there_is_no_opportunity():
    rule = "hard rule r (v: vehicle) { require always behind(v) }"
    assert counted(rule, "red", objects=()) == Exposure(0, 0, 0.0, 0.0, 0, 0)


def test_a_trigger_that_holds_only_once_the_last_state_is_repeated():
    """The paper's reading: the last state goes on for ever, so it was red before."""
    rule = "hard rule r { require always (previously red implies go) }"
    assert counted(rule, "", "red") == Exposure(1, 1, 0.0, 0.0, 1, 1)
    assert counted(rule, "", "red", semantics="finite") == Exposure(0, 0, 0.0, 0.0, 0, 0)


@pytest.mark.parametrize("clause", ["unless ordered initially", "when not ordered"])
def test_a_rule_of_the_whole_trace_applies_or_not(clause):
    rule = f"hard rule r {{ require eventually go {clause} }}"
    assert counted(rule, "ordered", "") == Exposure(0, 0, 0.0, 0.0, 0, 0)
    assert counted(rule, "", "ordered") == Exposure(1, 1, 1.0, 1.0, 1, 1)


@given(seeds)
@settings(phases=[Phase.generate], max_examples=30)
def test_violations_lie_in_opportunities(chance):
    """Of each rule some opportunity is violated exactly if the verdict says that the rule is."""
    book = rulebook(chance, Fraction(1))
    compiled = compile_here(book, Fraction(1))
    names = {name for rule in book.rules for name in names_in(rule.formula)}
    judged = []
    for whole in traces(chance, Fraction(1)):
        back = replace(whole, states=whole.states[::-1]) if not whole.present else whole
        for trace in (whole, back, blurred(chance, whole, names)):
            try:
                verdict = verify(trace, compiled)
            except RulecError:
                continue
            judged.append((trace, verdict))
            found = facts_of(trace, compiled, verdict).exposure
            for name, own in found.items():
                violated = [one for one in verdict.violations if one.rule == name]
                doubtful = [one for one in verdict.open if one.rule == name]
                assert len(violated) <= own.violated <= own.perhaps_violated
                assert own.perhaps_violated <= own.perhaps_opportunities
                assert own.violated <= own.opportunities <= own.perhaps_opportunities
                assert (own.violated > 0) == bool(violated)
                assert (own.perhaps_violated > 0) == bool(violated or doubtful)
                assert own.opportunities_s <= own.perhaps_opportunities_s <= len(trace.states)
    items, verdicts = zip(*judged, strict=True) if judged else ((), ())
    alone = [facts_of(trace, compiled, verdict) for trace, verdict in judged]
    assert facts_of_many(items, verdicts, compiled) == alone


@pytest.mark.parametrize("form", ["jsonl", "csv", "parquet"])
def test_traces_of_a_file_have_the_exposures_that_each_has_alone(form, monkeypatch):
    """Several lengths, stretches of presence and names, in columns as they were read."""
    compiled = compile_here(parse_rulebook(HEAD + SEQUENCE + PLAIN + COUNTING), Fraction(1, 2))
    chance = Random(3)
    drives = [drive(chance, number) for number in range(80)]
    alone = [facts_of(trace, compiled, verify(trace, compiled)) for trace in drives]
    assert len({one.n_states for one in alone}) > 2
    for name in ("r", "p", "c"):
        assert len({one.exposure[name].violated for one in alone}) > 1
    monkeypatch.setattr(drive_facts, "facts_of", lambda *_: pytest.fail("one was alone"))
    stream = BytesIO()
    write_traces(drives, stream, "t", form, kinds_in(s for x in drives for s in x.states))
    stream.seek(0)
    found = []
    for chunk in read_chunks(stream, "t", form):
        for items, answers in verify_items(chunk, compiled):
            found += facts_of_many(items, list(answers), compiled)
    assert found == alone


PLAIN = (
    "hard rule p (v: vehicle, w: vehicle) { require always (red implies beside(v) or ahead(w)) }"
)
COUNTING = "hard rule c { require always (red implies count v: vehicle (beside(v)) <= 1) }"


def drive(chance, number):
    """What a random vehicle does; a second one of half of them comes later."""
    n_states = chance.choice([4, 4, 5, 9])
    cars = [f"{number}.{place}" for place in range(chance.choice([1, 2, 2]))]
    late = cars[1:] if number % 2 else []
    states = []
    for state in range(n_states):
        there = [car for car in cars if state or car not in late]
        places = {car: chance.choice(["behind", "beside", "beside", "ahead"]) for car in there}
        said = {
            name: {car: places[car] == name for car in there}
            for name in ("behind", "beside", "ahead")
        }
        states.append({"red": chance.random() < 0.7, **said})
    present = dict.fromkeys(late, (1, n_states - 1))
    return Trace(f"t{number}", 0.5, dict.fromkeys(cars, "vehicle"), tuple(states), present)


@pytest.mark.parametrize(
    ("states", "expected"),
    [
        ([("motorway", False)] * 2 + [("ordinary_road", True)], "motorway"),
        ([("ordinary_road", True)] * 2, "built-up"),
        ([("expressway", False)] * 2, "outside"),
        ([("motorway", False), (UNKNOWN, False), (UNKNOWN, False)], ""),
        ([("ordinary_road", UNKNOWN)] * 2, ""),
    ],
)
def test_the_class_of_a_road_is_by_the_words_of_the_vocabulary_that_ships(states, expected):
    text = (
        "rulebook r use road hard rule r { require always (motorway implies speed <= 80 km/h) } "
        "hard rule s { require always (built_up implies speed <= 50 km/h) }"
    )
    compiled = compile_here(parse_rulebook(text), Fraction(1))
    named = tuple({"road_class": kind, "built_up": within} for kind, within in states)
    trace = Trace("t", 1.0, {}, named)
    assert facts_of(trace, compiled, verify(trace, compiled)).road == expected
