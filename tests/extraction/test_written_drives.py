"""Drives written as traces are judged as they are from the recording."""

import json

import pytest

from rulec.cli.main import main
from support.builders.recorded_cars import three_cars


@pytest.fixture
def road(tmp_path):
    # 4 follows 3 with a gap of 4 m at 14 m/s; 5 is far ahead
    return three_cars(tmp_path)


def verdicts(capsys, *arguments):
    status = main(["verify", *arguments, "--json"])
    lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    added = {"recording", "mirrored", "start_s", "step_s", "by_default", "time_s"}
    for line in lines:
        for violation in line["violations"]:
            del violation["time_s"], violation["by_default"], violation["evidence"]
    return status, [{k: v for k, v in line.items() if k not in added} for line in lines]


@pytest.mark.parametrize(
    ("book", "form"),
    [
        ("gb", "jsonl"),
        ("gb", "csv"),
        ("gb", "parquet"),
        ("nl", "csv"),
        ("esterle2019", "parquet"),
    ],
)
def test_the_same_verdicts(road, book, form, tmp_path, capsys):
    if form == "parquet":
        pytest.importorskip("pyarrow", reason="needs pyarrow: pip install 'rulec[parquet]'")
    status, expected = verdicts(capsys, road, "-r", book)
    file = tmp_path / f"drives.{form}"
    assert main(["maneuvers", "--traces", road, "--recorded", "-r", book, "-o", str(file)]) == 0
    assert capsys.readouterr().out == f"wrote 3 drives to {file}\n"
    main(["verify", str(file), "-r", book, "--json"])
    found = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert found == expected
    assert [line["trace"] for line in found] == ["3", "4", "5"]
    # 4 follows 3 with a gap of 4 m at 14 m/s. Where cutting in is borne for 3 s it takes a while
    # until it is known that 3, in the middle of its lane from the first state on, has not cut in
    broken = [violation["rule"] for violation in found[1]["violations"]]
    assert ("following_distance" in broken) == (book == "nl")
    assert status == (1 if book == "nl" else 0)


def test_one_ego(road, tmp_path, capsys):
    file = tmp_path / "drives.jsonl"
    assert main(["maneuvers", "--traces", road, "--recorded", "--ego", "4", "-o", str(file)]) == 0
    (line,) = file.read_text().splitlines()
    trace = json.loads(line)
    assert (trace["id"], trace["step_s"]) == ("4", 0.1)
    assert trace["objects"] == {"3": "car", "5": "car"}
    # Places are known to 0.05 m; the mean speed of half a second, 14 m/s, to 0.2 m/s
    assert trace["states"][0]["gap"] == {
        "3": {"from": 3.95, "to": 4.05},
        "5": {"from": 53.95, "to": 54.05},
    }
    assert trace["states"][0]["speed"] == {"from": 49.68, "to": 51.12}


def test_a_drive_can_be_drawn(road, tmp_path, capsys):
    file, picture = tmp_path / "drives.jsonl", tmp_path / "drive.svg"
    main(["maneuvers", "--traces", road, "--recorded", "-r", "esterle2019", "-o", str(file)])
    arguments = ["-r", "esterle2019", "--trace", "4", "-o", str(picture)]
    assert main(["draw", "trace", str(file), *arguments]) == 0
    assert ">position(3)<" in picture.read_text()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (
            ["maneuvers", "--traces", "FILE", "-o", "-", "--recorded", "--ego", "44"],
            "no vehicle `44` that drives",
        ),
        (
            ["maneuvers", "--traces", "FILE", "-o", "-", "--recorded", "--step", "1"],
            "--step is for maneuvers",
        ),
        (["maneuvers", "--traces", "FILE", "-o", "-", "--as-recorded"], "add --recorded"),
        (
            ["maneuvers", "--traces", "FILE", "-o", "-", "--recorded", "--assume", "wet=true"],
            "needs a rulebook",
        ),
        (["verify", "FILE", "-r", "vienna", "--ego", "5x"], "there is no vehicle `5x` that drives"),
        (
            ["verify", "FILE", "-r", "vienna", "--assume", "wet"],
            "not written as in `built_up=true`",
        ),
        (
            ["verify", "FILE", "-r", "vienna", "--assume", "wett=true"],
            "does not know `wett`; did you mean `wet`?",
        ),
        (["verify", "FILE", "-r", "vienna", "--assume", "wet=yes"], "`wet` is `true` or `false`"),
        (
            ["verify", "FILE", "-r", "vienna", "--assume", "light=rot"],
            "`light` is one of `no_light`",
        ),
        (["verify", "FILE", "-r", "vienna", "--assume", "limit=50 kg"], "number such as `50 km/h`"),
        (["verify", "FILE", "-r", "vienna", "--assume", "stopped=true"], "is about objects"),
        (["verify", "FILE", "-r", "vienna", "--threshold", "near=9"], "no threshold `near`"),
        (
            ["verify", "FILE", "-r", "vienna", "--threshold", "near_m=-9"],
            "a number from 0 to 1,000,000",
        ),
        (
            ["verify", "FILE", "-r", "vienna", "--threshold", "near_m=nan"],
            "a number from 0 to 1,000,000",
        ),
        (["verify", "FILE", "-r", "vienna", "--threshold", "fewest=2.5"], "a whole number"),
        (["verify", "docs/samples/traces.jsonl", "-r", "vienna", "--ego", "4"], "recorded traffic"),
    ],
)
def test_what_cannot_be(arguments, said, road, capsys):
    status = main([road if one == "FILE" else one for one in arguments])
    captured = capsys.readouterr()
    assert (status, captured.out) in ((2, ""), (2, "0 traces: 0 satisfied, 0 violated\n"))
    assert said in " ".join(captured.err.split())
