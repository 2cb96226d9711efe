"""``rulec analyze``: every kind of finding in small rulebooks, and on random rules."""

from functools import reduce
from itertools import product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rulec import analyze
from rulec.analysis.diff.rule_comparison import compare
from rulec.analysis.lint.conflict_search import conflict
from rulec.analysis.lint.questions import RuleAnswers
from rulec.analysis.lint.redundancy import can_be_kept, can_be_violated, implied_by
from rulec.cli.main import main
from rulec.logic.formula import Atom, Binary, BinaryOperator, Unary, UnaryOperator
from rulec.trace import Trace
from rulec.witnesses.undecided import UndecidedError
from support.generators.random_rule_pairs import ALONE, COUNTED, X, allows, formulas, sides, states

OBJECTS = {"x": "thing"}
STATES = list(states(OBJECTS, ["p", "place"]))
LONGEST = 3
WORDS = [word for length in range(1, LONGEST + 1) for word in product(STATES, repeat=length)]
BOTH = st.sampled_from(["stutter", "finite"])


def trace(states):
    return Trace("t", 1.0, OBJECTS, tuple(states))


@settings(max_examples=settings().max_examples // 2)
@given(formulas(ALONE[:3]), BOTH)
def test_what_can_be_violated_and_kept(formula, semantics):
    (side,) = sides([formula], [X], [semantics])
    verdicts = {allows(side, trace(word)) for word in WORDS}
    # A formula of four leaves may need a longer word; what a short one shows is certain.
    assert can_be_violated(side) >= (False in verdicts)
    assert can_be_kept(side) >= (True in verdicts)
    if not can_be_violated(side):
        assert verdicts == {True}
    if not can_be_kept(side):
        assert verdicts == {False}


@settings(max_examples=settings().max_examples // 2)
@given(st.tuples(*[formulas(ALONE[:3])] * 3), BOTH)
def test_what_others_imply_they_forbid(three, semantics):
    one, *others = sides(three, [X], [semantics] * 3)
    premises = implied_by(one, others)
    if premises:
        for word in WORDS:
            if not allows(one, trace(word)):
                assert not all(allows(other, trace(word)) for other in premises)
    else:
        assert all(compare(one, other).relation in ("stricter", "incomparable") for other in others)


def joined(formulas):
    return reduce(lambda left, right: Binary(BinaryOperator.AND, left, right), formulas)


def begins_with(prefix):
    """That a trace begins with these states, as a formula."""
    here = [
        Atom("place", ("x",), prefix[0]["place"]["x"]),
        Atom("p") if prefix[0]["p"] else Unary(UnaryOperator.NOT, Atom("p")),
    ]
    later = [Unary(UnaryOperator.NEXT, begins_with(prefix[1:]))] if prefix[1:] else []
    return joined([*here, *later])


def could_be_kept(rules, semantics, prefix):
    """By the automaton of all that is asked, at once: a way of its own to the answer."""
    start = [begins_with(prefix)] if prefix else []
    return can_be_kept(*sides([joined([*start, *rules])], [X], [semantics]))


@settings(max_examples=settings().max_examples // 2)
@given(st.tuples(*[formulas(ALONE[:3])] * 2), BOTH)
def test_conflicts(pair, semantics):
    found = conflict(sides(pair, [X], [semantics] * 2))
    prefixes = [(), *product(STATES, repeat=1)]
    if found is not None:
        prefix = () if found.trace is None else found.trace.states
        prefix = [{"p": False, **state} for state in prefix]
        assert not could_be_kept(pair, semantics, prefix)
        assert all(could_be_kept([rule], semantics, prefix) for rule in pair)
        prefixes = [one for one in prefixes if len(one) < len(prefix)]
    for prefix in prefixes:
        if all(could_be_kept([rule], semantics, prefix) for rule in pair):
            assert could_be_kept(pair, semantics, prefix)


def test_counts_can_be_met_by_further_objects():
    (side,) = sides([COUNTED[2]], [], ["stutter"])
    assert can_be_violated(side)
    assert can_be_kept(side)


HEAD = """\
rulebook example
light is one of red, green
signal wet, fog, slow
quantity speed in km/h
"""


@pytest.mark.parametrize(
    ("rules", "expected"),
    [
        ("hard rule r { require always (red or green) }", ["R0801"]),
        ("hard rule r { require eventually (red and green) }", ["R0802"]),
        # What is found of a rule by itself is not found again with others.
        (
            "hard rule r { require always (wet or not wet) } hard rule s { require never wet }",
            ["R0801 `r`"],
        ),
        (
            "hard rule r { require never wet } hard rule s { require never (wet and fog) }",
            ["R0803 `s` adds nothing: `r` forbids"],
        ),
        (
            "hard rule r { require never wet } hard rule s { require always not wet }",
            ["R0803 `s` adds nothing: `r` forbids"],
        ),
        (
            (
                "hard rule r { require never (wet and fog) } hard rule s { require never "
                "(wet and not fog) } hard rule t { require never wet }"
            ),
            ["R0803 `t` adds nothing: `r` and `s` together"],
        ),
        (
            (
                "hard rule r { require never (wet and fog) } hard rule s { require never "
                "(slow and not fog) } hard rule t { require never (wet and slow) }"
            ),
            ["R0803 `t` adds nothing: `r` and `s` together forbid"],
        ),
        # What contradicts itself implies everything: only the contradiction is worth saying.
        (
            (
                "hard rule r { require always speed > 0 km/h } "
                "hard rule s { require always speed = 0 km/h } "
                "hard rule t { require always (wet or speed > 50 km/h) }"
            ),
            ["R0804 `r` and `s` cannot both"],
        ),
        # It implies a rule that others need none the less.
        (
            (
                "hard rule r { require always (wet implies fog) } hard rule s { require never wet }"
                " hard rule t { require always ((wet and fog) xor wet) }"
            ),
            ["R0803 `r` adds nothing: `s`", "R0804 `r` and `t`", "R0804 `s` and `t`"],
        ),
        ("hard rule r { require never wet } soft rule s { require never wet }", ["R0803 `s`"]),
        (
            "soft rule r { require never wet } hard rule s { require never (wet and fog) }",
            [],
        ),
        (
            (
                "hard rule r { require always (wet implies next slow) } "
                "hard rule s { require always (wet implies next not slow) }"
            ),
            ["R0804 cannot both be kept after some trace; after the trace: { wet }"],
        ),
        (
            "hard rule r { require eventually wet } hard rule s { require never wet }",
            ["R0804 cannot both be kept at all"],
        ),
        (
            (
                "hard rule r { require always (wet implies next (slow or fog)) } "
                "hard rule s { require never (wet and next slow) } "
                "hard rule t { require never (wet and next fog) }"
            ),
            ["R0804 `r`, `s` and `t` cannot all be kept after some trace; after the trace: { wet"],
        ),
        (
            "hard rule r { require eventually wet } soft rule s { require never wet }",
            [],
        ),
        *[
            (f"{first} {second}", ["R0808 `r` and `s` cannot both be kept where `wet`"])
            for first, second in (
                (
                    "hard rule r { require always (wet implies speed < 3 km/h) }",
                    "hard rule s { require always (wet implies speed > 5 km/h) }",
                ),
                (
                    "hard rule r { require always slow when wet }",
                    "hard rule s { require never slow when wet }",
                ),
                # The condition of the second rule alone is one that the two never come to.
                (
                    "hard rule r { require never (wet and slow) }",
                    "hard rule s { require always (wet implies slow) }",
                ),
            )
        ],
        *[
            (f"hard rule r {{ require always (wet implies slow) }} {second}", found)
            for second, found in (
                ("soft rule s { require never (wet and slow) }", []),
                # Who is in fog, too, may be slow; what nobody need do is no contradiction.
                ("hard rule s { require never (wet and slow) unless fog }", []),
                ("hard rule s { require always (fog implies not slow) }", []),
                ("hard rule s { require never (wet and fog) }", []),
                # One alone forbids what the other is about.
                ("hard rule s { require never wet }", ["R0803 `r`"]),
            )
        ],
        (
            "hard rule r { require never wet unless fog } hard rule s { require never fog }",
            [],
        ),
        (
            "hard rule r { require always (speed < 3 km/h and speed > 5 km/h implies wet) }",
            ["R0805 `implies`"],
        ),
        ("hard rule r { require never (red and green then wet) }", ["R0805 phase"]),
        ("hard rule r { require never wet when red and green }", ["R0805 `when`"]),
        ("hard rule r { require never wet unless red and green }", ["R0805 exception"]),
        ("hard rule r { require always (red and slow implies wet) }", []),
        ("option on_ice = off hard rule r { require never wet unless on_ice and fog }", []),
        *[
            (f"option off_road = off hard rule r {{ require {formula} }}", ["R0801 nothing"])
            for formula in (
                "never (wet then false then wet)",
                "always (wet or true)",
                "always (wet implies true)",
                "always (off_road implies wet)",
                "never wet when false",
                "never wet unless true",
            )
        ],
        (
            (
                "hard rule r { require always wet } "
                "hard rule s { require never wet unless red and green }"
            ),
            ["R0805 exception", "R0804 cannot both be kept at all"],
        ),
        (
            (
                "hard rule r { require never wet } "
                "hard rule s { require never (wet and fog) unless red and green }"
            ),
            ["R0805 exception", "R0803 `s` adds nothing"],
        ),
    ],
)
def test_findings(rules, expected, tmp_path):
    path = tmp_path / "example.rules"
    path.write_text(HEAD + rules)
    found = analyze(path)
    assert len(found) == len(expected), found
    for one, words in zip(found, expected, strict=True):
        text = " ".join([one.code, one.message, *one.notes])
        assert all(word in text for word in words.split(" ")), text


def test_rules_contradict_each_other_only_where_all_of_it_is_decided(tmp_path, monkeypatch):
    path = tmp_path / "example.rules"
    path.write_text(
        f"{HEAD}hard rule r {{ require always (wet implies slow) }} "
        "hard rule s { require never (wet and slow) }"
    )
    assert [one.code for one in analyze(path)] == ["R0808"]
    decide, asked = RuleAnswers.conflict, []

    def undecided(answers, names):
        asked.append(tuple(names))
        if len(names) == 2:
            raise UndecidedError("it is too large")
        return decide(answers, names)

    monkeypatch.setattr(RuleAnswers, "conflict", undecided)
    assert "R0808" not in [one.code for one in analyze(path)]
    assert {len(names) for names in asked} == {2, 3}


def test_no_trace_violates_what_only_a_change_of_what_cannot_change_would(tmp_path):
    """Who tows in the first state tows in the second one, too."""
    path = tmp_path / "example.rules"
    path.write_text(
        f"{HEAD}signal towed default false constant towed "
        "hard rule r { require never (wet and towed then fog and not towed) }"
    )
    (found,) = analyze(path)
    assert found.code == "R0801"


def test_a_number_that_cannot_change_is_not_looked_for(tmp_path):
    path = tmp_path / "example.rules"
    path.write_text(
        f"{HEAD}quantity load in t default 0 constant load "
        "hard rule r { require never (wet and load > 1 t then fog and load < 1 t) }"
    )
    (found,) = analyze(path)
    assert found.code == "R0807"
    assert "`load`, which cannot change, would have to" in found.message


def test_weaker_than_what_is_extended(tmp_path):
    (tmp_path / "base.rules").write_text(
        HEAD.replace("example", "base") + "hard rule r { require never wet }\n"
        "hard rule s { require never fog }\nhard rule t { require never slow }\n"
        'hard rule u { require never red cite "1" }\n'
    )
    path = tmp_path / "example.rules"
    path.write_text(
        "rulebook example\nextends base\noverride rule r { unless fog }\n"
        'soften rule s\ndrop rule t because "so"\noverride rule u { require never (red or wet) }\n'
    )
    found = analyze(path)
    assert [(one.code, one.message.split(" than ")[0]) for one in found] == [
        ("R0803", "rule `r` adds nothing: `u` forbids all that it forbids"),
        ("R0806", "rule `r` is laxer"),
        ("R0806", "rule `s` is softer"),
    ]
    assert found[1].notes == ("`base` forbids: { wet and fog }",)
    # One is overridden in line 3, the other stands in the base and is softened in line 4.
    assert [(one.place.file, one.place.line) for one in found[1:]] == [
        (str(path), 3),
        (str(path), 4),
    ]
    assert [one.place.file for one in found[2].labels] == [str(tmp_path / "base.rules")]


def test_the_line_that_weakens_an_inherited_rule(tmp_path):
    base, path = tmp_path / "base.rules", tmp_path / "example.rules"
    base.write_text(
        "rulebook base\nuse road\noption strict = on\nparam most = 50 km/h\n"
        "define quick = speed > most\ndefine idle = tunnel\n"
        "hard rule r { require never (quick or idle) }\n"
        "hard rule s { require never (congested and strict) }\n"
        "hard rule t { require never stop_sign }\n"
        "hard rule u { require never red_light }\n"
    )
    path.write_text(
        "rulebook example\nextends base\nset strict = off\nset most = 60 km/h\n"
        "redefine idle = tunnel and congested\n"
        'soften rule t because "the treaty allows it"\nsoften rule u\n'
    )
    found = [one for one in analyze(path) if one.code == "R0806"]
    places = {one.message.split()[1]: one.place.line for one in found}
    assert places == {"`r`": 4, "`s`": 3, "`u`": 7}
    (of_two,) = [one for one in found if "`r`" in one.message]
    assert [(label.place.line, label.message) for label in of_two.labels] == [
        (5, "this changes it, too"),
        (7, "the rule is inherited from here"),
    ]


def test_a_reason_to_soften_is_none_to_set(tmp_path):
    (tmp_path / "base.rules").write_text(
        "rulebook base\nuse road\nparam most = 50 km/h\n"
        "hard rule r { require always (speed <= most) }\n"
    )
    path = tmp_path / "example.rules"
    path.write_text(
        "rulebook example\nextends base\nset most = 60 km/h\n"
        'soften rule r because "the treaty allows it"\n'
    )
    (only,) = analyze(path)
    assert only.message.startswith("rule `r` is laxer")
    assert (only.code, only.place.line) == ("R0806", 3)


def test_of_what_type_the_objects_are_that_a_weaker_rule_leaves_out(tmp_path):
    (tmp_path / "base.rules").write_text(
        "rulebook base\nuse road\nhard rule r (v: vehicle) { require never beside(v) }\n"
    )
    path = tmp_path / "example.rules"
    path.write_text("rulebook example\nextends base\noverride rule r (v: truck) { }\n")
    (only,) = analyze(path)
    assert only.code == "R0806"
    assert only.notes == (
        "`base` forbids, for `v: vehicle` where this rule has `v: truck`: { beside(v) }",
    )


def test_what_is_extended_is_for_the_same_side_of_traffic(tmp_path):
    (tmp_path / "base.rules").write_text(
        "rulebook base\nuse road\ntraffic right\n"
        "hard rule r (v: vehicle) { require never (beside(v) and near_side_of(v)) }\n"
        "hard rule s (v: vehicle) { require never (behind(v) and near_side_of(v)) }\n"
    )
    path = tmp_path / "example.rules"
    path.write_text(
        "rulebook example\nextends base\ntraffic left\n"
        "override rule s (v: vehicle) { unless congested }\n"
    )
    (only,) = analyze(path)
    assert only.message.startswith("rule `s` is laxer")
    assert only.notes == ("`base` forbids: { behind(v) and left_of(v) and congested }",)


def test_an_inherited_rule_that_adds_nothing_is_told_where_it_is_inherited(tmp_path):
    base, path = tmp_path / "base.rules", tmp_path / "own.rules"
    base.write_text(HEAD.replace("example", "base") + "hard rule r { require never (wet and fog) }")
    path.write_text("rulebook own\nextends base\nhard rule s { require never wet }\n")
    (found,) = analyze(path)
    assert (found.code, found.message.partition(":")[0]) == ("R0803", "rule `r` adds nothing")
    assert (found.place.file, found.place.line) == (str(path), 2)
    assert [label.place.file for label in found.labels] == [str(base), str(path)]
    assert "`drop rule r because" in found.help
    # A comment there allows it, which in the other file would allow it everywhere.
    text = path.read_text().replace("base\n", "base  # rulec: allow R0803 because so it is\n")
    path.write_text(text)
    assert analyze(path) == ()


def test_inherited_rules_of_another_step_are_compared_at_one_step(tmp_path):
    soon = "require always (wet implies eventually[<= {} s] fog)"
    (tmp_path / "base.rules").write_text(
        HEAD.replace("example", "base") + f"hard rule r {{ {soon.format(2)} }}\n"
    )
    path = tmp_path / "own.rules"
    path.write_text(f"rulebook own\nextends base\nstep 0.5 s\nhard rule s {{ {soon.format(1)} }}\n")
    (found,) = analyze(path)
    assert found.message == "rule `r` adds nothing: `s` forbids all that it forbids"


def test_a_trace_with_the_objects_that_are_counted_can_be_an_example(tmp_path, capsys):
    """What the other rulebook is said to forbid is a `reject` example that it has."""
    (tmp_path / "base.rules").write_text(
        "rulebook base\ntype lorry\nsignal near(x: lorry), p default false\n"
        "hard rule r { require never (p and some x: lorry (not near(x))) }\n"
        "hard rule s { require never some x: lorry (near(x)) }\n"
    )
    path = tmp_path / "example.rules"
    path.write_text(
        "rulebook example\nextends base\noverride rule r { unless near_by }\n"
        "override rule s { unless p }\nsignal near_by default false\n"
    )
    notes = [note for one in analyze(path) if one.code == "R0806" for note in one.notes]
    traces = [note.removeprefix("`base` forbids: ") for note in notes]
    assert traces == ["(lorry1: lorry) { p and near_by }", "(lorry1: lorry) { near(lorry1) and p }"]
    path.write_text(
        "rulebook example\nextends base\nsignal near_by default false\n"
        f'override rule r {{ reject "r" {traces[0]} }}\n'
        f'override rule s {{ reject "s" {traces[1]} }}\n'
    )
    assert main(["test", str(path)]) == 0
    assert "passed" in capsys.readouterr().out
