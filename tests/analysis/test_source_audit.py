"""Which rules can be judged on what a source tells."""

import json

import rulec
from rulec.analysis.audit.source_audit import RuleBasis, audit_source
from rulec.cli.main import main
from support.unwrapped import unwrapped

BOOK = """\
rulebook drive
signal red, crosses, waved_on, horn, town default false
presumed waved_on
hard rule light { require never (red and crosses and not waved_on) }
hard rule quiet { require never horn }
soft rule quiet_in_town { require never (crosses and (town or red)) }
hard rule plain { require never crosses }
"""


def basis(*told):
    audit = audit_source(rulec.compile(rulec.parse_rulebook(BOOK)), "some", frozenset(told))
    return audit, {rule.rule: rule for rule in audit.rules}


def test_rules_by_what_their_verdicts_rest_on():
    audit, rules = basis("red", "crosses")
    assert audit.told == ("red", "crosses")
    assert rules == {
        "light": RuleBasis("light", "hard", "presumption", ("waved_on",)),
        "quiet": RuleBasis("quiet", "hard", "nothing", (), ("horn",), ("horn",)),
        "quiet_in_town": RuleBasis("quiet_in_town", "soft", "evidence", (), ("town",)),
        "plain": RuleBasis("plain", "hard", "evidence"),
    }
    assert [audit.count(x) for x in ("evidence", "presumption", "nothing")] == [2, 1, 1]


def test_what_is_presumed_may_be_told():
    assert basis("red", "crosses", "waved_on")[1]["light"].basis == "evidence"


def test_a_rule_lacks_only_what_it_takes():
    assert basis("red")[1]["light"].lacking == ("crosses",)


def test_on_the_command_line(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "drive.rules").write_text(BOOK)
    assert main(["show", "--audit", "drive.rules", "--source", "sumo"]) == 0
    text = unwrapped(capsys.readouterr().out)
    counted = "source sumo: 4 rules: 0 judged on evidence, 0 with presumptions, 4 cannot be judged"
    assert f" {counted} " in text
    assert " quiet for want of horn " in text
    assert (
        main(["show", "--audit", "drive.rules", "--source", "sumo", "--output-format", "markdown"])
        == 0
    )
    assert "| `quiet` | cannot be judged | for want of horn |" in capsys.readouterr().out
    assert (
        main(["show", "--audit", "drive.rules", "--source", "sumo", "--output-format", "json"]) == 0
    )
    (source,) = json.loads(capsys.readouterr().out)["sources"]
    assert source["source"] == "sumo"
    assert [rule["lacking"] for rule in source["rules"]][1] == ["horn"]
    assert main(["show", "--audit", "drive.rules", "--source", "none.xml"]) == 2
    assert "R0701" in capsys.readouterr().err
