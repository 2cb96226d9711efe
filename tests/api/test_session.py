"""Verbs with a search path, a day and a listener of their own."""

import pickle

import pytest

import rulec

BOOK = "rulebook {name}\nsignal p default false\nhard rule r {{ require always p }}\n"
SURPRISING = """rulebook odd
signal p default false
hard rule r {
  require always p
  reject "odd" { p }
}
"""
LAW = """rulebook dated
law "L" as of 2020-01-01
signal p default false
hard rule old { in force until 2019-12-31 require always p }
hard rule new { in force from 2020-01-01 require always not p }
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "mine.rules").write_text(BOOK.format(name="mine"))
    return tmp_path


def test_the_search_path(folder):
    session = rulec.Session([folder])
    assert session.load_rulebook("mine").name == "mine"
    assert session.compile_rulebook("mine").rules[0].name == "r"
    assert session.test("mine").rows() == []
    assert session.audit("mine").rulebook == "mine"
    assert session.tree("mine").book == "mine"
    assert session.diff("mine", "mine").is_none
    assert "mine" in [one.name for one in session.list()]
    assert session.check("mine").findings == session.check(folder).findings
    assert "always" in session.show("mine", "r")
    assert session.doc("mine", "markdown").startswith("#")
    for verb in (rulec.load_rulebook, rulec.compile_rulebook, rulec.test, rulec.audit, rulec.tree):
        with pytest.raises(rulec.RulecError):
            verb("mine")
    assert rulec.load_rulebook("mine", [folder]).name == "mine"
    assert rulec.compile_rulebook("mine", [folder]).name == "mine"


def test_rules_by_name_wherever_rules_are_taken(folder):
    session = rulec.Session([folder])
    trace = rulec.Trace("t", 1.0, {}, ({"p": True}, {"p": False}))
    assert not session.verify(trace, "mine").satisfied
    assert [one.satisfied for one in session.verify_many([trace], "mine")] == [False]
    assert session.find_maneuvers("s1", "mine").satisfying == 0


def test_the_day(tmp_path):
    (tmp_path / "dated.rules").write_text(LAW)
    for day, rule in (("2019-06-01", "old"), ("", "new")):
        book = rulec.Session([tmp_path], day).load_rulebook("dated")
        assert [one.name for one in book.rules] == [rule]
        assert [r.name for r in rulec.load_rulebook("dated", [tmp_path], day).rules] == [rule]


def test_warnings(tmp_path):
    (tmp_path / "odd.rules").write_text(SURPRISING)
    warnings = []
    rulec.Session([tmp_path], on_warning=warnings.extend).compile_rulebook("odd")
    assert [one.code for one in warnings] == ["R0406"]
    warnings.clear()
    rulec.compile_rulebook("odd", [tmp_path], warnings.extend)
    assert [one.code for one in warnings] == ["R0406"]


def test_a_session_is_a_value(folder):
    session = rulec.Session([folder], "2020-01-01")
    assert pickle.loads(pickle.dumps(session)) == session
    assert pickle.loads(pickle.dumps(rulec.explain))("R0104").code == "R0104"


def test_the_older_name():
    assert rulec.Session.judge_recording is rulec.Session.verify_recording


def test_texts():
    text = rulec.new_rulebook("mine")
    assert rulec.format(text) == text
    assert rulec.parse_rulebook(text).name == "mine"
    assert rulec.explain("r0104").code == "R0104"
    with pytest.raises(KeyError):
        rulec.explain("R9999")
    with pytest.raises(KeyError):
        rulec.show("esterle2019", "R9")


def test_analyze():
    assert {one.code[:3] for one in rulec.analyze("esterle2019")} <= {"R08"}


def test_files(tmp_path):
    rules = rulec.compile("esterle2019")
    names = {path.name for path in rulec.write_compiled(rules, tmp_path)}
    assert names == {"R1.hoa", "R2.hoa", "R3.hoa", "esterle2019.json"}
    read = rulec.compile_rulebook(tmp_path / "esterle2019.json")
    assert read == rules
    assert read.source is None
    assert rules.source == rulec.load_rulebook("esterle2019")
    for name in ("t.jsonl", "t.csv", "t.parquet"):
        traces = list(rulec.traces("s1", rules, limit=5))
        rulec.write_traces(traces, tmp_path / name)
        again = rulec.read_traces(tmp_path / name)
        assert [(one.id, one.states) for one in again] == [(one.id, one.states) for one in traces]


def test_pictures():
    rules = rulec.compile("esterle2019")
    maneuvers = rulec.find_maneuvers("s1", rules)
    (trace,) = rulec.traces("s1", rules, limit=1)
    pictures = [
        rulec.draw(maneuvers),
        rulec.draw(maneuvers, as_graph=True),
        rulec.draw(maneuvers.graph),
        rulec.draw(trace, rules),
    ]
    assert all(picture.startswith(b"<svg") for picture in pictures)
    assert rulec.draw(maneuvers, form="html").lower().startswith(b"<!doctype html>")
    with pytest.raises(TypeError, match="needs the rules"):
        rulec.draw(trace)
