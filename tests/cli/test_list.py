"""``rulec list`` as its user meets it."""

import json
from pathlib import Path

import pytest

from rulec.cli.main import main
from rulec.report.findings.code_registry import all_codes
from rulec.rulebook.files.catalogue import list_rulebooks, list_vocabularies
from rulec.scenario import available_scenarios


def listed(capsys, *arguments):
    status = main(["list", *arguments])
    assert status == 0
    return capsys.readouterr().out


def test_everything_but_codes(capsys):
    lines = listed(capsys).splitlines()
    assert [line for line in lines if not line.startswith(" ")] == [
        "rulebooks",
        "vocabularies",
        "scenarios",
    ]
    assert "  esterle2019  Traffic rules of Esterle, Aravantinos and Knoll (2019)" in lines
    assert all(len(line) <= 80 for line in lines)


@pytest.mark.parametrize(
    ("kind", "names"),
    [
        ("rulebooks", {"esterle2019"}),
        ("vocabularies", {"paper", "road"}),
        ("scenarios", set(available_scenarios())),
        ("codes", set(all_codes())),
    ],
)
def test_one_kind(kind, names, capsys):
    lines = listed(capsys, kind).splitlines()
    assert names <= {line.split()[0] for line in lines}
    assert all(line.split()[1:] for line in lines)
    document = json.loads(listed(capsys, kind, "--json"))
    assert list(document) == ["version", kind]
    assert len(document[kind]) == len(lines)
    for one in document[kind]:
        assert set(one) == {"name", "title", "path"}
        assert one["path"] is None if kind == "codes" else Path(one["path"]).is_file()


def test_a_kind_that_there_is_not(capsys):
    assert main(["list", "rulbooks"]) == 2
    assert "did you mean `rulebooks`?" in capsys.readouterr().err


def test_rules_of_several_books(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for name, rules in (("one", "ab"), ("two", "bc")):
        (tmp_path / f"{name}.rules").write_text(
            f'rulebook {name}\nsignal p\ntopics {{ mud "Mud" of b }}\n'
            + "".join(f'hard rule {x} {{ cite "{name} 1" require never p }}\n' for x in rules)
        )
    books = ["./one.rules", "./two.rules"]
    assert listed(capsys, "rules", *books).splitlines() == [
        "one: no law is named; 2 rules (2 hard)",
        "two: no law is named; 2 rules (2 hard)",
        "Mud",
        "  b  one two  never p",
        "other",
        "  a  one      never p",
        "  c  two      never p",
    ]
    assert listed(capsys, "rules", books[1]).splitlines()[-1] == "  c  two 1  never p"
    (only,) = json.loads(listed(capsys, "rules", *books, "--topic", "mud", "--json"))["rules"]
    assert only["books"] == {
        name: {"strength": "hard", "cite": f"{name} 1", "says": ""} for name in ("one", "two")
    }


def test_a_book_with_mistakes_does_not_hide_the_rules_of_others(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bad.rules").write_text("rulebook bad\nhard rule r { require always q }\n")
    for _ in range(2):
        assert main(["list", "rules", "./bad.rules", "esterle2019"]) == 2
        out, err = capsys.readouterr()
        assert "\n  R1  Article 11.1" in out
        assert "R0201" in err or "R0202" in err
    assert main(["list", "rules", "./bad.rules"]) == 2


@pytest.mark.parametrize(
    "words", [["codes", "de"], ["--topic", "lights"], ["codes", "--at", "2020-01-01"]]
)
def test_only_rules_are_those_of_a_book(words, capsys):
    assert main(["list", *words]) == 2
    assert "only rules are those of a RULEBOOK" in capsys.readouterr().err


def test_a_file_that_cannot_be_read_is_listed_without_a_title(tmp_path):
    (tmp_path / "good.rules").write_text(
        'rulebook good\ntitle "A title"\nsignal p\nhard rule r { require always p }\n'
    )
    (tmp_path / "broken.rules").write_bytes(b'rulebook broken\ntitle "\xff"\n')
    (tmp_path / "words.rules").write_text(
        "vocabulary words { type a signal p, q signal r quantity speed in m }\n"
    )
    books = {one.name: one.title for one in list_rulebooks([tmp_path])}
    assert (books["good"], books["broken"]) == ("A title", "")
    words = {one.name: one.title for one in list_vocabularies([tmp_path])}
    assert words["words"] == "1 type, 3 signals, 1 quantity"
