"""``rulec show``."""

import json
import re
from xml.etree import ElementTree

import pytest

from rulec import compile_rulebook
from rulec.book_tests.example_runs import run_rulebook_examples
from rulec.cli.main import main
from rulec.rulebook.loader import parse_rulebook
from rulec.rulebook.reading.rulebook_reader import load_rulebook
from rulec.rulebook.vocabulary_phrases import topic_groups

TWO = """\
rulebook two
use road
signal horn default false
hard rule quiet { says "No horn." require always not horn }
soft rule pass_by (v: vehicle, w: bus) {
  require never (behind(v) then beside(v) then in_front_of(w))
}
"""


@pytest.fixture
def two(tmp_path):
    path = tmp_path / "two.rules"
    path.write_text(TWO)
    return str(path)


def test_the_whole_page(capsys):
    assert main(["show", "esterle2019", "R3"]) == 0
    assert (
        capsys.readouterr().out
        == """\
hard rule R3 (p: pedestrian)
  cite  Article 21.3
  says  Stop if pedestrians are using or intend to use a pedestrian crossing.

in English
  For every pedestrian p: at all times it is not the case that both the surface
  is “R_pc” and the position of p is “f”.

formula
  always not (R_pc and f(p))

automaton
  2 states; a trace starts in state 0, and is accepted or rejected as written
  after its last step
  state 0
    R_pc and f(p)   to state 1   rejected
    otherwise       stays        accepted
  state 1: violated for good: whatever follows, the trace is rejected

a shortest rejected trace, and an accepted one close to it
  accept { f(p) }
  reject { f(p) and R_pc }
"""
    )


def test_without_a_rule_each_has_a_line(two, capsys):
    assert main(["show", two]) == 0
    head, *rules, way_on = capsys.readouterr().out.splitlines()
    assert head == "two: no law is named; 2 rules (1 hard, 1 soft)"
    assert rules[0] == "  quiet    No horn."
    assert rules[1].startswith("  pass_by  (soft) never (")
    assert way_on == "a RULE's name shows it in full, `--all` every one"


def test_rules_stand_below_what_they_are_about(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "own.rules").write_text(
        "rulebook own\nsignal p\n"
        'topics { moon "On the Moon" of crater; lights "Lamps" of lamp; speed_limit "Limits" }\n'
        'hard rule crater { says "Mind it." require never p }\n'
        "hard rule lamp { topic lights require never p }\n"
        "hard rule pace { topic speed_limit, lights require never p }\n"
        "hard rule rest { require never p }\n"
    )
    assert main(["show", "./own.rules"]) == 0
    lines = capsys.readouterr().out.splitlines()[1:-1]
    assert [line.split()[0] for line in lines] == [
        *("speed", "pace", "lamps", "lamp", "On", "crater", "other", "rest")
    ]
    for topic, rules in (("moon", ["crater"]), ("Lamps", ["lamp", "pace"]), ("on", ["crater"])):
        assert main(["show", "./own.rules", "--topic", topic, "--json"]) == 0
        found = json.loads(capsys.readouterr().out)["rules"]
        assert [rule["name"] for rule in found] == rules
    assert main(["show", "./own.rules", "--topic", "vitesse"]) == 0
    assert "rule pace" in capsys.readouterr().out
    assert main(["show", "./own.rules", "--topic", "limits", "--rule", "lamp"]) == 2
    assert "own has no rule like `lamp`" in capsys.readouterr().err
    assert main(["show", "./own.rules", "--topic", "boat"]) == 2
    said = "there is no topic `boat`; there are `speed`, `lamps`; single ones are such as `moon`"
    assert said in capsys.readouterr().err


def test_every_shipped_topic_is_in_a_group():
    book = load_rulebook("schemas")
    topics = {topic.name for topic in book.topics}
    assert {name for below in topic_groups().values() for name in below} == topics


def test_with_all_every_one_in_brief(two, capsys):
    assert main(["show", two, "--all"]) == 0
    out = capsys.readouterr().out
    assert out.startswith(
        "hard rule quiet\n  says  No horn.\n\n  At all times “horn” does not hold.\n\n\n"
        "soft rule pass_by (v: vehicle, w: bus)\n  weight  1\n\n"
        "  For every vehicle v and every other bus w: it never happens that"
    )
    assert "automaton" not in out


def test_the_only_rule_in_full(tmp_path, capsys):
    path = tmp_path / "one.rules"
    path.write_text("rulebook alone signal p hard rule r { require p or not p }")
    assert main(["show", str(path)]) == 0
    out = capsys.readouterr().out
    assert "state 0: satisfied for good" in out
    assert "no trace is rejected: nothing can violate this rule" in out


def test_of_several_rules_of_that_word_each_is_named(tmp_path, capsys):
    path = tmp_path / "limits.rules"
    rules = ("speed_in_town", "speed_outside", "horn")
    text = "".join(f"hard rule {name} {{ require always p }} " for name in rules)
    path.write_text(f"rulebook limits signal p {text}")
    assert main(["show", str(path), "speed"]) == 2
    said = "limits has no rule `speed`; it has `speed_in_town`, `speed_outside`\n"
    assert said in capsys.readouterr().err


def test_a_rulebook_without_rules(capsys):
    assert main(["show", "schemas"]) == 0
    said = "schemas has no rules; `rulec explain NAME` explains what it defines\n"
    assert capsys.readouterr().out == said
    assert main(["show", "schemas", "passes_stopped"]) == 2
    hint = "it is a definition or a parameter, which `rulec explain passes_stopped` explains\n"
    assert f"schemas has no rule `passes_stopped`; {hint}" in capsys.readouterr().err
    assert main(["show", "schemas", "zz"]) == 2
    assert "schemas has no rule `zz`; it has no rules\n" in capsys.readouterr().err


def test_nothing_can_satisfy_it(tmp_path, capsys):
    path = tmp_path / "one.rules"
    path.write_text("rulebook alone signal p hard rule r { require p and not p }")
    assert main(["show", str(path)]) == 0
    assert "no trace is accepted: nothing can satisfy this rule" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("name", "hint"),
    [
        ("quite", "did you mean `quiet`?"),
        ("zz", "it has `quiet`, `pass_by`"),
        ("horn", "it is a word that rules read, which `rulec explain horn` explains"),
    ],
)
def test_an_unknown_rule(two, name, hint, capsys):
    assert main(["show", two, name]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert f"two has no rule `{name}`; {hint}" in captured.err


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("A", "below has no rule `A`: below dropped it, because it is old"),
        ("B", "below has no rule `B`: above is silent on it, because nobody asks"),
        ("C", "below has no rule `C` on 2020-02-01: it is in force until 2020-01-31"),
        ("D", "below has no rule `D`; it has `E`"),
    ],
)
def test_a_rule_that_is_not_there_any_more(name, why, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "above.rules").write_text(
        "rulebook above\nsignal p\nhard rule A { require always p }\n"
        'silent on B because "nobody asks"\n'
        "hard rule C { require p in force until 2020-01-31 }\n"
        "hard rule E { require always p }\n"
    )
    (tmp_path / "below.rules").write_text(
        'rulebook below\nextends above\ndrop rule A because "it is old"\n'
    )
    assert main(["show", "./below.rules", name, "--at", "2020-02-01"]) == 2
    assert why in capsys.readouterr().err


def test_an_unknown_rulebook(capsys):
    assert main(["show", "esterle2018"]) == 2
    assert "esterle2019" in capsys.readouterr().err


def test_an_automaton_is_one_of_a_rule(two, capsys):
    assert main(["show", two, "--automaton", "dot"]) == 2
    assert "give the RULE whose automaton to show: `quiet`, `pass_by`" in capsys.readouterr().err


def test_json_and_automaton_are_two_answers(capsys):
    assert main(["show", "esterle2019", "R1", "--json", "--automaton", "dot"]) == 2
    assert "--json and --automaton dot contradict each other" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("output_format", "beginning"),
    [("text", "5 states; "), ("dot", "// esterle2019 R1: "), ("svg", "<svg ")],
)
def test_the_automaton_alone(output_format, beginning, capsys):
    assert main(["show", "esterle2019", "R1", "--automaton", output_format]) == 0
    assert capsys.readouterr().out.startswith(beginning)


def test_a_picture_that_is_not_drawn(tmp_path, capsys):
    path = tmp_path / "r.png"
    assert main(["show", "esterle2019", "R1", "-o", str(path)]) == 2
    assert "one of .txt, .json, .dot, .gv, .svg" in capsys.readouterr().err
    assert not path.exists()


@pytest.mark.parametrize(
    ("name", "beginning"),
    [("r.svg", "<svg "), ("r.gv", "// "), ("r.dot", "// "), ("r.txt", "hard rule R1 ")],
)
def test_a_file_in_the_format_of_its_name(name, beginning, tmp_path, capsys):
    path = tmp_path / name
    assert main(["show", "esterle2019", "R1", "-o", str(path)]) == 0
    assert capsys.readouterr().out == f"wrote {path}\n"
    text = path.read_text(encoding="utf-8")
    assert text.startswith(beginning)
    if name == "r.svg":
        assert ElementTree.fromstring(text).tag == "{http://www.w3.org/2000/svg}svg"


def test_a_file_that_cannot_be_written(tmp_path, capsys):
    assert main(["show", "esterle2019", "R1", "-o", str(tmp_path / "no" / "r.svg")]) == 2
    assert "R0702" in capsys.readouterr().err


def test_too_large_to_draw(tmp_path, capsys):
    path = tmp_path / "large.rules"
    path.write_text("rulebook large signal p, q hard rule r { require G (p -> X X X X X X q) }")
    picture = tmp_path / "large.svg"
    assert main(["show", str(path), "-o", str(picture)]) == 2
    assert "too large to draw" in capsys.readouterr().err
    assert not picture.exists()
    assert main(["show", str(path)]) == 0
    assert "65 states and " in capsys.readouterr().out
    assert main(["show", str(path), "--automaton", "text"]) == 0
    assert "state 64: violated for good" in capsys.readouterr().out


def test_all_of_it_as_data(capsys):
    assert main(["show", "esterle2019", "R3", "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    (rule,) = data["rules"]
    assert data["rulebook"] == "esterle2019"
    assert rule["cite"] == "Article 21.3"
    assert rule["sentence"].startswith("For every pedestrian p: at all times it is not the case")
    assert rule["accepts"] == {"objects": [], "states": ["f(p)"], "remarks": []}
    assert rule["rejects"]["states"] == ["f(p) and R_pc"]
    assert [one["fate"] for one in rule["automaton"]["states"]] == ["open", "violated"]
    stays = {
        "source": 0,
        "target": 0,
        "condition": "R_cw or not f(p)",
        "otherwise": True,
        "accepted": True,
    }
    assert stays in rule["automaton"]["transitions"]


def test_the_rules_in_brief_as_data(two, capsys):
    assert main(["show", two, "--json"]) == 0
    rules = json.loads(capsys.readouterr().out)["rules"]
    assert [rule["name"] for rule in rules] == ["quiet", "pass_by"]
    assert all("automaton" not in rule for rule in rules)


def test_a_compiled_rulebook_shows_the_same(tmp_path, capsys):
    assert main(["compile", "esterle2019", "-o", str(tmp_path)]) == 0
    capsys.readouterr()
    for arguments in (["R1"], ["R2", "--automaton", "svg"], []):
        main(["show", "esterle2019", *arguments])
        source = capsys.readouterr().out
        assert main(["show", str(tmp_path / "esterle2019.json"), *arguments]) == 0
        assert capsys.readouterr().out == source


def test_the_shortest_traces_can_be_pasted(capsys):
    book = (
        "rulebook pasted use road signal p, q default false\n"
        "hard rule r (v: vehicle) {{ require {formula} {examples} }}"
    )
    for formula in (
        "always (behind(v) implies next (p since q))",
        "never (behind(v) then beside(v) and left_of(v) then in_front_of(v))",
        "(p and crossing) until (left_of(v) or q)",
        "never p",
        "eventually (p implies q and next q)",
    ):
        bare = parse_rulebook(book.format(formula=formula, examples=""))
        from rulec.report.rulebooks.rule_page import page_of

        page = page_of(bare.rules[0], compile_rulebook(bare))
        examples = " ".join(
            f"{word} {{ {'; '.join(trace.states)} }}"
            for word, trace in (("accept", page.accepted), ("reject", page.rejected))
        )
        pasted = parse_rulebook(book.format(formula=formula, examples=examples))
        run = run_rulebook_examples(pasted, compile_rulebook(pasted))
        assert [one.passed for one in run.outcomes] == [True, True]


def test_control_characters_are_not_passed_on(tmp_path, capsys, monkeypatch):
    monkeypatch.setenv("NO_COLOR", "1")
    assert main(["show", "esterle2019", "R1"]) == 0
    assert not re.search(r"[\x00-\x09\x0b-\x1f]", capsys.readouterr().out)


def test_what_options_rule_out_is_not_told(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.rules").write_text(
        "rulebook a\nsignal p, q\noption yes = on\noption no = off\n"
        "hard rule A { require never (yes and p) unless no and q unless yes and q }\n"
        "hard rule B { require never p when no }\n"
    )
    assert main(["show", "./a.rules", "--all"]) == 0
    out = capsys.readouterr().out
    assert (
        "  It never happens that “p” holds.\n"
        "  It does not count if, throughout the time that the rule is about, “q” holds.\n"
    ) in out
    assert "  It never counts, for its condition is false as options are set.\n" in out
    assert main(["show", "./a.rules", "A"]) == 0
    formula = capsys.readouterr().out.partition("formula\n")[2].partition("automaton")[0]
    assert formula.startswith("  never p\n")
    assert "true" not in formula
    assert "false" not in formula


def test_rules_are_chosen_by_pattern_as_in_other_verbs(two, capsys):
    assert main(["show", two, "--rule", "qui*"]) == 0
    in_full = capsys.readouterr().out
    assert main(["show", two, "quiet"]) == 0
    assert capsys.readouterr().out == in_full
    assert main(["show", two, "--rule", "qui*", "--rule", "pass_by", "--all"]) == 0
    assert "rule quiet" in (both := capsys.readouterr().out)
    assert "rule pass_by" in both
    assert main(["show", two, "--rule", "quiet", "--automaton", "text"]) == 0
    assert "state 0" in capsys.readouterr().out
    assert main(["show", two, "--rule", "z*"]) == 2
    assert "two has no rule like `z*`\n" in capsys.readouterr().err
    assert main(["show", two, "qui*"]) == 2
    said = "`qui*` is no rulebook; for rules that match it write `--rule 'qui*'`\n"
    assert said in capsys.readouterr().err
