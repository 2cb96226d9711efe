"""The reason for which there is no maneuver at all."""

from rulec.cli.main import main

ROAD = """
horizon_s = 4
step_s = 1
[road]
s = [0, 60]
lanes = [-2, 2]
[ego]
s = 30
d = 0
"""
CAR = """
[[obstacle]]
id = "{name}"
type = "vehicle"
length = 4
width = 2
s = {s}
d = 0
speed = {speed}
"""


def answered(tmp_path, capsys, *cars, step="1"):
    file = tmp_path / "narrow.toml"
    file.write_text(ROAD + "".join(CAR.format(name=n, s=s, speed=v) for n, s, v in cars))
    status = main(["maneuvers", str(file), "-r", "esterle2019", "--step", step])
    return status, capsys.readouterr().out


def test_others_sweep_all_the_room(tmp_path, capsys):
    # One comes from behind at 12 m/s, one from ahead: they meet where ego is after 2.2 s
    status, text = answered(tmp_path, capsys, ("1", 2, 12), ("2", 58, -12))
    assert status == 1
    assert "none leads on from between 1 s and 2 s: in steps of 1 s" in text
    assert "try a shorter --step" in text


def test_nothing_is_said_where_there_is_a_way(tmp_path, capsys):
    status, text = answered(tmp_path, capsys, ("1", 2, 0))
    assert status == 0
    assert "leads on" not in text
