"""How examples came out, and what they cover, as JSON; docs/commands.md describes it."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from rulec.book_tests.edge_coverage import RuleCoverage, percent
from rulec.book_tests.example_runs import ExampleOutcome, ExampleRun
from rulec.diagnostics.diagnostic import at
from rulec.logic.printing import in_words
from rulec.report.findings.diagnostics_json import place_as_data
from rulec.report.tests.example_text import missing_example
from rulec.rulebook.model import Rulebook


def as_json(runs: Sequence[ExampleRun], covered: Sequence[Sequence[RuleCoverage]] | None) -> str:
    """One object.

    Args:
        runs: a run for each rulebook.
        covered: the coverage of each run; None if nobody asked.
    """
    outcomes = [one for run in runs for one in run.outcomes]
    passed = sum(one.passed for one in outcomes)
    document = {
        "examples": [_outcome(run.rulebook.name, one) for run in runs for one in run.outcomes],
        "passed": passed,
        "failed": len(outcomes) - passed,
        "coverage": None if covered is None else _coverage(runs, covered),
    }
    return json.dumps(document, ensure_ascii=False, indent=2)


def _outcome(rulebook: str, one: ExampleOutcome) -> dict[str, Any]:
    return {
        "rulebook": rulebook,
        "rule": one.rule.name,
        "label": one.example.label,
        "number": one.number,
        "says": "accept" if one.example.accepts else "reject",
        "does": "accept" if one.accepted else "reject",
        "passed": one.passed,
        "lost_after": one.lost_after,
        "place": place_as_data(at(one.example.span)),
    }


def _coverage(
    runs: Sequence[ExampleRun], covered: Sequence[Sequence[RuleCoverage]]
) -> dict[str, Any]:
    return {
        "percent": round(percent(rule for rules in covered for rule in rules), 3),
        "rules": [
            _rule(run.rulebook, one)
            for run, rules in zip(runs, covered, strict=True)
            for one in rules
        ],
    }


def _rule(rulebook: Rulebook, one: RuleCoverage) -> dict[str, Any]:
    return {
        "rulebook": rulebook.name,
        "rule": one.rule,
        "percent": round(percent([one]), 3),
        "edges": one.n_edges,
        "missing_edges": [
            {
                "source": edge.source,
                "target": edge.target,
                "example": missing_example(edge, rulebook.vocabulary),
            }
            for edge in one.missing_edges
        ],
        "values": one.n_values,
        "missing_values": [
            {"atom": in_words(atom), "value": value} for atom, value in one.missing_values
        ],
    }
