"""Examples as traces, their verdicts, and what is said of those that surprise."""

import pytest

from rulec import compile_rulebook
from rulec.book_tests.example_runs import (
    example_trace,
    example_warning,
    example_warnings,
    own_names,
    run_rulebook_examples,
)
from rulec.diagnostics import RulecError
from rulec.rulebook.loader import parse_rulebook

HEAD = """rulebook sample
type t
signal p, q default false
signal near(v: t) default false
signal by(v: t, w: t) default false
quantity gap(v: t) in m
"""


def run(*rules, pattern=None, head=HEAD):
    rulebook = parse_rulebook(head + "\n".join(rules))
    return run_rulebook_examples(
        rulebook, compile_rulebook(rulebook), patterns=() if pattern is None else (pattern,)
    )


def test_examples_become_traces():
    source = (
        "hard rule A (v: t, w: t) { require never by(v, w)"
        ' accept "shown" (x: t) { near(v) and by(w, v) and gap(v) = 2 m; near(x) } }'
    )
    (rule,) = parse_rulebook(HEAD + source).rules
    trace = example_trace(rule, rule.examples[0])
    assert trace.id == "shown"
    assert trace.objects == {"v": "t", "w": "t", "x": "t"}
    first, second = trace.states
    assert first == {"near": {"v": True}, "by": {"w": {"v": True}}, "gap": {"v": 2.0}}
    assert second == {"near": {"x": True}}
    assert own_names(rule) == {"v": "v", "w": "w"}


@pytest.mark.parametrize(
    ("example", "passed", "accepted", "lost_after"),
    [
        ("accept { p; q }", True, True, None),
        ("reject { p; q }", False, True, None),
        ("reject { p; not q; q }", True, False, 1),
        ("accept { p; not q; q }", False, False, 1),
        ("accept { not p; p }", False, False, None),
    ],
)
def test_outcomes(example, passed, accepted, lost_after):
    (outcome,) = run(f"hard rule A {{ require always (p implies next q) {example} }}").outcomes
    assert (outcome.passed, outcome.accepted) == (passed, accepted)
    assert outcome.lost_after == lost_after
    assert (outcome.number, outcome.name) == (1, "1")
    assert len(outcome.word) == example.count(";") + 1
    assert not outcome.ends


RULES = [
    'hard rule A { require p accept "one" { p } reject "two" { q } accept { p } }',
    'hard rule B { require q accept "one" { q } }',
]


@pytest.mark.parametrize(
    ("pattern", "expected"),
    [
        (None, ["A/one", "A/two", "A/3", "B/one"]),
        ("A", ["A/one", "A/two", "A/3"]),
        ("*/one", ["A/one", "B/one"]),
        ("A/3", ["A/3"]),
        ("a", []),
        ("one", []),
    ],
)
def test_a_pattern_chooses_rules_or_examples(pattern, expected):
    outcomes = run(*RULES, pattern=pattern).outcomes
    assert [f"{one.rule.name}/{one.name}" for one in outcomes] == expected
    assert all(one.passed for one in outcomes)


def test_a_state_that_cannot_be():
    """The loader finds most of them; a rulebook that is put together in Python is run as it is."""
    rule = "hard rule A (v: t) { require always (near(v) implies not q)\n%s }"
    example = (
        "accept (x: t, y: t) { near(x) and not near(v) }\naccept (x: t) { near(x); q and near(v) }"
    )
    rulebook = parse_rulebook(HEAD + rule % example)
    with_axiom = parse_rulebook(HEAD + "fact not (q and near(v))\n" + rule % "")
    with pytest.raises(RulecError) as error:
        run_rulebook_examples(rulebook, compile_rulebook(with_axiom))
    (found,) = error.value.diagnostics
    # The second state of the second example.
    assert (found.code, found.place.line, found.place.column) == ("R0306", 9, 26)
    assert found.notes[-1] == "in an example of rule `A`"


def test_what_is_said_of_an_example_that_surprises():
    (one,) = run('hard rule A { require never p accept "named" { q; p; q } }').outcomes
    warning = example_warning(one, "sample")
    assert (warning.code, warning.severity) == ("R0406", "warning")
    assert warning.message == ("example `named` of rule `A` says `accept`, but the rule rejects it")
    assert "state 1" in warning.notes[0]
    assert len(warning.labels) == 1
    (one,) = run("hard rule A { require eventually p accept { q } }").outcomes
    warning = example_warning(one, "sample")
    assert warning.message.startswith("example number 1 of rule `A` says `accept`")
    assert warning.notes == (
        "the rule could still be kept, if the last state did not go on for ever",
    )
    finite = HEAD.replace("type t", "semantics finite\ntype t")
    (one,) = run("hard rule A { require eventually p accept { q } }", head=finite).outcomes
    assert example_warning(one, "sample").notes == (
        "the rule could still be kept, if the example did not end here",
    )
    (one,) = run("hard rule A { require true reject { q } }").outcomes
    assert example_warning(one, "sample").message.endswith("says `reject`, but the rule accepts it")
    assert example_warning(one, "sample").notes == ()


def test_only_rules_that_can_be_run_without_a_step_are_compiled():
    rulebook = parse_rulebook(
        f"{HEAD}hard rule A {{ require p accept {{ q }} }}\n"
        "hard rule B { require eventually[<= 2 s] p }\nhard rule C { require q }"
    )
    asked = []

    def compiled(rules):
        asked.extend(rule.name for rule in rules)
        return compile_rulebook(rulebook_of(rulebook, rules))

    (warning,) = example_warnings(rulebook, compiled)
    assert warning.code == "R0406"
    assert asked == ["A", "C"]


def rulebook_of(rulebook, rules):
    from dataclasses import replace

    return replace(rulebook, rules=tuple(rules))
