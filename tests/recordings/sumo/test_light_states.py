"""What lights showed, as SUMO recorded it, stands above what their programmes would have shown."""

import pytest

from rulec.diagnostics import RulecError
from rulec.recordings.sumo.light_states import read_light_states
from rulec.recordings.sumo.sumo_recording import read_sumo
from support.builders.sumo_files import ROAD_NET, body, data, moment, written

LOGIC = '<tlLogic id="x" type="actuated" programID="0"><phase duration="9" state="G"/></tlLogic>'
NET = ROAD_NET.replace('via=":x_0_0"', 'via=":x_0_0" tl="x" linkIndex="0"').replace(
    "</net>", f"{LOGIC}</net>"
)
ROWS = "".join(
    f'<tlsState time="{k / 2:.2f}" id="x" programID="0" phase="0" state="{letter}"/>'
    for k, letter in enumerate("GGGyyrrrrrG")
)
EVENT = '<additional><timedEvent type="SaveTLSStates" source="x" dest="{}"/></additional>'
SEEN = [moment(k / 2, body(x=20 + 5 * k, lane="in_1")) for k in range(11)]


def recorded(folder, name="x.tls.xml", head="", rows=ROWS):
    path = written(folder, data(*SEEN, head=head), NET)
    (folder / name).write_text(f"<tlsStates>{rows}</tlsStates>", encoding="utf-8")
    return read_sumo(path)


def colours(recording):
    (light,) = recording.lanelets["in_1"].lights
    return [light.colour_at(step) for step in range(11)]


SHOWN = ["green"] * 3 + ["yellow"] * 2 + ["red"] * 5 + ["green"]


def test_the_only_file_of_states_is_read(tmp_path):
    recording = recorded(tmp_path)
    assert colours(recording) == SHOWN
    assert not any("traffic lights" in remark for remark in recording.remarks)


def test_an_additional_file_names_it(tmp_path):
    """By its name alone: paths within files lead nowhere else."""
    (tmp_path / "more.xml").write_text(EVENT.format("/elsewhere/lights.xml"), encoding="utf-8")
    head = '<additional-files value="more.xml"/>'
    assert colours(recorded(tmp_path, "lights.xml", head)) == SHOWN


def test_without_states_a_light_that_reacts_is_not_known(tmp_path):
    recording = read_sumo(written(tmp_path, data(*SEEN), NET))
    assert recording.lanelets["in_1"].lights == ()
    assert any("traffic lights" in remark for remark in recording.remarks)


def test_the_last_state_lasts(tmp_path):
    """The first one has been there from the beginning on."""
    file = tmp_path / "x.tls.xml"
    rows = '<tlsState time="3.00" id="x" state="r"/><tlsState time="4.00" id="x" state="G"/>'
    file.write_text(f"<tlsStates>{rows}</tlsStates>", encoding="utf-8")
    light = read_light_states(file)["x"].light(0, 0.5)
    assert [light.colour_at(step) for step in (0, 7, 8, 5000)] == ["red", "red", "green", "green"]


LATE = [moment(k + 0.5, body(x=20 + 5 * k, lane="in_1")) for k in range(9)]
"""What SUMO writes with --begin 0.5 and steps of 1 s."""


@pytest.mark.parametrize("offset", range(4))
def test_a_programme_goes_on_while_times_begin_between_two_steps(tmp_path, offset):
    """Of 2 s of green and 2 s of red: at each moment the light is that of its time."""
    logic = (
        f'<tlLogic id="x" type="static" programID="0" offset="{offset}">'
        '<phase duration="2" state="G"/><phase duration="2" state="r"/></tlLogic>'
    )
    (light,) = (
        read_sumo(written(tmp_path, data(*LATE), NET.replace(LOGIC, logic))).lanelets["in_1"].lights
    )
    expected = ["green" if (k + 0.5 - offset) % 4 < 2 else "red" for k in range(9)]
    assert [light.colour_at(step) for step in range(9)] == expected


def test_states_are_those_of_times_that_begin_between_two_steps(tmp_path):
    path = written(tmp_path, data(*LATE), NET)
    rows = "".join(
        f'<tlsState time="{k + 0.5}" id="x" programID="0" phase="0" state="{letter}"/>'
        for k, letter in enumerate("GGyrrrGyr")
    )
    (tmp_path / "x.tls.xml").write_text(f"<tlsStates>{rows}</tlsStates>", encoding="utf-8")
    (light,) = read_sumo(path).lanelets["in_1"].lights
    shown = [light.colour_at(step)[0] for step in range(9)]
    assert shown == ["g", "g", "y", "r", "r", "r", "g", "y", "r"]


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        ('<tlsState id="x" state="r"/>', "time"),
        ('<tlsState time="1" state="r"/>', "id"),
        ('<tlsState time="1" id="x"/>', "state"),
        ('<tlsState time="2" id="x" state="r"/><tlsState time="1" id="x" state="r"/>', "order"),
    ],
)
def test_what_is_wrong_is_said(tmp_path, rows, said):
    with pytest.raises(RulecError) as raised:
        recorded(tmp_path, rows=rows)
    assert raised.value.diagnostics[0].code == "R0610"
    assert said in raised.value.diagnostics[0].message


STATIC = NET.replace('type="actuated"', 'type="static"')
OTHER = '<tlLogic id="x" type="static" programID="b"><phase duration="9" state="r"/></tlLogic>'
ADDED = '<additional-files value="more.xml"/>'


@pytest.mark.parametrize(
    ("more", "colour"),
    [
        (f"<additional>{OTHER}</additional>", "red"),
        (f"<add>{OTHER}</add>", "red"),
        ("<additional/>", "green"),
        # What reacts to traffic, or changes between programmes, nobody knows; nor a file elsewhere
        (f"<additional>{OTHER.replace('static', 'actuated')}</additional>", None),
        (
            f'<additional>{OTHER}<wautJunction wautID="w" junctionID="x"/></additional>',
            None,
        ),
        (None, None),
    ],
)
def test_a_programme_of_an_additional_file_replaces_the_nets(tmp_path, more, colour):
    """SUMO loads it after the net, and what it loads last runs."""
    path = written(tmp_path, data(*SEEN, head=ADDED), STATIC)
    if more is not None:
        (tmp_path / "more.xml").write_text(more, encoding="utf-8")
    recording = read_sumo(path)
    lights = recording.lanelets["in_1"].lights
    assert [light.colour_at(0) for light in lights] == ([colour] if colour else [])
    assert any("traffic lights" in remark for remark in recording.remarks) == (colour is None)
