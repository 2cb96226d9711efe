"""How a trace ends that a file contains: what it says, and what follows from a step in seconds."""

import csv
import json
from itertools import chain

import pytest

import rulec
from rulec.cli.main import main
from rulec.monitoring.batch.batch_verify import verify_items
from rulec.trace.formats.trace_files import read_chunks

pyarrow = pytest.importorskip("pyarrow")
parquet = pytest.importorskip("pyarrow.parquet")

BOOK = """\
rulebook late
type vehicle
signal siren, way_free default false
quantity gap(v: vehicle) in m
hard rule make_way {
  require always (siren implies eventually[<= 3 s] way_free)
  accept "the last state goes on" { siren; way_free }
  reject "complete, as examples are" { siren; not way_free }
}
hard rule fall_back (v: vehicle) {
  require always (gap(v) < 20 m implies eventually[<= 3 s] gap(v) >= 20 m)
}
hard rule no_crash (v: vehicle) { require always gap(v) > 1 m }
"""
STEP_S = 0.5
SITUATIONS = {
    "siren": [*[(False, 50)] * 19, (True, 50)],
    "cut_in": [*[(None, 50)] * 18, (None, 12), (None, 11)],
    "crash": [*[(None, 50)] * 19, (None, 0.5)],
    "nothing": [(False, 50)] * 20,
}
"""Whether there is a siren (None: nothing is said), and how large the gap is, for ten seconds."""

WHEN_COMPLETE = {
    "siren": "make_way: violated",
    "cut_in": "fall_back: violated",
    "crash": "fall_back: violated, no_crash: violated",
    "nothing": "",
}
WHEN_CUT = {
    "siren": "make_way: not over",
    "cut_in": "fall_back: not over",
    "crash": "no_crash: violated, fall_back: not over",
    "nothing": "",
}
ENDINGS = [
    # What the file says: seconds, an end; and how the trace ends then.
    (True, None, "cut"),
    (True, "cut", "cut"),
    (True, "complete", "complete"),
    (False, None, "complete"),
    (False, "cut", "cut"),
    (False, "complete", "complete"),
]


@pytest.fixture(scope="module")
def book(tmp_path_factory):
    path = tmp_path_factory.mktemp("late") / "late.rules"
    path.write_text(BOOK)
    return path


def states_of(situation):
    return [
        {"gap": {"a": gap}, **({} if siren is None else {"siren": siren})}
        for siren, gap in SITUATIONS[situation]
    ]


def as_json_lines(path, names, *, in_seconds, ends):
    with path.open("w") as text:
        for name in names:
            states = states_of(first_part(name))
            own = {"id": name, "objects": {"a": "vehicle"}, "states": states}
            own |= {"step_s": STEP_S} if in_seconds else {}
            own |= {"ends": ends} if ends else {}
            text.write(f"{json.dumps(own)}\n")


def rows(names, *, in_seconds, ends):
    head = ["trace", "step", "object", "type", "siren", "gap"]
    head += ["step_s"] * in_seconds + ["ends"] * (ends is not None)
    yield head
    for name in names:
        for step, (siren, gap) in enumerate(SITUATIONS[first_part(name)]):
            seconds = [STEP_S] * in_seconds
            yield [name, step, None, None, siren, None, *seconds, *([ends] * (ends is not None))]
            yield [name, step, "a", "vehicle", None, float(gap), *seconds, *[None] * bool(ends)]


def as_csv(path, names, **more):
    with path.open("w", newline="") as text:
        for row in rows(names, **more):
            csv.writer(text).writerow([str(x).lower() if isinstance(x, bool) else x for x in row])


def as_parquet(path, names, **more):
    head, *rest = rows(names, **more)
    parquet.write_table(pyarrow.table(list(map(list, zip(*rest, strict=True))), head), path)


KINDS = {"jsonl": as_json_lines, "csv": as_csv, "parquet": as_parquet}


def first_part(name):
    return name.split("~")[0]


def in_short(verdict):
    violated = [f"{one.rule}: violated" for one in verdict.violations]
    return ", ".join([*violated, *(f"{one.rule}: {one.because[0]}" for one in verdict.open)])


@pytest.mark.parametrize("copies", [1, 40], ids=["few", "many"])
@pytest.mark.parametrize(("in_seconds", "said", "ends"), ENDINGS)
@pytest.mark.parametrize("kind", KINDS)
def test_what_happens_in_the_last_second(kind, in_seconds, said, ends, copies, book, tmp_path):
    path = tmp_path / f"t.{kind}"
    names = [f"{name}~{n}" for n in range(copies) for name in SITUATIONS]
    KINDS[kind](path, names, in_seconds=in_seconds, ends=said)
    assert {trace.ends for trace in rulec.read_traces(path)} == {ends}
    rules = rulec.compile_rulebook(book)
    expected = WHEN_CUT if ends == "cut" else WHEN_COMPLETE
    answers = list(rulec.verify_many(rulec.read_traces(path), rules))
    with path.open("rb") as stream:
        for items in read_chunks(stream, str(path), kind):
            answers += [one for _, some in verify_items(items, rules) for one in some]
    assert len(answers) == 2 * len(names)
    for verdict in answers:
        assert in_short(verdict) == expected[first_part(verdict.trace)]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(("option", "status"), [((), 0), (("--end", "complete"), 1)])
def test_the_program_is_told_that_it_was_over(kind, option, status, book, tmp_path, capsys):
    path = tmp_path / f"t.{kind}"
    KINDS[kind](path, ["siren", "cut_in"], in_seconds=True, ends=None)
    assert main(["verify", str(path), "-r", str(book), "--json", *option]) == status
    lines = list(map(json.loads, capsys.readouterr().out.splitlines()))
    assert [len(one["violations"]) for one in lines] == [status] * 2
    assert [len(one["open"]) for one in lines] == [1 - status] * 2


@pytest.mark.parametrize("kind", KINDS)
def test_cut_traces_that_are_judged_together_are_judged_as_alone(kind, book, tmp_path):
    rulebook = tmp_path / "usual.rules"
    rulebook.write_text(f"{BOOK}presumed way_free, siren\n")
    rules = rulec.compile_rulebook(rulebook)
    path = tmp_path / f"t.{kind}"
    KINDS[kind](path, [f"{name}~{n}" for n in range(20) for name in SITUATIONS], **SECONDS)
    alone = [rulec.verify(trace, rules) for trace in rulec.read_traces(path)]
    with path.open("rb") as stream:
        chunks = read_chunks(stream, str(path), kind)
        judged = [some for items in chunks for _, some in verify_items(items, rules)]
        together = list(chain.from_iterable(judged))
    assert {verdict.presumed for verdict in together} == {("way_free",), ("siren", "way_free")}
    assert together == alone
    assert [reasons(one) for one in together] == [reasons(one) for one in alone]


SECONDS = {"in_seconds": True, "ends": None}


def reasons(verdict):
    return [(one.because, one.depends_on, one.outcomes, one.exact) for one in verdict.open]


def test_assumptions_override_the_file(book, tmp_path):
    as_json_lines(tmp_path / "t.jsonl", ["siren"], in_seconds=True, ends=None)
    rules = rulec.compile_rulebook(book)
    (trace,) = rulec.read_traces(tmp_path / "t.jsonl")
    assert in_short(rulec.verify(trace, rules)) == WHEN_CUT["siren"]
    over = rulec.Assumptions(ends="complete")
    assert in_short(rulec.verify(trace, rules, over)) == WHEN_COMPLETE["siren"]


def test_a_trace_made_in_python_is_complete(book):
    rules = rulec.compile_rulebook(book)
    trace = rulec.Trace("t", STEP_S, {"a": "vehicle"}, tuple(states_of("siren")))
    assert in_short(rulec.verify(trace, rules)) == WHEN_COMPLETE["siren"]


def test_examples_in_rulebooks_are_complete(book):
    assert all(outcome.passed for outcome in rulec.test(book).outcomes)


@pytest.mark.parametrize("kind", KINDS)
def test_what_rulec_writes_says_how_it_ends(kind, tmp_path, capsys):
    path, again = tmp_path / f"t.{kind}", tmp_path / f"again.{kind}"
    assert (
        main(["maneuvers", "--traces", "s1", "--step", "1", "--first", "3", "-o", str(path)]) == 0
    )
    capsys.readouterr()
    ways = list(rulec.read_traces(path))
    assert [trace.ends for trace in ways] == ["complete"] * 3
    cut = [rulec.Trace("t", STEP_S, {}, ({"CONGESTED": True},), ends="cut"), *ways]
    rulec.write_traces(cut, again)
    assert list(rulec.read_traces(again)) == cut


def test_the_traces_of_a_comparison_are_complete(tmp_path, capsys):
    path = tmp_path / "t.jsonl"
    main(["diff", "de", "nl", "--rule", "bus_leaving", "--witness", str(path)])
    capsys.readouterr()
    assert {trace.ends for trace in rulec.read_traces(path)} == {"complete"}
