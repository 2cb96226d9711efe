"""Which lines of a rulebook are named as those that make an inherited rule weaker."""

import pytest

from rulec.api.verbs import analyze

WORDS = "rulebook base\nsignal p, q default false\noption opt = off\n"
NEAR = "type car\nsignal near(c: car) default false\n"
RULE_A = "define d(c: car) = near(c)\nhard rule a (c: car) { require never d(c) }\n"


def lines_named(tmp_path, base, *extending):
    """The lines that the finding about rule `a` names as changing it, the first one first."""
    (tmp_path / "base.rules").write_text(WORDS + NEAR + base)
    below = "base"
    for number, text in enumerate(extending):
        path = tmp_path / f"book{number}.rules"
        path.write_text(f"rulebook book{number}\nextends {below}\n{text}")
        below = f"book{number}"
    (of_a,) = [one for one in analyze(path) if one.code == "R0806" and "`a`" in one.message]
    others = [label.place.line for label in of_a.labels if label.message == "this changes it, too"]
    return [of_a.place.line, *others]


BOTH = "set opt = on\nredefine d(c: car) = near(c) and p\n"


@pytest.mark.parametrize(
    "further",
    [
        # A rule has the name of the variable of `a`, or of its definition.
        "hard rule c { require never (q and opt) }\n",
        "hard rule d { require never (q and opt) }\n",
        "hard rule near { require never (q and opt) }\n",
    ],
)
def test_a_rule_of_the_name_of_a_variable_is_another_thing(tmp_path, further):
    assert lines_named(tmp_path, RULE_A + further, BOTH) == [4]


@pytest.mark.parametrize(
    "rules",
    [
        # A variable has the name of the option.
        "define d(opt: car) = near(opt)\nhard rule a (c: car) { require never d(c) }\n",
        "define d(c: car) = near(c)\nhard rule a (opt: car) { require never d(opt) }\n",
        "define d(c: car) = near(c)\nhard rule a { require never (some opt: car (d(opt))) }\n",
    ],
)
def test_a_variable_of_the_name_of_an_option_is_another_thing(tmp_path, rules):
    assert lines_named(tmp_path, rules, BOTH) == [4]


def test_an_option_beside_a_variable_of_its_name_counts(tmp_path):
    rule = (
        "define d(c: car) = near(c)\n"
        "hard rule a { require never (not opt and some opt: car (d(opt))) }\n"
    )
    assert lines_named(tmp_path, rule, BOTH) == [3, 4]


def test_a_definition_that_does_not_use_an_option_any_more(tmp_path):
    base = "define d(c: car) = near(c) and not opt\nhard rule a (c: car) { require never d(c) }\n"
    assert lines_named(tmp_path, base, BOTH) == [4]


def test_a_rule_that_does_not_use_an_option_any_more(tmp_path):
    base = "define d(c: car) = near(c)\nhard rule a (c: car) { require never (d(c) or opt) }\n"
    between = "override rule a (c: car) { require never d(c) }\n"
    assert lines_named(tmp_path, base, between, BOTH) == [4]


def test_an_option_behind_two_definitions_and_one_in_a_bound(tmp_path):
    base = (
        "param most : duration = 2 s\ndefine e = not opt\ndefine d(c: car) = near(c) and e\n"
        "hard rule a (c: car) { require always (d(c) implies eventually[<= most] p) }\n"
    )
    assert lines_named(tmp_path, base, "set opt = on\nset most = 3 s\n") == [3, 4]


def help_on_needless(tmp_path, own):
    """The help about the rule that the base has twice, in a rulebook with lines of its own."""
    (tmp_path / "base.rules").write_text(
        "rulebook base\nsignal p, q default false\noption opt = on\n"
        "hard rule wide { require never p }\n"
        "hard rule narrow { require never (p and q and opt) }\n"
    )
    path = tmp_path / "own.rules"
    path.write_text(f"rulebook own\nextends base\n{own}")
    (found,) = [one for one in analyze(path) if one.code == "R0803" and "`narrow`" in one.message]
    return found.help


@pytest.mark.parametrize(
    ("own", "of_base"),
    [
        ("", True),
        # One's own rule implies it, too, or alone.
        ("hard rule other { require never q }\n", True),
        ("soften rule wide\nhard rule other { require never q }\n", False),
        ('override rule wide { says "Not p." require never p }\n', False),
        ("fact p implies q\n", False),
    ],
)
def test_what_a_base_has_twice_is_not_for_its_heir_to_mend(tmp_path, own, of_base):
    said = "it is so in `base`: there is nothing to change in this rulebook"
    assert (help_on_needless(tmp_path, own) == said) is of_base
