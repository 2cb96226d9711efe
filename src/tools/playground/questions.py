"""The questions that the page asks rulec, which runs beside it in the browser.

Questions and answers are JSON. Findings, test runs, verdicts and comparisons are the documents that
the commands write with ``--output-format json``; verdicts also get the commands' sentences. Files
are in the working directory, which belongs to the page. Nothing here needs NumPy, Shapely or Spot.

A question has the ``source`` that it is about, and in ``others`` the sources beside it. A rulebook
to judge by or to compare with is given by name: "" is the ``source``, ``NAME.rules`` one of the
``others``, ``NAME.json`` a compiled rulebook, whose text is in ``compiled``, ``NAME`` a shipped
one.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeAlias

import rulec
from rulec.monitoring.explain.explanation import Explanation, explain
from rulec.monitoring.explain.margins import Margin
from rulec.report.findings import diagnostics_json
from rulec.report.json_document import as_builtins
from rulec.report.rulebooks import rule_page
from rulec.report.rulebooks.comparison import diff_formats
from rulec.report.tests import example_formats
from rulec.report.verdicts import verdict_json
from rulec.report.verdicts.state_times import StateTimes
from rulec.report.verdicts.verdict_report import open_in_words
from rulec.report.verdicts.violation_table import decisive_state_in_words, kept_if
from rulec.rulebook.files.search_path import find_rulebook
from rulec.rulebook.vocabulary_phrases import phrases_of

MOST_EXPLAINED = 20
"""The number of violations of a trace that are explained."""

# A browser has no users, and its files belong to number 0; rulec asks who owns its cache.
vars(os).setdefault("geteuid", lambda: 0)

Question: TypeAlias = Mapping[str, Any]
Tell: TypeAlias = Callable[[float], object]

_NAME = re.compile(r"^\s*(?:rulebook|vocabulary)\s+([\w-]+)", re.MULTILINE)


def answer(text: str, tell: Tell = lambda _: None) -> str:
    """The answer to a question: its ``result``, or what is wrong.

    Errors are ``findings``, as in ``check``; a bug in rulec is a ``failure``. ``tell`` is called
    with the progress of a long answer.
    """
    question = {**json.loads(text), "tell": tell}
    try:
        found: dict[str, Any] = {"result": _ANSWERS[question["ask"]](question)}
    except rulec.RulecError as error:
        found = {"findings": json.loads(diagnostics_json.as_json(error.diagnostics))}
    except Exception as error:
        found = {"failure": f"{type(error).__name__}: {error}"}
    return json.dumps(found)


def _source(question: Question) -> Any:
    """The source of a shipped rulebook."""
    return find_rulebook(question["name"], []).read_text("utf-8")


def _check(question: Question) -> Any:
    checked = rulec.check(_written(question))
    return json.loads(diagnostics_json.as_json((*checked.unread, *checked.findings)))


def _format(question: Question) -> Any:
    return rulec.format(question["source"], _name_of(question["source"]))


def _rules(question: Question) -> Any:
    """The rules in English."""
    book = rulec.load_rulebook(_written(question))
    return as_builtins(rule_page.as_document(book, book.rules, None))


def _test(question: Question) -> Any:
    run = rulec.test(_written(question))
    return json.loads(example_formats.as_json([run], [rulec.coverage(run)]))


def _judge(question: Question) -> Any:
    """For each trace a verdict with explanations and doubts, or the reason why there is none."""
    rules = rulec.compile(_book(question, "book"))
    traces = Path("traces.jsonl" if question["traces"].lstrip()[:1] == "{" else "traces.csv")
    traces.write_text(question["traces"], "utf-8")
    return [_verdict(trace, rules) for trace in rulec.read_traces(traces)]


def _verdict(trace: rulec.Trace | rulec.RulecError, rules: rulec.CompiledRulebook) -> Any:
    if isinstance(trace, rulec.RulecError):
        return {"findings": json.loads(diagnostics_json.as_json(trace.diagnostics))}
    try:
        verdict = rulec.verify(trace, rules)
    except rulec.RulecError as error:
        return {"findings": json.loads(diagnostics_json.as_json(error.diagnostics))}
    fitted = rules.fitted_to(trace.step_s)
    shown = verdict.violations[:MOST_EXPLAINED]
    explained = [explain(violation, trace, fitted) for violation in shown]
    document = json.loads(verdict_json.as_json(verdict, rules, explained))
    phrases, times = phrases_of(rules), StateTimes(step_s=trace.step_s)
    for told in document["violations"]:
        told["when"] = "" if told["step"] is None else times.of(told["step"])
    for told, explanation in zip(document["violations"], explained, strict=False):
        _add_words(told["explanation"], explanation, phrases, times)
    for told, doubt in zip(document["open"], verdict.open, strict=True):
        told["in_words"] = open_in_words(doubt, len(doubt.outcomes))
    return document


def _add_words(
    told: dict[str, Any], explanation: Explanation, phrases: Mapping[str, str], times: StateTimes
) -> None:
    """Add an explanation's sentence, the ways to keep the rule, and the margins."""
    told["in_words"] = decisive_state_in_words(explanation, phrases, times)
    told["kept_if"] = kept_if(explanation, times) if explanation.looked_at is None else []
    margins = [fact.margins for fact in explanation.facts]
    margins += [part.margins for part in explanation.parts]
    for row, by_state in zip([*told["facts"], *told["parts"]], margins, strict=True):
        row["margins"] = [_margin(margin) for margin in by_state]


def _margin(margin: Margin | None) -> str:
    return "" if margin is None else margin.sides


def _compare(question: Question) -> Any:
    patterns = [question["rule"]] if question["rule"] else []
    books = _book(question, "first"), _book(question, "second")
    return json.loads(
        diff_formats.as_json(rulec.diff(*books, patterns=patterns, on_progress=question["tell"]))
    )


def _book(question: Question, key: str) -> str:
    """A shipped rulebook by its name, or the file of one in the page."""
    named, written = question[key], _written(question)
    return named or written


def _written(question: Question) -> str:
    """The file with the source, named after its rulebook; all others are beside it."""
    for old in (*Path().glob("*.rules"), *Path().glob("*.json")):
        old.unlink()
    for source in (*question.get("others", ()), question["source"]):
        Path(_name_of(source)).write_text(source, "utf-8")
    for name, text in question.get("compiled", {}).items():
        Path(name).write_text(text, "utf-8")
    return _name_of(question["source"])


def _name_of(source: str) -> str:
    found = _NAME.search(source)
    return f"{found[1] if found else 'rulebook'}.rules"


_ANSWERS: Mapping[str, Callable[[Question], Any]] = {
    "source": _source,
    "check": _check,
    "format": _format,
    "rules": _rules,
    "test": _test,
    "judge": _judge,
    "compare": _compare,
}
