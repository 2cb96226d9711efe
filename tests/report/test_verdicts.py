"""Verdicts for people and for machines: where a rule comes from, and what it weighs."""

import json
from dataclasses import replace
from fractions import Fraction

import pytest

from rulec.automata.bundle.bundle_file import from_json, to_json
from rulec.monitoring.batch.verify import verify
from rulec.monitoring.explain.explanation import explain
from rulec.report.findings.findings_of_traces import trace_findings
from rulec.report.verdicts import verdict_json, verdict_report
from rulec.trace import Trace
from support.builders.rulebooks import P, book, compile_here, rule


def compiled(**more):
    rules = compile_here(book(rule("A", P)))
    return replace(rules, rules=(replace(rules.rules[0], **more),))


def violated(rules):
    trace = Trace("t", 1.0, {}, ({},))
    return trace, verify(trace, rules)


@pytest.mark.parametrize(
    ("more", "line"),
    [
        ({}, "hard rule A [Art. A]: cannot be kept"),
        ({"cite": ""}, "hard rule A: cannot be kept"),
        # The rulebook is called `test`: its own rules need not say so.
        ({"book": "test"}, "hard rule A [Art. A]: cannot be kept"),
        ({"book": "vienna"}, "hard rule A [vienna, Art. A]: cannot be kept"),
        ({"book": "vienna", "cite": ""}, "hard rule A [vienna]: cannot be kept"),
        (
            {"book": "de", "inherited_from": "vienna"},
            "hard rule A [inherited, not confirmed: vienna Art. A]: cannot be kept",
        ),
        ({"level": "legal"}, "hard rule A in legal [Art. A]: cannot be kept"),
        (
            {"strength": "soft", "level": "courtesy", "weight": Fraction(5, 2)},
            "soft rule A in courtesy weight 2.5 [Art. A]: cannot be kept",
        ),
        ({"strength": "soft"}, "soft rule A [Art. A]: cannot be kept"),
        ({"level": "a\x1b[31m"}, "hard rule A in a\\x1b[31m [Art. A]: cannot be kept"),
    ],
)
def test_a_violation_names_the_rule_as_its_head_does(more, line):
    rules = compiled(**more)
    _, verdict = violated(rules)
    assert line in verdict_report.as_text(verdict, rules)


@pytest.mark.parametrize(
    ("more", "level", "weight"),
    [
        ({}, None, 1),
        ({"level": "courtesy", "weight": Fraction(2)}, "courtesy", 2),
        ({"weight": Fraction(1, 4)}, None, 0.25),
    ],
)
def test_level_and_weight_as_data(more, level, weight):
    rules = compiled(**more)
    _, verdict = violated(rules)
    (violation,) = json.loads(verdict_json.as_json(verdict, rules))["violations"]
    assert (violation["level"], violation["weight"]) == (level, weight)
    assert isinstance(violation["weight"], type(weight))


def test_an_explanation_as_data_names_the_book():
    rules = compiled(book="vienna")
    trace, verdict = violated(rules)
    why = explain(verdict.violations[0], trace, rules)
    (violation,) = json.loads(verdict_json.as_json(verdict, rules, [why]))["violations"]
    assert violation["explanation"]["book"] == "vienna"
    assert violation["explanation"]["cite"] == "Art. A"


@pytest.mark.parametrize(("base", "expected"), [("vienna", "vienna"), ("", None)])
def test_whose_law_a_rule_is_stands_beside_it_unless_it_is_the_rulebooks_own(base, expected):
    rules = compiled(inherited_from=base)
    trace, verdict = violated(rules)
    (violation,) = json.loads(verdict_json.as_json(verdict, rules))["violations"]
    assert violation.get("inherited_from") == expected
    (finding,) = trace_findings("t.csv", trace, verdict, rules, [])
    assert (finding.provision, finding.inherited_from) == ("Art. A", base)
    assert ("inherited, not confirmed: vienna Art. A" in finding.says) is bool(base)
    (kept,) = from_json(to_json(rules).encode(), "t.json").rules
    assert kept.inherited_from == base
