"""``rulec maneuvers --envelopes`` as its user meets it."""

import json

from rulec.cli.main import main


def test_the_same_bounds_as_in_json(tmp_path, capsys):
    file = tmp_path / "e.jsonl"
    assert (
        main(
            ["maneuvers", "--envelopes", "s1", "-r", "esterle2019", "--list", "3", "-o", str(file)]
        )
        == 0
    )
    assert capsys.readouterr().out == f"wrote 3 of 16 satisfying maneuvers to {file}\n"
    main(["maneuvers", "s1", "-r", "esterle2019", "--list", "3", "--json"])
    told = json.loads(capsys.readouterr().out)["maneuvers"]
    rows = [json.loads(line) for line in file.read_text().splitlines()]
    for number, maneuver in enumerate(told, 1):
        for layer, (cell, bounds) in enumerate(
            zip(maneuver["cells"], maneuver["envelope"], strict=True)
        ):
            here = [row for row in rows if (row["maneuver"], row["layer"]) == (number, layer)]
            assert {row["cell"] for row in here} == {cell["cell"]}
            assert {row["cost"] for row in here} == {maneuver["cost"]}
            assert here[0]["s_min"] == bounds["s_min"]
            assert here[-1]["s_max"] == bounds["s_max"]
            assert min(row["d_right"] for row in here) == min(d for _, d in bounds["d_right"])
            assert max(row["d_left"] for row in here) == max(d for _, d in bounds["d_left"])


def test_no_satisfying_maneuver_is_status_1(tmp_path, capfd):
    source = tmp_path / "stop.rules"
    source.write_text("rulebook stop\nuse paper\nhard rule A (v: vehicle) { require l(v) }\n")
    assert (
        main(["maneuvers", "--envelopes", "s2", "-r", str(source), "-o", "-", "--format", "csv"])
        == 1
    )
    assert capfd.readouterr().out.startswith("maneuver,cost,margin_s,layer,")
