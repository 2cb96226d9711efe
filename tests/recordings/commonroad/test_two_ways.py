"""A file that is as it should be is read in one go, any other one element by element: alike."""

import random
from contextlib import contextmanager

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.diagnostics import RulecError
from rulec.recordings.commonroad import commonroad_file
from rulec.recordings.commonroad.commonroad_file import read_commonroad
from rulec.recordings.encodings import xml_tree
from support.builders.recordings import ROAD_XML, SAMPLES
from support.oracles.same_recording import assert_same

TEXTS = [ROAD_XML, *[file.read_text(encoding="utf-8") for file in SAMPLES]]
STATE = """<state><position><point><x>1</x><y>2</y></point></position>
<orientation><exact>0.5</exact></orientation><time><exact>1</exact></time>
<velocity><exact>3</exact></velocity></state>"""


@contextmanager
def element_by_element():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(commonroad_file, "whole_tree", lambda *_: None)
        yield


def outcome(file):
    try:
        return read_commonroad(file), None
    except RulecError as error:
        return None, error.diagnostics


def check(file):
    at_once = outcome(file)
    with element_by_element():
        one_by_one = outcome(file)
    assert at_once[1] == one_by_one[1]
    if at_once[0] is not None:
        assert_same(at_once[0], one_by_one[0])
    return at_once[0]


def with_state(folder, state):
    begin, end = ROAD_XML.split("  </obstacle>")
    file = folder / "road.xml"
    file.write_text(f"{begin}<trajectory>{state}</trajectory></obstacle>{end}", encoding="utf-8")
    return file


@pytest.mark.parametrize("file", SAMPLES, ids=lambda file: file.stem)
def test_samples(file):
    assert check(file) is not None


def test_small_files_are_read_in_one_go(tmp_path, monkeypatch):
    monkeypatch.setattr(commonroad_file, "scan_trees", None)
    (body,) = read_commonroad(with_state(tmp_path, STATE)).participants
    state = body.states[1]
    assert (state.x, state.y, state.heading, state.speed, state.acceleration) == (1, 2, 0.5, 3, 0)


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("<exact>0.5</exact>", "<intervalStart>0.4</intervalStart><intervalEnd>1</intervalEnd>"),
        ("<point><x>1</x><y>2</y></point>", "<circle><radius>1</radius></circle>"),
        ("<x>1</x>", "<x>-0</x>"),
        ("<x>1</x>", "<x>1e-300</x>"),
        ("<x>1</x>", "<x> 1\n</x>"),
        ("<x>1</x>", "<x>1</x><x>7</x>"),
        ("<x>1</x>", "<x>nan</x>"),
        ("<x>1</x>", "<x>1e9</x>"),
        ("<x>1</x>", "<x><!-- one -->1</x>"),
        ("<x>1</x>", f"<x>{'0' * 2000}1</x>"),
        ("<x>1</x>", ""),
        ("<time><exact>1</exact></time>", ""),
        ("<time><exact>1</exact></time>", "<time><exact>1.0</exact></time>"),
        ("<time><exact>1</exact></time>", "<time><exact>-3</exact></time>"),
        ("<velocity><exact>3</exact></velocity>", ""),
        ("</state>", "<acceleration><exact>1</exact></acceleration></state>"),
        ("</state>", "<acceleration></acceleration></state>"),
        ("</state>", "<velocity><exact>9</exact></velocity></state>"),
        ("</state>", f"{'<a>' * 40}{'</a>' * 40}</state>"),
        ("<time><exact>1</exact></time>", f"<time>{'<a>' * 40}{'</a>' * 40}</time>"),
    ],
)
def test_states_of_other_kinds(tmp_path, before, after):
    assert before in STATE
    check(with_state(tmp_path, STATE.replace(before, after, 1) + STATE.replace(">1<", ">2<")))


SECOND = STATE.replace(">1<", ">2<")
HIDDEN = "<!-- <trajectory>" + STATE + "</trajectory> -->"
BOUND = "<leftBound> <point><x>1</x><y>2</y></point> </leftBound>"


@pytest.mark.parametrize(
    "states",
    [
        STATE + "<!-- </trajectory> -->" + SECOND,
        STATE + "<!-- </state> -->" + SECOND,
        STATE + SECOND + "<!-- <state> -->",
        "<!-- <state> -->" + STATE + SECOND,
        HIDDEN + STATE + SECOND,
        "<![CDATA[<state>]]>" + STATE,
        STATE + "some words" + SECOND,
        STATE.replace("<x>1", "<x>&#49;") + SECOND,
        STATE.replace("<x>1", "<x>\N{ARABIC-INDIC DIGIT ONE}") + SECOND,
        STATE.replace("<x>", "<x >") + SECOND,
        STATE.replace("<state>", '<state id="1">') + SECOND,
        STATE + SECOND.replace("</state>", BOUND + "</state>"),
        STATE.replace("</state>", BOUND + "</state>") * 2,
        STATE.replace("<y>2</y>", "<y>2</y><z>3</z>") + SECOND,
        STATE.replace("<x>1</x>", "<z>3</z><x>1</x>") + SECOND,
        STATE.replace("<point>", "<point><z>3</z></point><point>"),
        STATE.replace("</point>", "</point><point><x>5</x><y>6</y></point>"),
        STATE + "</trajectory><trajectory>" + SECOND,
        "<trajectory>" + STATE + "</trajectory>" + SECOND,
        "<trajectory>" + STATE,
        "",
    ],
)
def test_trajectories_of_other_kinds(tmp_path, states):
    check(with_state(tmp_path, f"\n  {states}\n"))


def test_an_attribute_cannot_stand_for_what_is_alike(tmp_path):
    file = with_state(tmp_path, f"\n {STATE}\n")
    text = file.read_text(encoding="utf-8")
    file.write_text(text.replace("<position>", '<position rulec-alike="0">'), encoding="utf-8")
    assert check(file) is not None


def test_what_begins_and_never_ends_is_looked_at_once(tmp_path, monkeypatch):
    looked_at = []
    monkeypatch.setattr(xml_tree, "_shape", lambda *_: looked_at.append(1))
    check(with_state(tmp_path, STATE + ("<trajectory>" + STATE) * 500))
    assert len(looked_at) == len(("trajectory", "leftBound", "rightBound"))


@given(st.integers(0, 2**32))
def test_files_with_mistakes(tmp_path_factory, seed):
    chance = random.Random(seed)
    text = chance.choice(TEXTS)
    for _ in range(chance.randint(1, 3)):
        at, length = chance.randrange(len(text)), chance.choice((0, 1, 1, 3, 40))
        other = chance.randrange(len(text))
        text = text[:at] + text[other : other + chance.choice((0, 1, 30))] + text[at + length :]
    file = tmp_path_factory.getbasetemp() / "mistaken.xml"
    file.write_text(text, encoding="utf-8")
    check(file)
