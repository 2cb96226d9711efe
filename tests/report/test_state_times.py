"""Beside the numbers of states stand their times, where a second apart is not all there is."""

import json

import pytest

from rulec.cli.main import main
from rulec.report.verdicts.state_times import StateTimes


@pytest.mark.parametrize(
    ("times", "one", "stretch"),
    [
        (StateTimes(), "", ""),
        (StateTimes(step_s=0.1), " (3.7 s)", " (3.7-4 s)"),
        (StateTimes(12.2, 0.04), " (13.68 s)", " (13.68-13.8 s)"),
        (StateTimes(100, 1), " (137 s)", " (137-140 s)"),
        (StateTimes(1e308, 1), "", ""),
        (StateTimes(step_s=1e308), "", ""),
        (StateTimes(step_s=1e-300), " (0 s)", " (0-0 s)"),
    ],
)
def test_times_have_no_more_digits_than_their_steps(times, one, stretch):
    assert times.of(37) == times.of(37, 37) == one
    assert times.of(37, 40) == stretch


@pytest.mark.parametrize(("step_s", "time"), [(0.5, " (1 s)"), (1, "")])
def test_traces_are_explained_with_times(step_s, time, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "slow.rules").write_text(
        "rulebook slow\nuse road\nhard rule slow { require never speed > 30 km/h }\n"
    )
    states = [{"speed": speed} for speed in (20, 30, 40, 20)]
    trace = {"id": "drive", "step_s": step_s, "objects": {}, "states": states}
    (tmp_path / "drive.jsonl").write_text(json.dumps(trace))
    assert main(["verify", "drive.jsonl", "-r", "slow.rules"]) == 1
    said = capsys.readouterr().out
    assert f"cannot be kept any more after state 2{time}\n" in said
    assert f"at state 2{time}: ego's speed is 40 km/h" in said
    assert f"kept if state 2{time} says: speed <= 30 km/h" in said
