"""``rulec diff``."""

import csv
import json
from html.parser import HTMLParser

import pytest

from rulec.cli.main import main
from rulec.rulebook.reading import rulebook_reader

OLD = """\
rulebook old
use road
law "Act" as of 2020-01-01
quantity side_gap(c: cyclist) in m default 10
signal horn default false
param least : length = 1.5 m
hard rule leave_room (c: cyclist) {
  cite "§ 5"
  require always (beside(c) implies side_gap(c) >= least)
}
hard rule no_passing (v: vehicle) {
  require never (behind(v) then beside(v) and right_of(v) then in_front_of(v))
}
soft rule no_horn { require never horn }
soft rule no_crowd (v: vehicle) { require never (count x: bus (beside(x)) >= 2 and beside(v)) }
"""

NEW = """\
rulebook new
extends old
law "Act" as of 2020-01-01
set least = 2 m
override rule no_passing (v: vehicle) { unless congested throughout }
silent on no_horn because "in the act on noise"
"""


@pytest.fixture(autouse=True)
def books(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "old.rules").write_text(OLD)
    (tmp_path / "new.rules").write_text(NEW)


def test_a_rule_that_differs_has_a_line(capsys):
    assert main(["diff", "./new.rules", "./old.rules"]) == 1
    assert capsys.readouterr().out.splitlines() == [
        "new compared to old; the law of 2020-01-01",
        "3 shared rules: 1 equal, 1 stricter, 1 laxer, 1 only in old",
        "leave_room  new stricter  old § 5 | § 5",
        "no_passing  old stricter  old",
        "only in old: no_horn",
        "set otherwise: parameter least: 2 m in new, 1.5 m in old",
        "a RULE's name, too, shows traces on which it differs, -v those of all",
    ]
    assert main(["diff", "./new.rules", "./old.rules", "no_passing"]) == 1
    out = capsys.readouterr().out
    assert "old forbids, new allows" in out
    assert "1 shared rule: 1 laxer" in out
    assert main(["diff", "./new.rules", "./old.rules", "--rule", "no_passing"]) == 1
    assert capsys.readouterr().out == out


@pytest.mark.parametrize("topic", ["pedestrian crossing", "Crosswalk", "pedestrian_crossings"])
def test_a_crossing_for_pedestrians_is_none_of_rails(topic, capsys):
    assert main(["diff", "de", "gb", "--topic", topic]) == 0
    head, days, *rest = capsys.readouterr().out.splitlines()
    assert head.startswith(f"de, gb on {topic}: ")
    assert days == "law as of: de 2022-01-28, gb 2024-06-20"
    assert "give_way_to_pedestrians" in rest
    assert not any("level_crossing" in line for line in rest)


def test_that_a_rule_is_soft_in_one_of_them_is_a_difference(tmp_path, capsys):
    (tmp_path / "mild.rules").write_text(
        'rulebook mild\nextends old\nsoften rule no_passing because "seldom"\n'
    )
    for books, soft in ((["mild", "old"], "mild"), (["old", "mild"], "mild")):
        assert main(["diff", *(f"./{name}.rules" for name in books)]) == 1
        assert f"no_passing  soft in {soft}" in capsys.readouterr().out


ON_MUD = """\
rulebook {name}
signal p
topics {{ mud "Deep mud" of ford; lights "Lamps" of lamp }}
{rules}
silent on lamp because "it is day"
"""


def test_any_number_of_books_side_by_side(tmp_path, capsys):
    for name, says in (("a", "Wade."), ("b", "Wade."), ("c", "Walk " + 20 * "on ")):
        rules = [f'hard rule ford {{ cite "1, 2" says "{says}" require never p }}']
        if name == "b":
            rules.append('hard rule ford_at_night { says "Do not." require never p }')
        text = ON_MUD.format(name=name, rules="\n".join(rules))
        (tmp_path / f"{name}.rules").write_text(text)
    asked = ["diff", "./c.rules", "./a.rules", "./b.rules", "--topic", "mud"]
    assert main(asked) == 0
    assert capsys.readouterr().out.splitlines() == [
        "c, a, b on mud: 1, 1, 2 rules (-v: every sentence)",
        "ford",
        "  c  1, 2  Walk on on on on on on on on on on on on on on on on on on on on",
        "  a, b  1, 2  Wade.",
        "ford_at_night",
        "  b  Do not.",
        "  c, a  no rule of this name",
    ]
    assert main([*asked, "--output-format", "markdown"]) == 0
    page = capsys.readouterr().out
    assert "This is no legal advice" in page
    assert "### ford\n\n- **c** (1, 2): Walk on" in page
    assert "\n- **a, b** (1, 2): Wade.\n" in page
    assert "- **b**: Do not.\n- **c, a**: no rule of this name\n" in page
    assert main([*asked, "--output-format", "csv"]) == 0
    rows = list(csv.DictReader(capsys.readouterr().out.splitlines()))
    assert [(row["rule"], row["rulebook"]) for row in rows] == [
        *(("ford", "c"), ("ford", "a"), ("ford", "b"), ("ford_at_night", "b"))
    ]
    assert main([*asked, "--json"]) == 0
    assert len(json.loads(capsys.readouterr().out)["rules"]) == 2
    assert main([*asked, "--all"]) == main(asked[:2] + asked[-2:]) == 2
    assert main([*asked[:-1], "moon"]) == 2
    assert "there is no topic `moon`; there are `lamps`" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("topic", "title", "n_lines"),
    [
        ("speed_advantage", "speed_advantage, only de: ", 40),
        ("lamps", "lights_at_night", 40),
        ("overtaking", "Near-side passing", 40),
    ],
)
def test_a_topic_fits_on_a_screen(topic, title, n_lines, capsys):
    """Whole sentences, a line for each rule, or a line for each topic, whatever fits."""
    assert main(["diff", "de", "fr", "gb", "--topic", topic]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) <= n_lines
    assert any(line.startswith(title.split(",")[0]) for line in lines)
    assert max(map(len, lines)) <= 80


def test_the_answer_in_full(capsys):
    assert main(["diff", "./new.rules", "./old.rules", "-v"]) == 1
    assert (
        capsys.readouterr().out
        == """\
new compared to old; the law of 2020-01-01

leave_room: new is stricter: it forbids all that old forbids, and more
  new forbids, old allows
    state              0
    ─────────────────────────
    station(c)         beside
    side_gap(c) in m   1.5
    0: ego is beside c and the side gap of c is 1.5 m

no_passing: new is laxer: it allows all that old allows, and more
  old forbids, new allows
    state        0         1         2
    ────────────────────────────────────────────
    station(v)   behind    beside    in_front_of
    lateral(v)   right_of  right_of  right_of
    congested    T         T         T
    0: ego is behind v, ego is to the right of v and “traffic is slow and dense”
    1: ego is beside v
    2: ego is in front of v

only in old
  soft rule no_horn; new is silent on it: "in the act on noise"

set otherwise
  parameter least: 2 m in new, 1.5 m in old

the same in both: no_crowd

3 shared rules: 1 equal, 1 stricter, 1 laxer, 1 only in old
"""
    )


def test_a_provision_that_is_inherited_is_not_told_as_ones_own(tmp_path, capsys):
    own = OLD.replace("rulebook old", "rulebook own")
    (tmp_path / "own.rules").write_text(own, encoding="utf-8")
    assert main(["diff", "./new.rules", "./own.rules", "--rule", "leave_room"]) == 1
    told = "  cite: inherited, not confirmed: old § 5 in new, § 5 in own\n"
    assert told in capsys.readouterr().out
    asked = ["diff", "./new.rules", "./own.rules", "--rule", "leave_room", "--output-format", "csv"]
    assert main(asked) == 1
    (row,) = csv.DictReader(capsys.readouterr().out.splitlines())
    assert (row["cite 1"], row["cite 2"]) == ("inherited, not confirmed: old § 5", "§ 5")


def test_a_rulebook_does_not_differ_from_itself(capsys):
    assert main(["diff", "./old.rules", "./old.rules"]) == 0
    assert capsys.readouterr().out.endswith("4 shared rules: 4 equal\n")


def test_the_witnesses_do_as_promised(capsys):
    assert main(["diff", "./new.rules", "./old.rules", "--witness", "found.jsonl"]) == 1
    assert capsys.readouterr().err == "wrote 2 traces to found.jsonl\n"
    verdicts = {}
    for book in ("old", "new"):
        assert main(["verify", "found.jsonl", "-r", f"./{book}.rules", "--json"]) == 1
        lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
        verdicts[book] = {
            line["trace"]: [one["rule"] for one in line["violations"]] for line in lines
        }
    assert verdicts == {
        "new": {
            "leave_room: new forbids, old allows": ["leave_room"],
            "no_passing: old forbids, new allows": [],
        },
        "old": {
            "leave_room: new forbids, old allows": [],
            "no_passing: old forbids, new allows": ["no_passing"],
        },
    }


def test_json(capsys):
    assert main(["diff", "./new.rules", "./old.rules", "--output-format", "json"]) == 1
    found = json.loads(capsys.readouterr().out)
    relations = {one["rule"]: one["relation"] for one in found["rules"]}
    assert relations == {"leave_room": "stricter", "no_passing": "laxer", "no_crowd": "equal"}
    room = found["rules"][0]
    assert room["second_forbids"] == []
    assert room["first_forbids"][0]["objects"] == {"c": "cyclist"}
    assert room["first_forbids"][0]["states"][0]["side_gap"] == {"c": 1.5}
    assert [one["because"] for one in found["only_second"]] == ["in the act on noise"]
    assert found["settings"] == [
        {"kind": "parameter", "name": "least", "first": "2 m", "second": "1.5 m"}
    ]


def test_csv(capsys):
    assert main(["diff", "./new.rules", "./old.rules", "--output-format", "csv"]) == 1
    rows = list(csv.DictReader(capsys.readouterr().out.splitlines()))
    assert [(row["rule"], row["relation"]) for row in rows] == [
        ("leave_room", "stricter"),
        ("no_passing", "laxer"),
        ("no_crowd", "equal"),
        ("no_horn", "only in old"),
    ]


def test_a_page(capsys):
    command = ["diff", "./new.rules", "./old.rules", "--output-format", "html", "-o", "page.html"]
    assert main(command) == 1
    assert capsys.readouterr().out == "wrote page.html\n"
    ids, links, words = [], [], []

    class Page(HTMLParser):
        def handle_starttag(self, tag, attrs):
            ids.extend(value for name, value in attrs if name == "id")
            links.extend(value for name, value in attrs if name == "href")

        def handle_data(self, data):
            words.append(data)

    with open("page.html", encoding="utf-8") as stream:  # noqa: PTH123
        Page().feed(stream.read())
    assert {"leave_room: new stricter", "no_passing: old stricter", "no_horn", "no_crowd"} <= {
        *words
    }
    assert "#leave_room-new-stricter" in links
    assert {link.removeprefix("#") for link in links} <= {*ids}
    assert "new forbids, old allows" in words
    assert any(word.startswith("0: ") for word in words), "what happens, in words"


def test_some_rules_only(capsys):
    assert main(["diff", "./new.rules", "./old.rules", "--rule", "no_c*"]) == 0
    assert capsys.readouterr().out.endswith("1 shared rule: 1 equal\n")


@pytest.mark.parametrize("books", [["de", "nl"], ["--all", "de", "nl"]])
def test_a_rule_that_no_rulebook_has_is_no_agreement(books, capsys):
    assert main(["diff", *books, "--rule", "spead_limit"]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert "did you mean `speed_limit`?" in captured.err


def test_strength_is_a_difference(tmp_path, capsys):
    text = 'rulebook mild\nextends old\nsoften rule no_passing because "why not"\n'
    (tmp_path / "mild.rules").write_text(text)
    assert main(["diff", "./mild.rules", "./old.rules", "--rule", "no_passing"]) == 1
    out = capsys.readouterr().out
    assert "no_passing: the same traces are forbidden\n  strength: soft in mild, hard in old" in out


def test_other_types_of_variables(tmp_path, capsys):
    head = "use road hard rule r"
    (tmp_path / "a.rules").write_text(f"rulebook a {head} (v: car) {{ require never beside(v) }}")
    (tmp_path / "b.rules").write_text(f"rulebook b {head} (w: vehicle) {{ require G !beside_w }}")
    assert main(["diff", "./a.rules", "./b.rules", "r"]) == 1
    assert (
        "r: a is laxer: it allows all that b allows, and more\n"
        "  a speaks of (v: car), b speaks of (w: vehicle); of (car), which both speak of:\n"
        "    equal\n"
    ) in capsys.readouterr().out


def test_types_that_the_other_rulebook_lacks(tmp_path, capsys):
    for name, kind in (("a", "car"), ("b", "bus")):
        words = f"type t type {kind} is t signal near(c: t) default false"
        rule = f"hard rule r (c: {kind}) {{ require never near(c) }}"
        (tmp_path / f"{name}.rules").write_text(f"rulebook {name} {words} {rule}")
    assert main(["diff", "./a.rules", "./b.rules", "r"]) == 1
    assert capsys.readouterr().out.splitlines()[2:15] == [
        "r: each forbids something that the other allows",
        "  a speaks of (c: car), b speaks of (c: bus); no objects are of both kinds; a",
        "    has no type bus, b has no type car",
        "  a forbids, b allows",
        "    state       0",
        "    " + "─" * 15,
        "    type of c   car",
        "    near(c)     T",
        "  b forbids, a allows",
        "    state       0",
        "    " + "─" * 15,
        "    type of c   bus",
        "    near(c)     T",
    ]
    assert main(["diff", "./a.rules", "./b.rules", "--json"]) == 1
    (rule,) = json.loads(capsys.readouterr().out)["rules"]
    assert (rule["common_types"], rule["on_common_types"]) == ([], None)


def test_words_that_mean_different_things(tmp_path, capsys):
    for name, unit in (("a", "m"), ("b", "ft")):
        (tmp_path / f"{name}.rules").write_text(
            f"rulebook {name} quantity gap in {unit} hard rule r {{ require always gap > 1 m }}"
        )
    assert main(["diff", "./a.rules", "./b.rules"]) == 2
    assert "\nr  not decided\n" in capsys.readouterr().out
    assert main(["diff", "./a.rules", "./b.rules", "-v"]) == 2
    out = " ".join(capsys.readouterr().out.split())
    assert "r: not decided: `gap` is declared differently in the two" in out


def test_it_takes_two(capsys):
    assert main(["diff", "./old.rules"]) == 2
    assert "with which rulebook is it to be compared?" in capsys.readouterr().err


def test_all(tmp_path, capsys):
    """The treaty comes first, so that its rules are law A; small letters are soft rules."""
    (tmp_path / "third.rules").write_text(
        "rulebook third\nextends old\nset least = 1 m\n"
        'soften rule no_passing because "seldom"\nsilent on no_crowd because "rare"\n'
    )
    assert main(["diff", "--all", "./new.rules", "./old.rules", "./third.rules"]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert [line.split() for line in lines[3:6]] == [
        ["old", "new", "1=", "1+", "1-"],
        ["old", "third", "2=", "1+"],
        ["new", "third", "1+", "1-"],
    ]
    rules = dict(line.split(maxsplit=1) for line in lines[11:16])
    assert rules == {
        "old": "new  third",
        "leave_room": "A    B    C",
        "no_passing": "A    B    a",
        "no_horn": "a    /    a",
        "no_crowd": "a    a    /",
    }
    assert (
        lines[-1] == "3 rulebooks, 4 rules that two or more of them have, 2 of them the same in all"
    )


def test_all_is_written_pair_by_pair(tmp_path, monkeypatch, capsys):
    """What the first two rulebooks share is written before the last one is read."""
    (tmp_path / "third.rules").write_text("rulebook third\nextends old\n")
    written = []
    own = rulebook_reader.read_rulebook

    def read(reference, *more):
        written.append(("third" in reference, capsys.readouterr().out))
        return own(reference, *more)

    monkeypatch.setattr(rulebook_reader, "read_rulebook", read)
    assert main(["diff", "--all", "./new.rules", "./old.rules", "./third.rules"]) == 1
    assert [is_third for is_third, _ in written] == [False, False, True]
    assert written[-1][1].splitlines()[-1].split() == ["old", "new", "1=", "1+", "1-"]


def test_all_as_data(capsys):
    assert main(["diff", "--all", "./new.rules", "./old.rules", "--output-format", "csv"]) == 1
    rows = list(csv.DictReader(capsys.readouterr().out.splitlines()))
    assert [tuple(row.values()) for row in rows if row["rule"] == "leave_room"] == [
        ("leave_room", "old", "new", "laxer"),
        ("leave_room", "new", "old", "stricter"),
    ]
    assert main(["diff", "--all", "./new.rules", "./old.rules", "--output-format", "json"]) == 1
    found = json.loads(capsys.readouterr().out)
    (pair,) = [one for one in found["pairs"] if one["first"] == "old"]
    assert pair == {
        "first": "old",
        "second": "new",
        "equal": 1,
        "stricter": 1,
        "laxer": 1,
        "incomparable": 0,
        "undecided": 0,
        "only": 1,
        "silent": 1,
    }


def test_all_that_are_the_same(capsys):
    command = ["diff", "--all", "./new.rules", "./old.rules", "--rule", "no_crowd"]
    assert main(command) == 0


def test_all_goes_on_without_what_cannot_be_read(capsys):
    assert main(["diff", "--all", "./new.rules", "./old.rules", "./none.rules"]) == 2
    out, err = capsys.readouterr()
    assert "2 rulebooks" in out
    assert "none.rules" in err


def test_two_sides_of_the_road(tmp_path, capsys):
    for name, traffic in (("one", "right"), ("other", "left")):
        (tmp_path / f"{name}.rules").write_text(
            f"rulebook {name}\nuse road\ntraffic {traffic}\n"
            "hard rule r (v: vehicle) { require never (beside(v) and near_side_of(v)) }\n"
        )
    remark = "one drives on the right, other on the left: near and far change sides"
    assert main(["diff", "./one.rules", "./other.rules"]) == 1
    assert capsys.readouterr().out.splitlines()[1] == remark
    main(["diff", "./one.rules", "./other.rules", "--output-format", "markdown"])
    assert f"\n{remark}.\n" in capsys.readouterr().out
    main(["diff", "./one.rules", "./one.rules"])
    assert "near and far" not in capsys.readouterr().out


def test_rules_of_other_names_are_offered_and_paired(tmp_path, capsys):
    keeps = "hard rule keep_gap (v: vehicle) { require never (behind(v) and gap(v) < 9 m) }"
    follows = "hard rule following (c: vehicle) { require never (behind(c) and gap(c) < 5 m) }"
    for name, rule in (("one", keeps), ("two", follows)):
        text = f"rulebook {name}\nuse road\n{rule}\nhard rule at_{name} {{ require never wet }}\n"
        (tmp_path / f"{name}.rules").write_text(text)
    books = (str(tmp_path / "one.rules"), str(tmp_path / "two.rules"))
    assert main(["diff", *books, "--rule", "[kf]*"]) == 1
    offer = "    reads the same words as following: --pair keep_gap=following\n"
    assert offer in capsys.readouterr().out
    pairs = ("--pair", "keep_gap=following", "--pair", "at_one=at_two")
    assert main(["diff", *books, *pairs, "--output-format", "json"]) == 1
    document = json.loads(capsys.readouterr().out)
    assert [
        (pair["rule"], pair["second_rule"], pair["relation"]) for pair in document["rules"]
    ] == [("keep_gap", "following", "stricter"), ("at_one", "at_two", "equal")]
    assert document["only_first"] == document["only_second"] == []
    for wrong, why in (("keep_gap", "no pair"), ("keep_gap=folowing", "did you mean `following`?")):
        assert main(["diff", *books, "--pair", wrong]) == 2
        assert why in capsys.readouterr().err


def test_what_was_found_is_kept_until_a_source_changes(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("RULEC_CACHE_DIR", str(tmp_path / "cache"))
    rule = "signal p, q\nhard rule r {{ require always ({}) }}\n"
    (tmp_path / "a.rules").write_text(f"rulebook a\n{rule.format('p and q')}")
    (tmp_path / "b.rules").write_text(f"rulebook b\n{rule.format('p')}")

    def said(*options):
        return main(["diff", "./a.rules", "./b.rules", *options]), capsys.readouterr().out

    first = said()
    assert first[0] == 1
    assert "stricter" in first[1]
    with monkeypatch.context() as patched:
        patched.setattr("rulec.Session.diff", None)
        assert said() == first
        assert said("--no-cache")[0] == 70
    assert json.loads(said("--json")[1])["version"] == 1
    (tmp_path / "a.rules").write_text(f"rulebook a\n{rule.format('p')}")
    assert said()[0] == 0


def test_what_a_rulebook_leaves_unsaid_as_its_parent_does_is_said_so(tmp_path, capsys):
    (tmp_path / "newer.rules").write_text("rulebook newer\nextends new\n")
    assert main(["diff", "./newer.rules", "./old.rules", "-v"]) == 1
    assert (
        '  soft rule no_horn; newer is silent on it, as new is: "in the act on noise"\n'
        in capsys.readouterr().out
    )


def test_no_limit_is_said_in_words(tmp_path, capsys):
    rule = "hard rule slow {{ require always speed <= {} }}\n"
    for name, bound in (("strict", "30 km/h"), ("signed", "limit")):
        text = f"rulebook {name}\nuse road\n" + rule.format(bound)
        (tmp_path / f"{name}.rules").write_text(text, encoding="utf-8")
    assert main(["diff", "./strict.rules", "./signed.rules", "-v"]) == 1
    assert "limit in km/h   no sign" in capsys.readouterr().out
