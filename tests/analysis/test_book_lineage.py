"""What became of every rule and provision in a chain of rulebooks."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.analysis.lineage.book_lineage import book_lineage_of, read_with_lineage
from rulec.analysis.lineage.rule_lineage import ConstantValue
from rulec.syntax import decode, parse
from support.builders import rulebook_family as island


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    return island.write(tmp_path_factory.mktemp("books"))


@pytest.fixture(scope="module")
def village(path):
    return read_with_lineage(path, at="2024-01-01")[1]


def steps(found, name):
    (history,) = [one for one in found.rules if one.name == name]
    return [(one.book, one.deed, one.clauses, one.because) for one in history.steps]


def settings(found, name):
    (history,) = [one for one in found.provisions if one.name == name]
    return list(history.settings)


def test_the_chain(village):
    assert [(one.name, one.file, one.extends) for one in village.books] == [
        ("mainland", "mainland.rules", ""),
        ("island", "island.rules", "mainland"),
        ("village", "village.rules", "island"),
    ]
    assert village.books[1].title == "Rules of the island"
    assert (village.books[1].law, village.books[1].as_of) == ("Island Act", "2024-01-01")
    assert village.book == "village"


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("kept", [("mainland", "declared", (), "")]),
        (
            "changed",
            [
                ("mainland", "declared", (), ""),
                # Its certainty is said again, but it is the same.
                ("island", "overridden", ("cite", "source", "require"), ""),
                ("village", "overridden", ("says",), ""),
            ],
        ),
        (
            "softer",
            [
                ("mainland", "declared", (), ""),
                ("island", "softened", ("hard or soft", "weight"), "only recommended"),
            ],
        ),
        (
            "agreed",
            [
                ("mainland", "declared", (), ""),
                ("island", "confirmed", ("cite", "source", "certainty", "examples"), ""),
            ],
        ),
        (
            "taken_out",
            [
                ("mainland", "declared", (), ""),
                ("island", "dropped", (), "there are no sirens"),
            ],
        ),
        (
            "left_open",
            [("mainland", "declared", (), ""), ("island", "silent", (), "nobody knows")],
        ),
        ("parking", [("island", "silent", (), "left to the villages")]),
        ("own", [("village", "declared", (), "")]),
    ],
)
def test_every_rule(village, name, expected):
    assert steps(village, name) == expected


def test_the_rule_before_and_after(village):
    (changed,) = [one for one in village.rules if one.name == "changed"]
    assert changed.rule.says.value == "Be slow, please."
    assert changed.rule.cite.value == "§ 10a"
    # The village has changed something else.
    assert changed.cited_by == "island"
    assert village.inherited_from(changed) == ""
    assert changed.before("village").says.value == "Be slow."
    (gone,) = [one for one in village.rules if one.name == "taken_out"]
    assert gone.rule is None
    (own,) = [one for one in village.rules if one.name == "own"]
    assert own.before("village") is None


def test_options_and_definitions(village):
    assert settings(village, "strict") == [
        ConstantValue("mainland", "off"),
        ConstantValue("village", "on", current=True),
    ]
    assert settings(village, "slow") == [
        ConstantValue("mainland", "speed <= pace"),
        ConstantValue("island", "speed < pace", current=True),
    ]


@pytest.mark.parametrize(
    ("book", "at", "current"),
    [
        ("mainland", "2021-12-31", "30 km/h"),
        ("mainland", "2022-01-01", "25 km/h"),
        # The nearest book's value counts on all days on which there is one.
        ("village", "2021-12-31", "20 km/h"),
    ],
)
def test_the_value_that_counts_on_a_day(path, book, at, current):
    found = settings(read_with_lineage(path.with_stem(book), at=at)[1], "pace")
    assert [one.text for one in found if one.current] == [current]


def test_a_definition_with_parameters():
    text = "rulebook r type t signal near(o: t) define d(v: t, side) = near(v) and side(v)"
    file, _ = parse(decode("r.rules", text.encode()))
    (one,) = book_lineage_of([file], "2024-01-01").provisions
    assert (one.kind, one.head) == ("definition", "d(v: t, side)")


BASE = (
    "rulebook base type t signal near(o: t), p default false "
    "lateral(o: t) is one of left_of, right_of default left_of "
    "define d(v: t, side) = near(v) and side(v)"
)
REDEFINED = "rulebook child extends base redefine d(other: t, where) = where(other) and p"


def test_each_meaning_of_a_definition_is_under_its_own_head():
    files = [parse(decode("r.rules", text.encode()))[0] for text in (BASE, REDEFINED)]
    (one,) = book_lineage_of(files, "2024-01-01").provisions
    assert one.head == "d(other: t, where)"
    assert [(value.head, value.text) for value in one.settings] == [
        ("d(v: t, side)", "near(v) and side(v)"),
        ("", "where(other) and p"),
    ]


def test_what_rules_speak_of(village):
    # `changed` speaks of `slow`, which speaks of `pace`.
    assert {one.name: one.used for one in village.provisions} == {
        "strict": False,
        "pace": True,
        "slow": True,
        "never_used": False,
        "fastest": False,
    }


def test_what_only_a_dropped_rule_speaks_of_is_not_used():
    texts = (
        "rulebook a\nsignal p\noption o = on\nhard rule r { require o implies p }",
        'rulebook b\nextends a\ndrop rule r because "no"',
    )
    files = [parse(decode("x", text.encode()))[0] for text in texts]
    assert [book_lineage_of(files[:n], "2024-01-01").provisions[0].used for n in (1, 2)] == [
        True,
        False,
    ]


def test_the_provision_that_a_value_is_from():
    texts = (
        'rulebook a\noption o = off cite "s. 1"\nparam n = 2 cite "s. 2"\n',
        'rulebook b\nextends a\nset o = on cite "by-law 1"\nset n = 3\n',
    )
    files = [parse(decode("r.rules", text.encode()))[0] for text in texts]
    found = book_lineage_of(files, "2024-01-01")
    assert [value.cite for value in settings(found, "o")] == ["s. 1", "by-law 1"]
    assert [value.cite for value in settings(found, "n")] == ["s. 2", ""]


def test_the_comment_beside_a_value(village):
    assert [one.note for one in settings(village, "pace")] == ["What signs said.", "", ""]


deeds = st.lists(st.sampled_from(["keep", "override", "soften", "drop", "silent"]), max_size=6)


@given(deeds)
def test_it_agrees_with_the_rulebook_as_meant(done):
    """What the history says is left of a rule is what is in the rulebook that comes out."""
    said = {
        "override": 'override rule r { says "b%d" }',
        "soften": "soften rule r weight %d",
        "drop": 'drop rule r because "b%d"',
        "silent": 'silent on r because "b%d"',
    }
    texts = ['rulebook b0 signal p hard rule r { says "b0" require p }']
    gone = False
    for number, deed in enumerate(done, 1):
        word = said.get(deed, "") if not gone else ""
        gone = gone or deed in ("drop", "silent")
        item = word % number if word else ""
        texts.append(f"rulebook b{number} extends b{number - 1} {item}")
    files = [parse(decode("x", text.encode()))[0] for text in texts]
    (history,) = book_lineage_of(files, "2024-01-01").rules

    from rulec.rulebook.resolve import resolve

    rulebook = resolve(files, at="2024-01-01").rulebook
    if gone:
        assert (history.rule, rulebook.rules) == (None, ())
        assert rulebook.remarks[-1].because == history.last.because
    else:
        (rule,) = rulebook.rules
        assert rule.says == history.rule.says.value
        assert rule.strength == history.rule.strength
        assert str(rule.weight) == (history.rule.weight.text if history.rule.weight else "1")


def test_softening_may_change_level_and_weight():
    sources = [
        "rulebook a priority low, high signal p hard rule r { require p }",
        "rulebook b extends a soften rule r in high weight 2",
    ]
    files = [parse(decode("x", text.encode()))[0] for text in sources]
    lineage = book_lineage_of(files, "2024-01-01")
    (history,) = lineage.rules
    assert (history.rule.strength, history.rule.level.text) == ("soft", "high")
    assert history.steps[0].rule.weight != history.rule.weight
    assert history.last.clauses == ("hard or soft", "level", "weight")
