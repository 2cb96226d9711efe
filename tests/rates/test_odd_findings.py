"""Findings in which one value is odd: refused with their row, or counted as they are."""

import json

import pytest

from rulec.cli.main import main
from support.generators.odd_documents import ODD_VALUES, places_in, with_value

DRIVE = {
    "kind": "drive",
    "file": "a.xml",
    "recording": "a",
    "vehicle": "1",
    "rulebook": "de",
    "duration_s": 2.0,
    "distance_m": 20.0,
}
RULE = {
    **DRIVE,
    "kind": "rule",
    "rule": "r",
    "strength": "hard",
    "outcome": "kept",
    "opportunities": 1,
    "opportunities_s": 2.0,
}
ODD = {**ODD_VALUES, "numbers": [1], "object": {"a": 1}, "large": 1e308, "true": True, "less": -1}


@pytest.mark.parametrize("name", ODD)
def test_an_odd_value_in_any_field_is_refused_or_counted(name, tmp_path, capsys):
    file = tmp_path / "findings.jsonl"
    for number, row in enumerate((DRIVE, RULE)):
        for place in places_in(row):
            rows = [DRIVE, RULE]
            rows[number] = with_value(row, place, ODD[name])
            file.write_text("".join(f"{json.dumps(one)}\n" for one in rows))
            status = main(["rates", str(file)])
            said = capsys.readouterr()
            assert status == 0 or (status == 2 and "error[R" in said.err), said
            assert not any("\ud800" <= sign <= "\udfff" for sign in said.out)


@pytest.mark.parametrize("form", ["json", "svg"])
def test_a_drive_of_next_to_no_time_has_no_infinite_rate(form, tmp_path, capsys):
    file = tmp_path / "findings.jsonl"
    rows = [
        {**row, "vehicle": vehicle, "duration_s": duration_s, "distance_m": 1e-306, "violated": 1}
        for vehicle, duration_s in (("1", 1e-306), ("2", 1e-310))
        for row in (DRIVE, RULE)
    ]
    file.write_text("".join(f"{json.dumps(row)}\n" for row in rows))
    assert main(["rates", str(file), "--output-format", form]) == 0
    text = capsys.readouterr().out
    assert "Infinity" not in text
    if form == "json":
        (rule,) = json.loads(text)["rules"]
        assert rule["per_hour"] is None
        assert rule["per_1000_km"] is None
