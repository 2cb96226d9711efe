"""``rulec test`` as its user meets it."""

import json
import re
from pathlib import Path
from xml.etree import ElementTree

import pytest

from rulec.cli.main import main

ODD = """\
rulebook odd
use paper
hard rule A (v: vehicle) {
  require always not r(v)
  accept { b(v); l(v) }
  accept "to <&> right" { b(v);
     r(v); f(v) }
  reject { b(v); l(v) }
}
hard rule B (v: vehicle) {
  require eventually f(v)
  accept "never" { b(v); l(v) }
}
"""


@pytest.fixture
def odd(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "odd.rules").write_text(ODD)
    return "odd.rules"


def run(capsys, *arguments):
    status, out, err = brief(capsys, "-v", *arguments)
    return status, out, err


def brief(capsys, *arguments):
    """The status and what is said, without how long it took."""
    status = main(["test", *arguments])
    out, err = capsys.readouterr()
    return status, re.sub(r" in [0-9.]+ s$", "", out, flags=re.MULTILINE), err


def test_what_passes_is_counted(capsys):
    assert main(["test", "esterle2019"]) == 0
    assert re.fullmatch(r"14 examples passed in [0-9]+\.[0-9] s\n", capsys.readouterr().out)


def test_only_what_fails_is_shown(odd, capsys):
    status, out, _ = brief(capsys, odd)
    assert (status, out.splitlines()[-1]) == (1, "4 examples: 1 passed, 3 failed")
    assert out.startswith("error[R0406]: example `to <&> right` of rule `A`")
    assert len(re.findall(r"^error", out, re.MULTILINE)) == 3
    assert run(capsys, odd)[1].endswith(f"\n\n{out}")


def test_the_rules_that_examples_cover_least_come_first(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    some = "".join(
        f"hard rule R{n} {{ require always (p implies q) accept {{ p and q }} "
        "reject { p and not q } }\n"
        for n in range(40)
    )
    whole = "hard rule whole { require always p accept { p } reject { not p } }\n"
    none = "hard rule none { require always (p or q) }\n"
    Path("many.rules").write_text(f"rulebook many\nsignal p, q\n{some}{whole}{none}")
    _, out, _ = brief(capsys, "many.rules", "--coverage")
    head, first, second, *rest, more, _, _ = out.splitlines()
    assert head == "many: 1 of 42 rules covered as a whole"
    assert first.split("  ") == ["", " 0.0 %", "none", "misses 2 edges, 4 values"]
    # Of two edges and the two values of p and of q only one is missing: that p is false.
    assert second.split() == ["83.3", "%", "R0", "misses", "1", "value"]
    assert len(rest) == 28
    assert more.startswith("  and 11 more; -v says")


def test_what_ships_passes(capsys):
    status, out, err = run(capsys, "esterle2019")
    assert (status, err) == (0, "")
    lines = out.splitlines()
    assert lines[0] == "pass  esterle2019 R1/tau 1"
    assert lines[-1] == "14 examples passed"
    assert len(lines) == 15


def test_failing_examples_say_where_and_what(odd, capsys):
    status, out, err = run(capsys, odd)
    assert (status, err) == (1, "")
    assert out == (
        "pass  odd A/1\n"
        "FAIL  odd A/to <&> right\n"
        "FAIL  odd A/3\n"
        "FAIL  odd B/never\n"
        "\n"
        "error[R0406]: example `to <&> right` of rule `A` says `accept`, but the rule rejects it\n"
        " --> odd.rules:6:3\n"
        "  |\n"
        '6 |   accept "to <&> right" { b(v);\n'
        "  |   ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^\n"
        "7 |      r(v); f(v) }\n"
        "  |      ---- cannot be kept any more after this state\n"
        "  = help: correct the example or the formula; `rulec show` puts the formula into words\n"
        "  = note: the rule cannot be kept any more after state 1, counted from 0\n"
        "\n"
        "error[R0406]: example number 3 of rule `A` says `reject`, but the rule accepts it\n"
        " --> odd.rules:8:3\n"
        "  |\n"
        "8 |   reject { b(v); l(v) }\n"
        "  |   ^^^^^^^^^^^^^^^^^^^^^\n"
        "  = help: correct the example or the formula; `rulec show` puts the formula into words\n"
        "\n"
        "error[R0406]: example `never` of rule `B` says `accept`, but the rule rejects it\n"
        "  --> odd.rules:12:3\n"
        "   |\n"
        '12 |   accept "never" { b(v); l(v) }\n'
        "   |   ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^\n"
        "   = help: correct the example or the formula; `rulec show` puts the formula into words\n"
        "   = note: the rule could still be kept, if the last state did not go on for ever\n"
        "\n"
        "4 examples: 1 passed, 3 failed\n"
    )


@pytest.mark.parametrize(
    ("pattern", "names"),
    [
        ("A", ["A/1", "A/to <&> right", "A/3"]),
        ("*", ["A/1", "A/to <&> right", "A/3", "B/never"]),
        ("A/1", ["A/1"]),
        ("A/[0-9]", ["A/1", "A/3"]),
        ("?/*e*", ["B/never"]),
        ("a", []),
        ("never", []),
    ],
)
def test_patterns(odd, capsys, pattern, names):
    status, out, _ = run(capsys, odd, "--rule", pattern)
    lines = [line for line in out.splitlines() if line.startswith(("pass", "FAIL"))]
    assert [line.split(" ", 3)[3] for line in lines] == names
    assert status == (2 if not names else 0 if names == ["A/1"] else 1)


def test_nothing_to_run_fails_only_if_asked_to(odd, capsys):
    empty = "rulebook empty\nuse paper\nhard rule A (v: vehicle) { require always not r(v) }\n"
    Path("empty.rules").write_text(empty)
    warned = "warning[R0408]: rule `A` has no example\n"
    status, out, err = run(capsys, "empty.rules", "--rule", "A", "--coverage")
    assert (status, err.startswith(warned)) == (0, True)
    assert "coverage 0.0 %\n0 examples passed\n" in out
    status, _, err = run(capsys, "empty.rules", "--rule", "A", "--fail-on-empty")
    assert (status, err.splitlines()[-1]) == (1, "rulec: there is no example to run")


def test_a_pattern_that_matches_nothing_is_a_mistake(odd, capsys):
    for pattern, help_text in (("a", "did you mean `A`?"), ("A/4", "RULE or RULE/LABEL")):
        status, out, err = run(capsys, odd, "--rule", pattern, "--coverage")
        assert (status, out) == (2, "")
        assert f"error[R0460]: no rule and no example matches `{pattern}`\n" in err
        assert help_text in err


def test_rules_that_are_not_in_force_are_named(odd, capsys):
    Path("dated.rules").write_text(
        "rulebook dated\nsignal p\nhard rule A { require never p accept { not p } reject { p } }\n"
        "hard rule B { in force from 2030-01-01 require always p accept { p } reject { not p } }\n"
    )
    sentence = "rule `B` of dated is not in force on 2026-01-01, so its examples are not run\n"
    day = ("--at", "2026-01-01")
    status, out, err = run(capsys, "dated.rules", *day)
    assert (status, err) == (0, f"rulec: {sentence}")
    assert "2 examples" in out
    assert run(capsys, "dated.rules", *day, "--rule", "A")[2] == ""
    for pattern in ("B", "B/1"):
        status, _, err = run(capsys, "dated.rules", *day, "--rule", pattern)
        assert (status, f"error[R0460]: {sentence}" in err) == (2, True)
    assert run(capsys, "dated.rules", "--at", "2030-01-01", "--rule", "B")[2] == ""


def test_json(odd, capsys):
    status, out, _ = run(capsys, odd, "esterle2019", "--output-format", "json")
    assert status == 1
    document = json.loads(out)
    assert (document["passed"], document["failed"], document["coverage"]) == (15, 3, None)
    assert {one["rulebook"] for one in document["examples"]} == {"odd", "esterle2019"}
    assert document["examples"][1] == {
        "rulebook": "odd",
        "rule": "A",
        "label": "to <&> right",
        "number": 2,
        "says": "accept",
        "does": "reject",
        "passed": False,
        "lost_after": 1,
        "place": {"file": "odd.rules", "line": 6, "column": 3, "end_line": 7, "end_column": 18},
    }


@pytest.mark.parametrize(
    ("formula", "turned_round"),
    [("red and not stop", True), ("not red", False), ("red and stop", False)],
)
def test_all_examples_the_other_way(formula, turned_round, tmp_path, capsys):
    """Of the second and the third formula one example comes out as it claims."""
    (tmp_path / "stops.rules").write_text(
        f"rulebook stops signal red, stop hard rule r {{ require {formula} "
        "accept { red and stop } reject { red and not stop } }"
    )
    for form in ("full", "junit"):
        _, out, _ = run(capsys, str(tmp_path / "stops.rules"), "--output-format", form)
        assert ("all examples of rule `r` come out the other way" in out) == turned_round


def test_junit(odd, capsys):
    status, out, _ = run(capsys, odd, "--output-format", "junit", "--coverage")
    assert status == 1
    root = ElementTree.fromstring(out)
    (suite,) = root
    assert (root.tag, suite.tag, suite.get("name")) == ("testsuites", "testsuite", "odd")
    assert (suite.get("tests"), suite.get("failures")) == ("4", "3")
    cases = suite.findall("testcase")
    assert [case.get("classname") for case in cases] == ["odd.A"] * 3 + ["odd.B"]
    assert [case.get("name") for case in cases] == ["1", "to <&> right", "3", "never"]
    assert (cases[1].get("file"), cases[1].get("line")) == ("odd.rules", "6")
    assert [case.find("failure") is not None for case in cases] == [False, True, True, True]
    failure = cases[1].find("failure")
    assert failure.get("type") == "R0406"
    assert "says `accept`, but the rule rejects it" in failure.get("message")
    assert "7 |      r(v); f(v) }" in failure.text
    assert suite.find("properties/property").get("name") == "coverage"
    assert "`f(v)` is never true" in suite.find("system-out").text


def test_junit_has_the_error_of_a_rulebook_that_could_not_be_tested(odd, capsys, tmp_path):
    (tmp_path / "bad.rules").write_text("rulebook bad\nuse paper\nhard rule A { require q }\n")
    status, out, _ = run(capsys, odd, "bad.rules", "--output-format", "junit")
    assert status == 2
    root = ElementTree.fromstring(out)
    assert [root.get(name) for name in ("tests", "failures", "errors")] == ["5", "3", "1"]
    suite = root.findall("testsuite")[-1]
    case = suite.find("testcase")
    assert (suite.get("name"), suite.get("errors")) == ("bad.rules", "1")
    assert (case.get("name"), case.get("file"), case.get("line")) == ("reading", "bad.rules", "3")
    assert case.find("error").get("type") == "R0202"
    assert "nothing is called `q`" in case.find("error").text


def test_junit_has_what_falls_short_as_a_failure(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    source = "rulebook a\nsignal p\nhard rule r { require always p accept { p } }\n"
    (tmp_path / "a.rules").write_text(source)
    status, out, _ = run(capsys, "a.rules", "--fail-under", "90", "--output-format", "junit")
    assert status == 1
    root = ElementTree.fromstring(out)
    assert [root.get(name) for name in ("tests", "failures", "errors")] == ["2", "1", "0"]
    case = root.findall("testsuite")[-1].find("testcase")
    assert (case.get("classname"), case.get("name")) == ("rulec", "coverage")
    assert case.find("failure").get("message").endswith("below the 90 % asked for")
    (tmp_path / "a.rules").write_text(source.replace(" accept { p }", ""))
    status, out, _ = run(capsys, "a.rules", "--fail-on-empty", "--output-format", "junit")
    assert status == 1
    failure = ElementTree.fromstring(out).find("testsuite/testcase/failure")
    assert failure.get("message") == "there is no example to run"


def test_files_are_named_from_the_working_folder_for_runners(odd, capsys, tmp_path):
    _, out, _ = run(capsys, str(tmp_path / odd), "--output-format", "junit")
    files = {case.get("file") for case in ElementTree.fromstring(out).iter("testcase")}
    assert files == {"odd.rules"}
    (tmp_path / "bad.rules").write_text("rulebook bad\nhard rule A { require q }\n")
    assert main(["check", str(tmp_path / "bad.rules"), "--output-format", "github"]) == 1
    assert "::error file=bad.rules,line=2," in capsys.readouterr().out


def test_junit_of_what_xml_cannot_hold(odd, capsys, tmp_path):
    (tmp_path / "odd.rules").write_text(ODD.replace("never", "a\uffffb\ufffec"), encoding="utf-8")
    assert run(capsys, odd)[0] == 1
    _, out, _ = run(capsys, odd, "--output-format", "junit")
    cases = ElementTree.fromstring(out).findall("*/testcase")
    assert cases[-1].get("name") == "a\\uffffb\\ufffec"


def test_an_inherited_example_is_mended_by_an_override(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "above.rules").write_text(
        "rulebook above\nuse road\noption strict = off\n"
        "hard rule A (v: vehicle) {\n  require never (strict and behind(v))\n"
        "  accept { behind(v) }\n}\n"
        "hard rule B {\n  require never (strict and wet)\n  accept { wet }\n}\n"
    )
    (tmp_path / "below.rules").write_text(
        'rulebook below\nextends above\nset strict = on\noverride rule B { cite "1" }\n'
        "hard rule C { require never icy accept { icy } }\n"
    )
    status, out, _ = run(capsys, "below.rules")
    helps = [line.partition("= help: ")[2] for line in out.splitlines() if "= help:" in line]
    inherited = (
        "the example is inherited: undo what makes the rule another one here, "
        "or give it examples of this rulebook's own in `override rule {} {{ … }}`"
    )
    assert status == 1
    assert helps == [
        inherited.format("A (v: vehicle)"),
        inherited.format("B"),
        "correct the example or the formula; `rulec show` puts the formula into words",
    ]
    _, out, _ = run(capsys, "below.rules", "--output-format", "junit")
    assert out.count("the example is inherited") == 2
    main(["compile", "below.rules", "-o", "build"])
    assert capsys.readouterr().err.count("the example is inherited") == 2


def test_an_example_of_a_rule_that_an_option_switches_off(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.rules").write_text(
        "rulebook a\nuse road\noption season = off\n"
        "hard rule A { require never icy when season accept { wet } reject { icy } }\n"
    )
    status, out, _ = run(capsys, "a.rules")
    assert status == 1
    assert "= help: the rule's condition is false as options are set" in out


def test_a_proposed_example_leaves_out_what_has_its_default(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.rules").write_text(
        "rulebook a\nuse road\n"
        "hard rule A { require never (icy and crossing and speed > 30 km/h) }\n"
    )
    _, out, _ = run(capsys, "a.rules", "--coverage")
    assert [line for line in out.splitlines() if "missing" in line] == [
        "  missing: accept { crossing and speed = 30 km/h }",
        "  missing: reject { icy and crossing and speed = 31 km/h }",
        # The edge can be taken at any speed; at the limit it is the speed that decides.
        "  missing: accept { icy and crossing and speed = 30 km/h }",
    ]


def test_coverage(odd, capsys):
    _, out, _ = run(capsys, odd, "--coverage", "--rule", "B")
    # B: from the first state, in which f(v) has not been yet, two classes of letters lead on.
    assert "odd B: 1 of 2 edges, 1 of 2 values of atoms (50.0 %)\n" in out
    assert "  `f(v)` is never true\n" in out
    assert "  missing: accept { f(v) }\n" in out
    assert "\ncoverage 50.0 %\n" in out


@pytest.mark.parametrize(("threshold", "status"), [("0", 0), ("66.6", 0), ("66.7", 1), ("100", 1)])
def test_threshold(odd, capsys, threshold, status, tmp_path):
    # Each rule has two edges and two values of atoms; A and C show all of them, B none: 8 of 12.
    (tmp_path / odd).write_text(
        "rulebook odd\nsignal p, q\n"
        "hard rule A { require always not p accept { not p } reject { p } }\n"
        "hard rule B { require always not q }\n"
        "hard rule C { require always not q accept { not q } reject { q } }\n"
    )
    found, out, err = run(capsys, odd, "--fail-under", threshold)
    assert "coverage 66.7 %" in out
    assert found == status
    assert ("below the" in err) == bool(status)


def test_a_rulebook_answers_for_its_own_rules(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("ground.rules").write_text(
        "rulebook ground\nsignal p, q\n"
        "hard rule A { require always not p }\n"
        "hard rule B { require always not q accept { not q } }\n"
    )
    Path("over.rules").write_text(
        "rulebook over\nextends ground\noverride rule B { accept { not q } reject { q } }\n"
    )
    status, out, err = run(capsys, "over.rules", "--fail-under", "100")
    assert (status, "below" in err) == (0, False)
    # Others have to cover what they wrote.
    assert "over A" not in out
    assert "over: without 1 inherited rule; --rule '*' shows them, too\n" in out
    assert "over B: 2 of 2 edges" in out
    assert "coverage 100.0 % of own rules, 50.0 % with those that are inherited\n" in out
    _, out, _ = run(capsys, "over.rules", "--coverage", "--output-format", "json")
    covered = json.loads(out)["coverage"]
    assert (covered["percent"], covered["percent_with_inherited"]) == (100, 50)
    assert [rule["inherited"] for rule in covered["rules"]] == [True, False]
    # Where a pattern has chosen them, all that it matches count.
    status, out, err = run(capsys, "over.rules", "--fail-under", "100", "--rule", "*")
    assert "over A (inherited): 0 of 2 edges" in out
    assert (status, "coverage 50.0 %\n" in out) == (1, True)
    assert "coverage is 50.0 %, below the 100 % asked for" in err
    status, _, err = run(capsys, "ground.rules", "over.rules", "--fail-under", "100")
    assert status == 1
    assert "coverage of own rules is" in err
    Path("empty.rules").write_text("rulebook empty\nextends ground\n")
    status, out, _ = run(capsys, "empty.rules", "--fail-under", "100")
    assert (status, "coverage: no rule is its own, " in out) == (0, True)


def test_a_rulebook_with_mistakes_does_not_keep_the_others_from_being_tested(odd, capsys):
    status, out, err = run(capsys, "nope", "esterle2019")
    assert status == 2
    assert out.endswith("14 examples passed\n")
    assert "error[R0703]: there is no rulebook `nope`" in err
    assert run(capsys, "nope")[:2] == (2, "")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["build/a.json"], "`build/a.json` is compiled and has no examples"),
        (["esterle2019", "--fail-under", "101"], "--fail-under"),
        (["esterle2019", "--fail-under", "nan"], "--fail-under"),
        (["esterle2019", "--output-format", "sarif"], "it is one of full, json, junit"),
    ],
)
def test_what_cannot_be_answered(arguments, words, capsys):
    status, out, err = run(capsys, *arguments)
    assert (status, out) == (2, "")
    assert words in err


def test_warnings_are_said_aside(odd, capsys, tmp_path):
    (tmp_path / odd).write_text(
        "rulebook odd\nuse paper\nhard rule A (v: vehicle) { require true }"
    )
    status, out, err = run(capsys, odd)
    assert (status, out) == (0, "0 examples passed\n")
    assert "warning[R0207]" in err


def test_a_rule_that_its_examples_do_not_exercise_gets_a_warning(tmp_path, capsys):
    source = "rulebook a\nsignal p\nhard rule r { require always p accept { p } }\n"
    path = tmp_path / "a.rules"
    path.write_text(source)
    status, out, err = run(capsys, str(path), "--output-format", "json")
    assert (status, json.loads(out)["passed"]) == (0, 1)
    assert err.startswith("warning[R0408]: no example breaks rule `r`\n")
    path.write_text(source.replace("accept { p }", "accept { p } reject { not p }"))
    assert run(capsys, str(path))[::2] == (0, "")


LARGE = """\
rulebook large
step 0.1 s
signal p, q default false
hard rule big { require always (p implies previously[4 s] q) }
hard rule small { require never p accept { not p } reject "p" { p } }
"""


@pytest.mark.parametrize("pattern", ["small", "small/p", "sm*"])
def test_a_rule_that_is_too_large_does_not_stand_in_the_way_of_others(
    pattern, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "large.rules").write_text(LARGE)
    status, out, err = run(capsys, "large.rules", "--rule", pattern)
    assert (status, err) == (0, "")
    assert "passed" in out.splitlines()[-1]


def test_a_long_condition_is_shown_in_part(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = [f"a_signal_with_a_long_name_{number}" for number in range(10)]
    several = " or ".join(f"{name}(x)" for name in names)
    declared = ", ".join(f"{name}(x: t)" for name in names)
    Path("long.rules").write_text(
        f"rulebook long\ntype t\nsignal {declared} default false\n"
        f"hard rule A {{ require never some x: t ({several}) }}\n"
    )
    _, out, _ = run(capsys, "long.rules", "--coverage")
    (line,) = [line for line in out.splitlines() if "is never true" in line]
    assert len(line) < 230
    assert " …` is never true" in line


def test_two_editions_of_one_rulebook_are_told_apart(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for folder in ("old", "new"):
        Path(folder).mkdir()
        edition = ODD if folder == "old" else ODD.replace("reject { b(v); l(v) }\n", "")
        edition += "hard rule later { require true\n in force from 2100-01-01 }\n"
        Path(folder, "odd.rules").write_text(edition)
    files = "old/odd.rules", "new/odd.rules"
    _, out, err = run(capsys, *files, "--coverage")
    old, new = "odd (old/odd.rules)", "odd (new/odd.rules)"
    assert [line for line in out.splitlines() if line.startswith(("pass", "FAIL"))] == [
        f"pass  {old} A/1",
        f"FAIL  {old} A/to <&> right",
        f"FAIL  {old} A/3",
        f"FAIL  {old} B/never",
        f"pass  {new} A/1",
        f"FAIL  {new} A/to <&> right",
        f"FAIL  {new} B/never",
    ]
    for name in (old, new):
        assert f"\n{name} B: " in out
        assert f"rule `later` of {name} is not in force on " in err
    _, out, _ = run(capsys, *files, "--coverage", "--json")
    data = json.loads(out)
    assert [example["rulebook"] for example in data["examples"]] == [old] * 4 + [new] * 3
    assert {rule["rulebook"] for rule in data["coverage"]["rules"]} == {old, new}
    _, out, _ = run(capsys, *files, "--output-format", "junit")
    suites = ElementTree.fromstring(out).findall("testsuite")
    assert [suite.get("name") for suite in suites] == [old, new]
    assert [suite.find("testcase").get("classname") for suite in suites] == [f"{old}.A", f"{new}.A"]


@pytest.mark.parametrize("others", [["A"], ["B/never", "A/1"]])
def test_every_pattern_has_to_match(odd, capsys, others):
    """A misspelt one beside others would test less than was asked for, and say nothing."""
    patterns = [argument for pattern in (*others, "C*") for argument in ("--rule", pattern)]
    status, out, err = run(capsys, odd, *patterns)
    assert (status, out) == (2, "")
    assert "error[R0460]: no rule and no example matches `C*`\n" in err
    assert "rules are `A`, `B`" in err


def test_a_pattern_may_match_in_one_of_several_rulebooks(odd, capsys):
    Path("other.rules").write_text(ODD.replace("rule A", "rule C").replace("odd", "other"))
    status, out, err = run(capsys, odd, "other.rules", "--rule", "A/1", "--rule", "C/1")
    assert (status, err) == (0, "")
    assert out.splitlines()[:2] == ["pass  odd A/1", "pass  other C/1"]


def test_a_pattern_beside_others_may_match_what_is_not_in_force(odd, capsys):
    later = "hard rule later { require true\n in force from 2100-01-01 }\n"
    Path(odd).write_text(ODD + later)
    status, _, err = run(capsys, odd, "--rule", "A/1", "--rule", "later")
    assert status == 0
    assert "rule `later` of odd is not in force on " in err
