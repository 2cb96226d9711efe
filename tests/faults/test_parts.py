"""A file, a candidate or a rulebook raises: it is named, and the others are answered."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import rulec
from rulec.api.rulebook_compilation import machines
from rulec.cli.commands.traffic.fleet import command as fleet
from rulec.cli.main import main
from rulec.diagnostics import RulecError
from rulec.recordings import map_files, recording_files
from rulec.scenario import scenario_files
from rulec.scoring.score import score
from support.builders.scored_worlds import street

GERMAN = machines("de")
SAMPLE = Path("docs/samples/following.xml").resolve()
TRACES = Path("docs/samples/traces.jsonl").resolve()
BAD = ("f03.xml", "f11.xml", "f19.xml")


@pytest.fixture
def twenty(tmp_path, monkeypatch):
    """A folder of 20 recordings, of which the reader of three raises."""
    for number in range(20):
        shutil.copy(SAMPLE, tmp_path / f"f{number:02}.xml")
    form_of = recording_files._format_of

    def broken(source):
        if source.path.name in BAD:
            raise KeyError("planted")
        return form_of(source)

    monkeypatch.setattr(recording_files, "_format_of", broken)
    return tmp_path


def test_a_fleet_of_twenty_of_which_three_raise(twenty, tmp_path, capsys):
    folder = tmp_path / "findings"
    words = [str(twenty), "-r", "de", "-o", str(folder), "-j", "1"]
    # Without the limit of memory of a whole call, which is for a process of its own
    assert fleet.main(words, standalone_mode=False) == 2
    out, err = capsys.readouterr()
    assert "Traceback" not in out + err
    assert "102 judged" in out  # 6 drives in each of 17
    parquet = pytest.importorskip("pyarrow.parquet")
    rows = [
        row for file in folder.rglob("*.parquet") for row in parquet.read_table(file).to_pylist()
    ]
    judged = {Path(row["file"]).name for row in rows if row["kind"] == "finding"}
    lost = {
        Path(row["file"]).name: row["because"]
        for row in rows
        if row["outcome"] == "not_judged" and "a fault of rulec" in row["because"]
    }
    assert len(judged) == 17
    assert sorted(lost) == [*BAD]
    assert "not read: a fault of rulec" in out
    assert "KeyError 'planted'" in lost[BAD[0]]


@pytest.mark.parametrize("form", ["junit", "sarif", "json"])
def test_twenty_files_are_verified_of_which_three_raise(twenty, tmp_path, capsys, form):
    to = {"junit": "f.xml", "sarif": "f.sarif", "json": "f.jsonl"}[form]
    findings = tmp_path / "out" / to
    findings.parent.mkdir()
    assert main(["verify", str(twenty), "-r", "de", "-j", "1", "-o", str(findings)]) == 2
    err = capsys.readouterr().err
    text = findings.read_text()
    for name in BAD:
        assert name in err
        assert name in text
    assert text.count("a fault of rulec") >= 3
    assert "KeyError 'planted'" in err


def test_the_drives_of_a_recording_are_answered_though_one_cannot_be_reported(monkeypatch, capsys):
    from rulec.batch.recording_judge import _RecordingJudge

    explained = _RecordingJudge._explained

    def broken(self, result):
        if result.drive.ego == "1":
            raise AssertionError("planted")
        return explained(self, result)

    monkeypatch.setattr(_RecordingJudge, "_explained", broken)
    assert main(["verify", str(SAMPLE), "-r", "de", "--json"]) == 2
    out, err = capsys.readouterr()
    lines = list(map(json.loads, out.splitlines()))
    assert len(lines) == 6
    (lost,) = [line for line in lines if "why_not" in line]
    assert lost["trace"] == "1"
    assert "AssertionError planted" in lost["why_not"]
    assert "drive of `1`" in err


@pytest.mark.parametrize("number", range(len(recording_files.FORMATS)))
def test_each_reader_of_recordings(monkeypatch, number):
    def broken(_):
        raise IndexError("planted")

    form = recording_files.FORMATS[number]
    planted = replace(form, recognises=lambda _: True, read=broken)
    monkeypatch.setattr(recording_files, "FORMATS", (planted,))
    with pytest.raises(RulecError) as caught:
        rulec.read_recording(SAMPLE)
    (found,) = caught.value.diagnostics
    assert found.code == "R0790"
    assert found.place.file == str(SAMPLE)
    assert "IndexError planted; broken" not in found.message  # that is no function of rulec
    assert "recording_files.py" in found.message


@pytest.mark.parametrize("number", range(len(map_files.MAP_FORMATS)))
def test_each_reader_of_maps(monkeypatch, number):
    def broken(*_):
        raise IndexError("planted")

    planted = replace(map_files.MAP_FORMATS[number], recognises=lambda _: True, read=broken)
    monkeypatch.setattr(map_files, "MAP_FORMATS", (planted,))
    with pytest.raises(RulecError, match="IndexError planted"):
        rulec.read_map(SAMPLE, 0.5)


def test_the_readers_of_scenarios_and_traces(monkeypatch):
    def broken(*_, **__):
        raise RecursionError("planted")

    monkeypatch.setattr(scenario_files, "to_scenario", broken)
    monkeypatch.setattr("rulec.trace.formats.json_lines.read_chunks", broken)
    with pytest.raises(RulecError, match="RecursionError"):
        rulec.load_scenario("s1")
    with pytest.raises(RulecError, match="RecursionError"):
        list(rulec.read_traces(TRACES))


def futures(world, number=20):
    x, y, heading, _ = world.past[-1]
    speeds = 6.0 + 0.5 * np.arange(number)
    t = 0.5 * np.arange(1, 11)
    flat = 0 * t
    return np.array(
        [np.column_stack((x + v * t, y + flat, heading + flat, v + flat)) for v in speeds]
    )


def check_nineteen_are_scored(broken_one, before, after, is_whole):
    for number, (known, own) in enumerate(zip(before.candidates, after.candidates, strict=True)):
        if number == broken_one:
            assert own.faults
            assert not after.allowed[number]
            assert own.is_judged != is_whole
        else:
            assert not own.faults
            assert own == known
            assert after.allowed[number] == before.allowed[number]


def test_of_twenty_candidates_one_raises(monkeypatch):
    from rulec.scoring import score as home

    world = street(speed=10.0)
    paths = futures(world)
    before = score(paths, world, GERMAN, world.past)
    bodies_along = type(world).bodies_along

    def broken(self, own, past):
        if (own[:, 0, 3] == paths[7, 0, 3]).any():
            raise ZeroDivisionError("planted")
        return bodies_along(self, own, past)

    monkeypatch.setattr(home.TrafficWorld, "bodies_along", broken)
    after = score(paths, world, GERMAN, world.past)
    check_nineteen_are_scored(7, before, after, is_whole=True)
    assert "candidate 7: a fault of rulec" in after.candidates[7].why
    assert after.violated_before == before.violated_before
    assert after.places[7] == max(after.places)
    assert after.best != 7


def test_of_twenty_candidates_one_loses_a_word(monkeypatch):
    from rulec.extraction.traces.to_trace import _WORDS

    world = street(speed=10.0)
    paths = futures(world)
    before = score(paths, world, GERMAN, world.past)
    words = next(words for words in _WORDS._definitions if "lane_change" in words)
    computed = _WORDS._definitions[words]
    fastest = paths[-1, -1, 0]

    def broken(context):
        if (context.ego.x > fastest - 0.5).any():
            raise ZeroDivisionError("planted")
        return computed(context)

    monkeypatch.setitem(_WORDS._definitions, words, broken)
    monkeypatch.setattr(_WORDS, "_read", {})
    after = score(paths, world, GERMAN, world.past)
    check_nineteen_are_scored(19, before, after, is_whole=False)
    lost = {rule.rule for rule in after.candidates[19].lost}
    assert "changing_lanes" in lost


def test_what_raises_only_for_several_candidates_is_said_once(monkeypatch):
    from rulec.scoring import score as home

    world = street(speed=10.0)
    paths = futures(world, 3)
    before = score(paths, world, GERMAN, world.past)
    charges = home._charges

    def broken(block, *others):
        if len(block) > 1:
            raise ValueError("planted")
        return charges(block, *others)

    monkeypatch.setattr(home, "_charges", broken)
    after = score(paths, world, GERMAN, world.past)
    assert list(after.candidates) == list(before.candidates)
    assert [len(one.faults) for one in after.candidates] == [1, 0, 0]


def raising(function, is_bad):
    def broken(*given, **more):
        if is_bad(*given, **more):
            raise KeyError("planted")
        return function(*given, **more)

    return broken


def both(tmp_path, source, names=("bad", "good")):
    return [str(shutil.copy(source, tmp_path / f"{name}{source.suffix}")) for name in names]


BOOK = """rulebook {name}
use paper

hard rule right (v: vehicle) {{
  cite "Article 1"
  says "Nobody on the right."
  require never r(v)
  accept {{ l(v) }}
  reject {{ r(v) }}
}}
"""


def books(tmp_path):
    files = []
    for name in ("bad", "good"):
        file = tmp_path / f"{name}.rules"
        file.write_text(BOOK.format(name=name))
        files.append(str(file))
    return files


def of(name):
    return lambda *given, **more: any(name in str(x) for x in (*given, *more.values()))


VERBS = {
    "verify": (
        ["verify", "-r", "esterle2019"],
        TRACES,
        "rulec.trace.formats.json_lines.read_chunks",
        "violated",
    ),
    "find": (
        ["find", "lane_change"],
        SAMPLE,
        "rulec.extraction.moment_search.selected_drives",
        "0 moments, in 0 of 6 drives",
    ),
    "check": (["check"], None, "rulec.rulebook.batch.batch_check._findings", ""),
    "test": (["test"], None, "rulec.batch.example_batch.run_examples", "2 examples passed"),
}


@pytest.mark.parametrize("verb", VERBS)
def test_each_verb_of_several_files(monkeypatch, tmp_path, capsys, verb):
    words, source, chokepoint, says = VERBS[verb]
    files = books(tmp_path) if source is None else both(tmp_path, source)
    module, _, name = chokepoint.rpartition(".")
    function = getattr(__import__(module, fromlist=[name]), name)
    monkeypatch.setattr(chokepoint, raising(function, of("bad.")))
    assert main([*words, *files]) == 2
    out, err = capsys.readouterr()
    assert "KeyError 'planted'" in err
    assert "bad" in err
    assert says in out
    assert "Traceback" not in out + err


def test_maneuvers_of_several_scenes(monkeypatch, capsys):
    import rulec.planning

    bad = raising(rulec.planning.evaluate, lambda graph, *_: graph.scenario.name == "s1")
    monkeypatch.setattr(rulec.planning, "evaluate", bad)
    assert main(["maneuvers", "s1", "s3", "-r", "esterle2019"]) == 2
    out, err = capsys.readouterr()
    assert "s1" in err
    assert "not evaluated: a fault of rulec" in err
    assert "s3" in out


def test_pictures_and_rates(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr("rulec.api.pictures.drive_drawing", raising(None, lambda *_: True))
    picture = str(tmp_path / "d.svg")
    assert main(["draw", "drive", str(SAMPLE), "-r", "de", "-o", picture]) == 2
    assert "not drawn: a fault of rulec" in capsys.readouterr().err
    monkeypatch.setattr(
        "rulec.rates.rule_rates.rates_of_findings", raising(None, lambda *_, **__: True)
    )
    assert main(["rates", str(tmp_path)]) == 2
    assert "no rates: a fault of rulec" in capsys.readouterr().err


def test_a_fault_that_no_verb_reports_still_ends_with_2(monkeypatch, capsys):
    from rulec.diagnostics.fault_messages import fault_of

    callback = "rulec.cli.commands.reading.formats.command.callback"
    monkeypatch.setattr(callback, lambda **_: fault_of(KeyError("unsaid")))
    assert main(["list", "formats"]) == 2
    assert "KeyError 'unsaid'" in capsys.readouterr().err
