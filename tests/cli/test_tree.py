"""``rulec show --tree`` as its user meets it."""

import json
import re

import pytest

from rulec.cli.main import main
from support.builders import rulebook_family as island


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    island.write(tmp_path)
    (tmp_path / "rulec.toml").write_text('search_path = ["."]\n')
    return tmp_path


def run(capsys, *arguments):
    status = main(["show", "--tree", *arguments])
    return status, *capsys.readouterr()


def test_what_the_last_book_did(folder, capsys):
    status, out, err = run(capsys, "village", "--at", "2024-06-01")
    assert (status, err) == (0, "")
    assert out.splitlines() == [
        "village ← island ← mainland: 1 overridden · 2 own · 6 only inherited",
        "overridden",
        "  changed  says",
        "own: own, expired",
        "set: strict = on",
        "`--all` shows every rule, option, parameter and definition",
    ]
    out = run(capsys, "island", "--at", "2024-06-01")[1]
    lines = [
        "taken_out  there are no sirens",
        "softer  only recommended",
        "left_open  nobody knows",
    ]
    assert all(f"\n  {line}\n" in out for line in lines)


def test_where_a_list_is_too_long_names_stand_in_lines(folder, capsys):
    rules = "".join(f"hard rule R{n} {{ require never p }}\n" for n in range(50))
    changes = "".join(f'override rule R{n} {{ says "So." }}\n' for n in range(45))
    (folder / "old.rules").write_text(f"rulebook old\nsignal p\n{rules}")
    (folder / "new.rules").write_text(
        f'rulebook new\nextends old\n{changes}drop rule R49 because "none"\n'
    )
    lines = run(capsys, "./new.rules")[1].splitlines()
    assert lines[0] == "new ← old: 45 overridden · 1 dropped · 4 only inherited"
    assert lines[1].startswith("overridden: R0, R1, ")
    assert lines[-3:-1] == ["dropped", "  R49  none"]
    assert len(lines) < 10


def test_the_whole_tree(folder, capsys):
    status, out, err = run(capsys, "village", "--all", "--at", "2024-06-01")
    assert (status, err) == (0, "")
    assert (
        out
        == """\
mainland  Rules of the mainland
Mainland Act, as of 2020-01-01
mainland.rules
└── island  Rules of the island
    Island Act, as of 2024-01-01
    island.rules
    └── village
        village.rules

rules
├── kept  inherited from mainland, not confirmed
├── changed  overrides island: says
│   ├── declared by mainland
│   └── overridden by island: cite, source, require
├── softer  softened by island, not confirmed, because only recommended
│   └── declared by mainland
├── agreed  inherited from island, which confirms mainland: cite, source,
│   certainty, examples
├── taken_out  dropped by island, because there are no sirens
│   └── declared by mainland
├── left_open  silent, as island is, because nobody knows
│   └── declared by mainland
├── parking  silent, as island is, because left to the villages
├── own  own  in force from 2024-06-01
└── expired  own  in force until 2000-01-01

options
└── strict = on  own
    └── off  from mainland

parameters
├── pace = 20 km/h  from island
│   ├── 30 km/h in force until 2021-12-31  from mainland
│   └── 25 km/h in force from 2022-01-01  from mainland
└── fastest = 100 km/h  from mainland

definitions
├── slow = speed < pace  from island
│   └── speed <= pace  from mainland
└── never_used = speed > fastest  from mainland
"""
    )


def test_rules_by_pattern(folder, capsys):
    status, out, _ = run(capsys, "village", "--rule", "*ed")
    assert status == 0
    assert re.findall(r"^[├└]── (\w+)  ", out, re.MULTILINE)[1:] == ["changed", "agreed", "expired"]
    assert "parameters" not in out


def test_no_rule_is_like_the_pattern(folder, capsys):
    status, out, err = run(capsys, "village", "--rule", "x*")
    assert (status, out) == (2, "")
    assert "village has no rule like `x*`" in err


def test_a_definition_with_other_parameters_than_its_base_gives_it(folder, capsys):
    words = "type car\nsignal near(c: car), p default false\n"
    (folder / "old.rules").write_text(f"rulebook old\n{words}define d(c: car) = near(c)\n")
    new = "rulebook new\nextends old\nredefine d(v: car) = near(v) and p\n"
    (folder / "new.rules").write_text(new)
    status, out, _ = run(capsys, "./new.rules", "--all")
    assert status == 0
    assert out.endswith(
        """
definitions
└── d(v: car) = near(v) and p  own
    └── d(c: car) = near(c)  from old
"""
    )


def test_a_value_for_no_day(folder, capsys):
    (folder / "late.rules").write_text(
        "rulebook late\nparam a = 1 in force from 2030-01-01\n", encoding="utf-8"
    )
    assert (
        "\n└── a  no value in force\n    └── 1 in force from 2030-01-01  own\n"
        in (run(capsys, "late", "--all", "--at", "2024-01-01")[1])
    )


def test_all_that_there_are(folder, capsys):
    status, out, _ = run(capsys)
    assert status == 0
    assert "\nmainland  Rules of the mainland\n" in f"\n{out}"
    assert "\n    └── village\n" in out
    assert "\nesterle2019  Traffic rules of" in f"\n{out}"


def test_several(folder, capsys):
    assert run(capsys, "village", "esterle2019")[1].count("\nmainland  ") == 1
    (folder / "mainland.rules").unlink()
    status, out, err = run(capsys, "village", "esterle2019")
    assert (status, out) == (2, "")
    assert "R0703" in err


def test_a_base_that_is_missing(folder, capsys):
    (folder / "mainland.rules").unlink()
    assert "\nextends mainland, which is not here\n" in run(capsys)[1]


def test_json(folder, capsys):
    data = json.loads(run(capsys, "village", "--json")[1])
    assert data["rulebook"] == "village"
    assert [one["name"] for one in data["books"]] == ["mainland", "island", "village"]
    rules = {one["name"]: one for one in data["rules"]}
    assert rules["taken_out"] == {
        "name": "taken_out",
        "gone": True,
        "steps": [
            {"book": "mainland", "deed": "declared", "clauses": [], "because": "", "lost": []},
            {
                "book": "island",
                "deed": "dropped",
                "clauses": [],
                "because": "there are no sirens",
                "lost": [],
            },
        ],
        "inherited_from": "",
    }
    assert rules["kept"]["inherited_from"] == "mainland"
    assert rules["agreed"]["inherited_from"] == ""
    assert data["provisions"][0]["settings"][1] == {
        "book": "village",
        "text": "on",
        "since": "",
        "until": "",
        "current": True,
        "cite": "",
        "note": "",
        "head": "",
    }
    forest = json.loads(run(capsys, "village", "island", "--json")[1])
    assert [(one["name"], one["extends"]) for one in forest["books"]] == [
        ("mainland", ""),
        ("island", "mainland"),
        ("village", "island"),
    ]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["village", "island", "--rule", "x"], "--rule chooses among the rules of one RULEBOOK"),
        (["village.json"], "`village.json` is compiled and cannot be taken apart"),
        (["vilage"], "did you mean `village`?"),
        (["village", "--at", "2024-02-30"], "`2024-02-30` is no date"),
    ],
)
def test_wrong_usage(folder, arguments, words, capsys):
    status, out, err = run(capsys, *arguments)
    assert (status, out) == (2, "")
    assert words in err
