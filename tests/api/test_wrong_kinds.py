"""What is given of the wrong kind is said at the door, with what to give instead."""

from dataclasses import replace
from fractions import Fraction
from functools import reduce
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import rulec
from rulec.cli.main import main
from rulec.diagnostics.argument_names import for_caller

TRACE = rulec.Trace("t", 1.0, {}, ({"CONGESTED": True},))
FOLLOWING = "docs/samples/following.xml"
SLIP = rulec.Assumptions(values={"CONG": True})
SLIPPED = rulec.RequestedDrives(assumed={"CONG": True})


@pytest.mark.parametrize(
    ("call", "error", "said"),
    [
        (lambda: rulec.compile_rulebook(None), TypeError, "a Rulebook, not NoneType"),
        (lambda: rulec.verify(TRACE, 3), TypeError, "a Rulebook, not int"),
        (lambda: rulec.verify_many("a.jsonl", "esterle2019"), TypeError, "read_traces"),
        (
            lambda: rulec.verify_many(TRACE, "esterle2019"),
            TypeError,
            "iterable of Trace, not Trace",
        ),
        (lambda: rulec.find("CONGESTED", [TRACE], TRACE), TypeError, "a str or a path, not Trace"),
        (lambda: rulec.find("CONGESTED", {"track": [1]}), TypeError, "not dict: .*from_columns"),
        (lambda: rulec.TrafficWorld(FOLLOWING), TypeError, "read_recording"),
        (lambda: rulec.score([], None, "esterle2019"), TypeError, "a TrafficWorld, not NoneType"),
        (lambda: rulec.rates_of_findings("a", by="raod"), ValueError, "country, road, .*'raod'"),
        (lambda: rulec.rates_of_findings("a", confidence=95), ValueError, "0.95, not 95"),
        (lambda: rulec.write_monitor("esterle2019", "a", language="java"), ValueError, "'java'"),
        (lambda: rulec.draw_drive(FOLLOWING, "de", form="gif"), ValueError, "not 'gif'"),
        (lambda: rulec.load_rulebook("de", at="yesterday"), ValueError, "no day such as"),
        (lambda: rulec.verify(TRACE, "esterle2019", {"ends": 1}), TypeError, "Assumptions, not"),
        (lambda: rulec.verify_many([TRACE], "esterle2019", {}), TypeError, "Assumptions, not dict"),
        (lambda: rulec.find_maneuvers("s2", "de", assumptions="cut"), TypeError, "not str"),
        (lambda: rulec.verify_recording(FOLLOWING, "de", {}), TypeError, "RequestedDrives, not"),
        (lambda: rulec.find("CONGESTED", FOLLOWING, wanted={}), TypeError, "RequestedDrives, not"),
        (lambda: rulec.draw_drive(FOLLOWING, "de", wanted="1"), TypeError, "RequestedDrives, not"),
        (lambda: rulec.draw("x"), TypeError, "Maneuvers or a Trace, not str: rulec.nav"),
        (lambda: rulec.draw_drive(FOLLOWING, "de", only=["nope"]), ValueError, "no such rule"),
        (lambda: rulec.read_recording(FOLLOWING, form="xml"), ValueError, "tracks.*, not 'xml'"),
        (lambda: rulec.verify(TRACE, "esterle2019", SLIP), rulec.RulecError, "`values`.*`CONG`"),
        (lambda: rulec.verify_many([], "esterle2019", SLIP), rulec.RulecError, "`CONG`"),
        (
            lambda: rulec.find_maneuvers("s2", "esterle2019", assumptions=SLIP),
            rulec.RulecError,
            "`CONG`",
        ),
        (
            lambda: rulec.find("CONGESTED", [TRACE], "esterle2019", SLIPPED),
            rulec.RulecError,
            "`CONG`",
        ),
        (lambda: rulec.draw_drive(FOLLOWING, "de", at_s=6), rulec.RulecError, "no state at 6 s"),
        (lambda: rulec.Assumptions(ends="maybe"), ValueError, "not 'maybe'"),
        (lambda: rulec.Assumptions(values="built_up"), TypeError, "`values` is a dict, not str"),
        (lambda: rulec.Thresholds(near_m=-1), ValueError, "`near_m` is a number from 0 .*not -1"),
        (lambda: rulec.Thresholds(near_m="1"), ValueError, "not '1'"),
        (lambda: rulec.Thresholds(near_m=float("nan")), ValueError, "not nan"),
    ],
)
def test_a_wrong_kind_is_said(call, error, said):
    with pytest.raises(error, match=said):
        call()


def test_one_alone_is_as_good_as_a_list():
    one = rulec.diff("esterle2019", "esterle2019", patterns="R1")
    assert [pair.name for pair in one.pairs] == ["R1"]
    assert rulec.RequestedDrives(egos="12").egos == rulec.RequestedDrives(egos=[12]).egos == ("12",)


def test_a_rulebook_in_memory_is_written_in_ltl(tmp_path):
    book = rulec.parse_rulebook("rulebook a signal p hard rule r { require never p }")
    assert next(path.name for path in rulec.write_ltl(book, tmp_path)) == "a.csv"


NAN = float("nan")
RULES = rulec.compile_rulebook("esterle2019")
DRIVEN = rulec.read_recording(FOLLOWING)
VIOLATED = rulec.Violation("R9", "hard", {}, 0)
LINE = [(0, 0), (9, 0)]
TRACKS = {"track": [1, 1], "t": [0, 1], "x": [0, 1], "y": [0, 0]}
DEEP = reduce(lambda inner, _: [inner], range(3000), [])
PASSING = next(rulec.read_traces("docs/samples/traces.jsonl"))


def traced(**changes):
    given = {"id": "t", "step_s": 1.0, "objects": {}, "states": ({"CONGESTED": True},)} | changes
    return rulec.Trace(**given)


class OwnPath:
    """A path of another library's."""

    def __fspath__(self):
        return FOLLOWING


class BytesPath(OwnPath):
    def __fspath__(self):
        return b"a"


def test_paths_may_be_those_of_other_libraries():
    found = rulec.verify_recording(OwnPath(), "esterle2019")
    assert len(found.recording.participants) == len(DRIVEN.participants)


def test_traces_of_any_step_are_drawn():
    plain, fraction, huge = (
        rulec.draw(replace(PASSING, step_s=step_s), RULES)
        for step_s in (0.5, Fraction(1, 2), 1e308)
    )
    assert fraction == plain != huge


def built(lane=None, body=None):
    lanelet = replace(rulec.build_lanelet("a", LINE), **lane or {})
    one = rulec.build_participant("p", "car", [0], [0], [0], step_s=1)
    return rulec.build_recording([lanelet], [replace(one, **body or {})], step_s=1)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"objects": None}, "`objects` is a dict keyed by names of objects, not NoneType"),
        ({"objects": [1]}, "`objects` is a dict keyed by names of objects, not list"),
        ({"objects": {"v": [1]}}, "object `v` is of type `\\[1\\]`"),
        ({"states": None}, "`states` is a tuple of states, not NoneType"),
        ({"states": "ab"}, "`states` is a tuple of states, not str"),
        ({"states": ({1: 2},)}, "state 0"),
        ({"step_s": "1"}, "`step_s` is a number of seconds, not str"),
        ({"step_s": NAN}, "`step_s` is nan"),
        ({"present": 3}, "`present` is a dict keyed by names of objects, not int"),
        ({"objects": {"v": "vehicle"}, "present": {"v": 3}}, "two states for `v`.* not 3"),
        ({"step_s": 10**400}, "`step_s` is 1000.*; it has to be a number of seconds"),
        ({"id": 3}, "`id` is a str, not int"),
        ({"ends": np.array([])}, "`ends` is complete or cut"),
        ({"told": ["CONGESTED"]}, "`told` is a frozenset of names, not list"),
    ],
)
def test_what_is_no_trace_is_said(changes, said):
    trace = traced(**changes)
    with pytest.raises(rulec.RulecError, match=said):
        rulec.verify(trace, RULES)
    (together,) = rulec.verify_many([trace], RULES)
    assert isinstance(together, rulec.NotJudged)
    with pytest.raises(rulec.RulecError, match=said):
        raise together.error


@pytest.mark.parametrize(
    ("call", "error", "said"),
    [
        (lambda: rulec.parse_rulebook(None), TypeError, "`text` is a str, not NoneType"),
        (lambda: rulec.check("de", 3), TypeError, "`references` is a str or a path, not int"),
        (lambda: rulec.list("books"), ValueError, "rulebooks, vocabularies.* not 'books'"),
        (lambda: rulec.doc("esterle2019", language="it"), ValueError, "en, de, fr, not 'it'"),
        (lambda: rulec.doc("esterle2019", form="pdf"), ValueError, "'html', 'markdown', not 'pdf'"),
        (lambda: rulec.Session(search_path="books"), TypeError, "iterable of str, not str"),
        (lambda: rulec.Session(search_path=[3]), TypeError, r"`search_path\[0\]` is a str or a p"),
        (lambda: rulec.compile_rulebook("de", step_s=NAN), ValueError, "finite number, not nan"),
        (lambda: rulec.write_traces([TRACE, 1], "a.jsonl"), TypeError, r"`traces\[1\]` is a Trace"),
        (lambda: next(rulec.verify_many(iter([1]), RULES)), TypeError, r"`traces\[0\]` is a Trace"),
        (lambda: rulec.explain(VIOLATED, PASSING, RULES), ValueError, "esterle2019 has no rule"),
        (lambda: rulec.TrafficWorld(DRIVEN, "1", "2"), TypeError, "`now_s` is a number, not str"),
        (
            lambda: rulec.TrafficWorld(DRIVEN, "1", NAN),
            ValueError,
            "`now_s` is a finite number, not nan",
        ),
        (lambda: rulec.TrafficWorld(DRIVEN, "1", 1e308), rulec.RulecError, "nobody is recorded"),
        (lambda: rulec.TrafficWorld(DRIVEN, 1), TypeError, "`ego` is a str, not int"),
        (lambda: rulec.RequestedDrives(None), TypeError, "`egos` is .*not NoneType"),
        (lambda: rulec.Monitor(RULES).past("v"), TypeError, "`objects` is a dict, not str"),
        (
            lambda: rulec.Monitor(RULES).step({}, {}, "a.jsonl"),
            TypeError,
            "`place` is a SourceLocation, not str",
        ),
        (
            lambda: rulec.envelope(rulec.navigation_graph("s2"), pd.Series(["a"])),
            TypeError,
            r"`nodes\[0\]` is a whole number, not str",
        ),
        (lambda: rulec.Session(search_path=pd.Series([1])), TypeError, r"`search_path\[0\]` is a"),
        (lambda: rulec.Interval("1", 2), TypeError, "`low` is a number, not str"),
        (lambda: rulec.Monitor.restore("de", {}), TypeError, "CompiledRulebook, not str"),
        (lambda: rulec.layout_of([None]), ValueError, "whole numbers, such as"),
        (lambda: rulec.navigation_graph(3), TypeError, "`scenario` is .*not int"),
        (lambda: rulec.navigation_graph("s2", step_s="1"), TypeError, "`step_s` is a number"),
        (lambda: rulec.find_maneuvers("s2", RULES).cheapest(-1), ValueError, "not -1"),
        (lambda: rulec.find_maneuvers("s2", RULES).verdict(3), TypeError, "cheapest.1. has one"),
        (lambda: rulec.traces("s2", limit=-1), ValueError, "at most, not -1"),
        (
            lambda: rulec.draw_drive(DRIVEN, "de", at_s=NAN),
            ValueError,
            "`at_s` is a finite number, not nan",
        ),
        (lambda: rulec.recording_from_columns(None, {}), rulec.RulecError, "of type `NoneType`"),
        (lambda: rulec.build_recording([1], [], step_s=1), TypeError, r"`lanelets\[0\]` is a Lan"),
        (lambda: built(lane={"successors": 3}), TypeError, "`successors` is a tuple, not int"),
        (lambda: built(lane={"foes": "b"}), TypeError, "`foes` is a frozenset, not str"),
        (lambda: built(body={"states": [1]}), TypeError, "`states` is a dict, not list"),
        (lambda: built(body={"states": {0: 1}}), TypeError, r"`states\[0\]` is a TrackState, not"),
        (
            lambda: rulec.verify(traced(place="a.jsonl"), RULES),
            TypeError,
            "`place` is a SourceLocation, not str",
        ),
        (
            lambda: rulec.verify(traced(told=3), RULES, rulec.Assumptions(ends="cut")),
            rulec.RulecError,
            "`told` is a frozenset of names, not int",
        ),
        (lambda: rulec.show("esterle2019", "R1", width=0), ValueError, "columns or more, not 0"),
        (lambda: RULES.at_step(None), TypeError, "`step_s` is a Fraction or a number, not None"),
        (
            lambda: rulec.find_maneuvers("s2", RULES).ranked(np.ma.array([1, 2])),
            TypeError,
            "`n` is a whole number, not MaskedArray",
        ),
        (lambda: rulec.read_map(BytesPath(), 1), TypeError, "`path` is a str or a path, not Byt"),
        (lambda: rulec.build_lanelet("a", [(0, 0), (9, 0)], [[1], []]), rulec.RulecError, "width"),
        (lambda: rulec.verify_recording("a" * 5000, "de"), rulec.RulecError, "too long"),
        (lambda: rulec.write_traces([traced(id="\ud800")], "a"), rulec.RulecError, "surrogate"),
        (lambda: rulec.write_traces([traced(id="\ud800")], "a.csv"), rulec.RulecError, "surrogate"),
        (
            lambda: rulec.write_traces([traced(states=({"CONGESTED": Path("a")},))], "a"),
            rulec.RulecError,
            "state 0: `CONGESTED` is .* no file can hold",
        ),
        (lambda: rulec.analyze("esterle2019", spread=3), TypeError, "`spread` is a function"),
        (lambda: rulec.compile_rulebook("de", step_s=10**400), ValueError, "beyond all floats"),
        (lambda: rulec.compile_rulebook("de", step_s=[1]), TypeError, "`step_s` is a Fraction"),
        (lambda: rulec.compile_rulebook("/".join("a" * 2500)), rulec.RulecError, "too long"),
        (lambda: next(rulec.find("speed > 1 m/s", "a" * 5000, "de")), rulec.RulecError, "too long"),
        (lambda: rulec.read_map("a" * 5000, 0.1), rulec.RulecError, "too long"),
        (lambda: rulec.recording_from_columns(TRACKS, "a" * 5000), rulec.RulecError, "too long"),
        (lambda: next(rulec.verify_many(range(2), RULES)), TypeError, r"`traces\[0\]` is a Trace"),
        (lambda: rulec.diff("de", "de", paired={"a": {}}), TypeError, r"`paired.values\(\)\[0\]`"),
        (
            lambda: rulec.write_monitor(RULES, "a", {1: 2}),
            TypeError,
            r"`objects.keys\(\)\[0\]` is a str, not int",
        ),
        (lambda: rulec.navigation_graph("s2", step_s=10**400), rulec.RulecError, "the step is"),
        (lambda: rulec.find_maneuvers("s2", RULES, partition=[]), TypeError, "`partition` is a st"),
        (lambda: rulec.build_lanelet("a", LINE, successors=3), TypeError, "`successors` is an it"),
        (lambda: rulec.build_lanelet("a", [(0, 0), (10**400, 0)]), rulec.RulecError, "no number"),
        (
            lambda: rulec.build_participant("a", "car", [0], [0], [0], step_s=1, lamps=3),
            TypeError,
            "`lamps` is a dict, not int",
        ),
        (
            lambda: rulec.write_traces([traced(objects={"v": 3})], "a.parquet"),
            rulec.RulecError,
            "`objects` has names and types, not 'v' and 3",
        ),
        (
            lambda: rulec.build_participant(
                "a", "car", [0], [0], [0], step_s=1, lamps={"brake_light": 3}
            ),
            TypeError,
            r"`lamps\['brake_light'\]` is an iterable of bool, not int",
        ),
        (lambda: rulec.Choice(at_s="3"), TypeError, "`at_s` is a number, not str"),
        (lambda: rulec.Choice(at_s=NAN), ValueError, "`at_s` is a finite number, not nan"),
        (lambda: rulec.Choice(scenario_id=3), TypeError, "`scenario_id` is a str, not int"),
        (lambda: rulec.RecordingSource("a.xml"), TypeError, "`path` is a path, not str"),
        (lambda: rulec.layout_of(np.array(["2020"], "M8[s]")), ValueError, "whole numbers, such"),
        (
            lambda: rulec.verify_columns(rulec.TraceColumns(rulec.layout_of([1]), 3), RULES),
            TypeError,
            "`values` is a dict, not int",
        ),
        (
            lambda: rulec.recording_from_columns(dict.fromkeys(("track", *"txy"), DEEP), {}),
            rulec.RulecError,
            "`t` is no row of values",
        ),
    ],
)
def test_it_is_said_which_argument_is_wrong(call, error, said, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(error, match=said):
        call()
    assert not [*tmp_path.iterdir()]


def test_sequences_may_be_iterators_and_arrays():
    for folders in (iter(["docs/samples"]), np.array(["docs/samples"])):
        session = rulec.Session(search_path=folders)
        assert session.search_path == ("docs/samples",)
    both = rulec.diff("esterle2019", "esterle2019", patterns=np.array([], dtype=str))
    assert len(both.pairs) == 3


def test_what_an_error_says_can_be_printed():
    with pytest.raises(rulec.RulecError) as error:
        rulec.load_rulebook("\ud800.rules")
    assert str(error.value).encode()


@pytest.mark.parametrize(
    "use",
    [
        lambda trace, _: rulec.explain(VIOLATED, trace, RULES),
        lambda trace, _: rulec.draw(trace, RULES),
        lambda trace, folder: rulec.write_traces([trace], folder / "a.jsonl"),
    ],
)
@pytest.mark.parametrize("changes", [{"states": 3}, {"present": 3}, {"told": 3}, {"step_s": None}])
def test_what_is_no_trace_is_neither_explained_nor_drawn_nor_written(use, changes, tmp_path):
    with pytest.raises(rulec.RulecError, match=f"`{next(iter(changes))}` is "):
        use(traced(**changes), tmp_path)


def test_numbers_of_numpy_are_written(tmp_path):
    trace = traced(step_s=np.float64(0.5), states=({"speed": np.float64(2.5)},))
    for name in ("a.jsonl", "a.csv"):
        rulec.write_traces([trace], tmp_path / name)
        (read,) = rulec.read_traces(tmp_path / name)
        assert (read.step_s, read.states[0]["speed"]) == (0.5, 2.5)


@pytest.mark.parametrize(
    "call",
    [
        lambda: rulec.Thresholds(near_m=DEEP),
        lambda: rulec.verify(traced(objects={"v": DEEP}), RULES),
        lambda: rulec.verify(traced(present={"v": DEEP}), RULES),
        lambda: rulec.build_lanelet("a", LINE, left_mark=DEEP),
    ],
)
def test_what_is_deep_is_named_in_short(call):
    with pytest.raises((TypeError, ValueError, rulec.RulecError)) as error:
        call()
    assert len(str(error.value)) < 300


def test_options_are_told_as_arguments(tmp_path, capsys):
    """Of words in backquotes only those that are an option: a whole command stays one."""
    roads = "docs/samples/passing.net.xml"
    with pytest.raises(rulec.RulecError) as caught:
        rulec.read_recording(FOLLOWING, roads)
    error = caught.value
    said = "leave out `map_path`, which is for recordings without roads of their own"
    assert (error.diagnostics[0].help, str(error).splitlines()[1:]) == (said, [f"help: {said}"])
    assert main(["verify", FOLLOWING, "-r", "esterle2019", "--map", roads]) == 2
    assert "leave out --map, which" in capsys.readouterr().err
    told = {
        "take `--extent body`, `--step 0.5` or another --ego": 'take `extent="body"`, '
        "`step_s=0.5` or another `ego`",
        "name the map with --map FILE": "name the map with `map_path`",
        "add `--input-format csv`": "let its name end in `.csv`",
        "`rulec compile --step 1`, --fcd-output.geo": "`rulec compile --step 1`, --fcd-output.geo",
    }
    assert {text: for_caller(text) for text in told} == told
