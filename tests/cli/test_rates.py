"""``rulec rates``: formats, choices and refusals."""

import csv
import io
import json
import re
from xml.etree import ElementTree

import pytest

from rulec.cli.main import main
from rulec.report.findings import findings_of_drives, findings_of_traces
from support.builders.recorded_cars import three_cars

SHARED = {"rulebook": "de", "rulebook_hash": "abcdefgh1", "rulec": "1.0", "file": "a.xml"}


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """Three drives of an hour; of 30 stop signs three were passed."""
    rows = []
    for vehicle, violated in (("v", 2), ("w", 1), ("x", 0)):
        own = {**SHARED, "vehicle": vehicle, "country": "DEU" if vehicle == "v" else "USA"}
        rows.append(
            {**own, "kind": "drive", "outcome": "kept", "duration_s": 3600.0, "distance_m": 5e4}
        )
        rule = {**own, "kind": "rule", "strength": "hard", "outcome": "kept"}
        own_counts = {"opportunities": 10, "violated": violated, "opportunities_s": 60.0}
        rows.append({**rule, "rule": "stop_sign", "provision": "§ 41", **own_counts})
        rows.append({**rule, "rule": "school_bus", "opportunities": 0, "violated": 0})
        rows.append({**rule, "rule": "zipper", "outcome": "not_judged"})
    path = tmp_path_factory.mktemp("rates") / "found.jsonl"
    path.write_text("".join(f"{json.dumps(row)}\n" for row in rows))
    return str(path)


def test_a_table_as_text(found, capsys):
    assert main(["rates", found]) == 0
    printed = capsys.readouterr().out
    lines = printed.splitlines()
    assert lines[0] == "rulebook de (abcdefgh), rulec 1.0"
    rows = [" ".join(line.split()) for line in lines if "stop_sign" in line]
    # Poisson's interval for 3 is 0.619 to 8.77, that of Clopper and Pearson for 3 of 30 2.11 to
    # 26.5 %.
    rates = "1 (0.206 to 2.92) 20 (4.12 to 58.4) 0.1 (0.0211 to 0.265)"
    assert rows == ["stop_sign [§ 41] 30 3", f"stop_sign [§ 41] {rates}"]
    assert max(map(len, lines)) <= 80
    assert "no opportunity: school_bus" in printed
    assert "not judged: zipper" in printed


def test_long_lists_of_rules_are_broken(tmp_path, capsys):
    names = [f"rule_with_quite_a_long_name_{number}" for number in range(20)]
    own = {**SHARED, "vehicle": "v", "strength": "hard", "outcome": "not_judged"}
    drive = {**own, "kind": "drive", "outcome": "kept", "duration_s": 3600.0, "distance_m": 5e4}
    rows = [drive, *({**own, "kind": "rule", "rule": name} for name in names)]
    path = tmp_path / "found.jsonl"
    path.write_text("".join(f"{json.dumps(row)}\n" for row in rows))
    assert main(["rates", str(path)]) == 0
    printed = capsys.readouterr().out
    assert max(map(len, printed.splitlines())) <= 100
    assert f"  not judged: {', '.join(names)}" in re.sub(r",\n +", ", ", printed)


def test_the_same_as_json_and_csv(found, capsys):
    assert main(["rates", found, "--json", "--by", "country"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert [rule["group"]["country"] for rule in document["rules"]] == ["DEU"] * 3 + ["USA"] * 3
    assert main(["rates", found, "--output-format", "csv", "--by", "country"]) == 0
    rows = list(csv.DictReader(io.StringIO(capsys.readouterr().out)))
    assert [row["rule"] for row in rows] == [rule["rule"] for rule in document["rules"]]
    for row, rule in zip(rows, document["rules"], strict=True):
        if rule["per_hour"] is not None:
            assert float(row["per_hour_high"]) == rule["per_hour"]["exact"][1]


@pytest.mark.parametrize("ending", ["md", "txt", "csv", "json", "svg", "html", "png"])
def test_every_ending(found, tmp_path, ending):
    path = tmp_path / f"rates.{ending}"
    assert main(["rates", found, "-o", str(path), "--per", "opportunity"]) == 0
    data = path.read_bytes()
    if ending == "png":
        assert data.startswith(b"\x89PNG")
    else:
        assert b"stop_sign" in data.replace(b"\\", b"")
    if ending == "svg":
        assert ElementTree.fromstring(data).tag.endswith("svg")


def test_a_picture_of_nothing_says_so(tmp_path):
    row = {**SHARED, "kind": "drive", "vehicle": "v", "outcome": "kept", "duration_s": 1.0}
    path = tmp_path / "found.jsonl"
    path.write_text(json.dumps(row))
    assert main(["rates", str(path), "-o", str(tmp_path / "rates.svg")]) == 0
    assert "no rule was put to the test" in (tmp_path / "rates.svg").read_text()


def test_a_seed_draws_other_drives(found, capsys):
    printed = []
    for seed in ("0", "0", "1"):
        assert main(["rates", found, "--json", "--seed", seed]) == 0
        rules = json.loads(capsys.readouterr().out)["rules"]
        printed.append(rules)
    assert printed[0] == printed[1]


@pytest.mark.parametrize("confidence", ["0.4", "1", "nan", "much"])
def test_confidence_is_a_probability(found, confidence, capsys):
    assert main(["rates", found, "--confidence", confidence]) == 2
    assert "--confidence" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["nowhere.jsonl", "nowhere"])
def test_a_file_that_is_not_there(name, capsys):
    assert main(["rates", name]) == 2
    assert "R0701" in capsys.readouterr().err


BOOK = """
rulebook lights
signal red_light, crosses_line default false
hard rule red_light { require never (red_light and crosses_line) }
"""
DRIVES = [
    {"id": "a", "states": [{"red_light": True}, {}, {"red_light": True, "crosses_line": True}]},
    {"id": "b", "states": [{"red_light": None}, {"red_light": True}]},
    {"id": "c", "states": [{"red_light": 7}]},
]


@pytest.mark.parametrize("ending", ["jsonl", "csv", "parquet"])
def test_findings_of_traces_have_their_exposure(tmp_path, ending, capsys):
    """Three red lights in 5 s, and one that may be part of another; c cannot be judged."""
    (tmp_path / "lights.rules").write_text(BOOK)
    drives = tmp_path / "drives.jsonl"
    drives.write_text("".join(f"{json.dumps(drive)}\n" for drive in DRIVES))
    path = tmp_path / f"found.{ending}"
    command = ["verify", str(drives), "-r", str(tmp_path / "lights.rules"), "--exposure"]
    assert main([*command, "-o", str(path)]) == 2
    capsys.readouterr()
    if ending == "jsonl":
        rows = [json.loads(line) for line in path.read_text().splitlines()]
        # Of a drive there is neither a rule nor what it is about, and no limit that it is off.
        drive = next(row for row in rows if row["kind"] == "drive")
        assert (drive["rule"], drive["other"], drive["by"]) == ("", [], None)
    assert main(["rates", str(path), "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert (document["drives"], document["not_judged"]) == (2, 1)
    (rule,) = document["rules"]
    assert (rule["opportunities"], rule["perhaps_opportunities"]) == (3, 3)
    assert (rule["violated"], rule["perhaps_violated"]) == (1, 1)
    assert rule["exposed_h"] == pytest.approx(3 / 3600)
    assert rule["perhaps_exposed_h"] == pytest.approx(4 / 3600)
    assert rule["hours"] == pytest.approx(5 / 3600)
    assert rule["km"] is None


def test_with_exposure_nothing_is_looked_for_twice(tmp_path, monkeypatch, capsys):
    """One violation of a trace and three of a recording, whose evidence is one each."""
    looked = []

    def counted(module, name):
        original = getattr(module, name)

        def noting(*given, **named):
            looked.append(name)
            return original(*given, **named)

        monkeypatch.setattr(module, name, noting)

    counted(findings_of_traces, "explain")
    counted(findings_of_drives, "evidence_of")
    (tmp_path / "lights.rules").write_text(BOOK)
    (tmp_path / "slow.rules").write_text(
        "rulebook slow use road hard rule r { require always speed < 1 km/h }"
    )
    drives = tmp_path / "drives.jsonl"
    drives.write_text(json.dumps(DRIVES[0]))
    for book, file in (("lights", drives), ("slow", three_cars(tmp_path))):
        command = ["verify", str(file), "-r", str(tmp_path / f"{book}.rules"), "--explain", "0"]
        for more in ([], ["--exposure"]):
            looked.clear()
            assert main([*command, *more, "-o", str(tmp_path / "found.jsonl")]) == 1
            assert len(looked) == (1 if book == "lights" else 3)


def test_exposure_goes_to_tables(tmp_path, capsys):
    assert (
        main(["verify", "x.jsonl", "-r", "de", "--exposure", "-o", str(tmp_path / "a.sarif")]) == 2
    )
    assert "--exposure is for tables" in capsys.readouterr().err


def test_findings_without_exposure_are_refused(tmp_path, capsys):
    (tmp_path / "lights.rules").write_text(BOOK)
    drives = tmp_path / "drives.jsonl"
    drives.write_text(json.dumps(DRIVES[0]))
    path = tmp_path / "found.csv"
    main(["verify", str(drives), "-r", str(tmp_path / "lights.rules"), "-o", str(path)])
    assert main(["rates", str(path)]) == 2
    assert "written without `--exposure`" in capsys.readouterr().err
