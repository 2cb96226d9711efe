"""A long recording's parts are judged in several processes, and it comes out as from one."""

from functools import cache
from pathlib import Path

import pytest

import rulec
from rulec.batch import recording_judge
from rulec.batch.jobs import Jobs, LostTask
from rulec.batch.recording_judge import JudgedRecording, JudgeSettings, judged_file
from rulec.diagnostics import RulecError
from rulec.extraction import recording_parts
from rulec.extraction.recording_parts import egos_of
from rulec.extraction.selection import RequestedDrives
from rulec.recordings.recording_files import read_recording
from rulec.recordings.recording_format import RecordingSource
from rulec.report.verdicts.recording_answer import AnswerLayout
from rulec.report.verdicts.recording_json import as_json
from rulec.rulebook.loader import parse_rulebook
from support.worlds.stored import StoredWorld

BOOK = """
rulebook few
extends schemas
traffic right
hard rule slow { require always (speed <= 40 km/h) }
soft rule forwards { require never drives_against_traffic }
hard rule apart (u: road_user) { require always (gap(u) >= 8 m) }
"""


@pytest.fixture(scope="module")
def rules():
    return rulec.compile_rulebook(parse_rulebook(BOOK), step_s=0.2)


@cache
def some_egos():
    world = StoredWorld("priority")
    return egos_of(read_recording(RecordingSource(world.data, world.net)))[:4]


def pieces(rules, jobs, to_explain, **more):
    world = StoredWorld("priority")
    settings = JudgeSettings(
        rules,
        RequestedDrives(some_egos()),
        RecordingSource(Path("-"), world.net),
        to_explain=to_explain,
        every_part=False,
        layout=AnswerLayout(80),
        findings=True,
        to_line=as_json,
    )
    counted = []

    def tell(*numbers):
        counted.append(numbers)

    found = list(judged_file(settings, str(world.data), tell, jobs, **more))
    return found, counted


def each_alone(monkeypatch):
    """Let each ego be a part, as in recordings of hours."""
    monkeypatch.setattr(recording_parts, "MOST_CELLS", 1)
    monkeypatch.setattr(recording_parts, "MOST_TIMES_ALONE", 0)


@pytest.mark.parametrize("to_explain", [0, 3])
def test_parts_are_put_together(rules, to_explain, monkeypatch):
    usual, _ = pieces(rules, Jobs(1), to_explain)
    whole = usual[-1]
    assert isinstance(whole, JudgedRecording)
    assert whole.tally.drives["violated"]
    assert bool(whole.explained) == (to_explain > 0)
    each_alone(monkeypatch)
    asked = []

    def here(work, tasks, jobs, tell, lost):
        asked.append(jobs)
        for done, task in enumerate(tasks, 1):
            for result in work(task):
                yield task, result
            tell(done)

    monkeypatch.setattr(recording_judge, "in_order", here)
    found, counted = pieces(rules, Jobs(2, alone_s=1.0), to_explain)
    # A part takes longer than that: other processes get all of them at once
    assert asked == [Jobs(2, alone_s=0.0)]
    assert len(counted) >= 3
    assert found == usual


def test_parts_in_processes(rules, monkeypatch):
    usual, _ = pieces(rules, Jobs(1), 1)
    each_alone(monkeypatch)
    found, counted = pieces(rules, Jobs(2), 1)
    assert len(counted) >= 2
    assert found == usual


def test_a_part_whose_process_is_killed_twice(rules, monkeypatch):
    each_alone(monkeypatch)

    def killed(work, tasks, jobs, tell, lost):
        lost(tasks[0], 9)
        yield tasks[0], LostTask(9)

    monkeypatch.setattr(recording_judge, "in_order", killed)
    told = []
    (error,), _ = pieces(rules, Jobs(2), 0, lost=told.append)
    assert told == [9]
    assert isinstance(error, RulecError)
    assert [one.code for one in error.diagnostics] == ["R0708"]
