"""What the page asks of rulec, which runs beside it in the browser.

Questions and answers are JSON. What is found, run, judged and compared is told by the documents
that the commands write with ``--output-format json``. Files are in the working directory, which is
the page's own. Nothing here needs NumPy, Shapely or Spot.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeAlias

import rulec
from rulec.monitoring.explain.explanation import explain
from rulec.report.findings import diagnostics_json
from rulec.report.json_document import as_builtins
from rulec.report.rulebooks import diff_json, rule_json
from rulec.report.tests import example_json
from rulec.report.verdicts import verdict_json
from rulec.rulebook.files.search_path import find_rulebook

MOST_EXPLAINED = 20
"""So many violations of a trace are explained."""

Question: TypeAlias = Mapping[str, Any]
Tell: TypeAlias = Callable[[float], object]

_NAME = re.compile(r"^\s*(?:rulebook|vocabulary)\s+([\w-]+)", re.MULTILINE)
_PARTLY_KNOWN = (
    "This trace leaves open what some value is, or how it goes on. Such a trace is judged by "
    "`rulec verify`; this page does without NumPy, which that takes."
)


def answer(text: str, tell: Tell = lambda _: None) -> str:
    """The answer to a question: its ``result``, or what is wrong.

    That are ``findings``, as ``check`` has them; what the page cannot do, ``refused`` in words; or
    a mistake of rulec's own, its ``failure``. ``tell`` is told how far a long answer has come.
    """
    question = {**json.loads(text), "tell": tell}
    try:
        found: dict[str, Any] = {"result": _ANSWERS[question["ask"]](question)}
    except rulec.RulecError as error:
        found = {"findings": json.loads(diagnostics_json.as_json(error.diagnostics))}
    except ModuleNotFoundError as error:
        if error.name != "numpy":
            raise
        found = {"refused": _PARTLY_KNOWN}
    except Exception as error:
        found = {"failure": f"{type(error).__name__}: {error}"}
    return json.dumps(found)


def _source(question: Question) -> Any:
    """The source of a rulebook that ships."""
    return find_rulebook(question["name"], []).read_text("utf-8")


def _check(question: Question) -> Any:
    checked = rulec.check(_written(question))
    return json.loads(diagnostics_json.as_json((*checked.unread, *checked.findings)))


def _format(question: Question) -> Any:
    return rulec.format(question["source"], _name_of(question))


def _rules(question: Question) -> Any:
    """The rules in English."""
    book = rulec.load_rulebook(_written(question))
    return as_builtins(rule_json.as_document(book.name, book.rules, book.vocabulary, None))


def _test(question: Question) -> Any:
    run = rulec.test(_written(question))
    return json.loads(example_json.as_json([run], [rulec.coverage(run)]))


def _judge(question: Question) -> Any:
    """A verdict on each trace, violations explained, or why there is none."""
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
    # Repairs take NumPy.
    explained = [explain(violation, trace, fitted, repaired=False) for violation in shown]
    return json.loads(verdict_json.as_json(verdict, rules, explained))


def _compare(question: Question) -> Any:
    patterns = [question["rule"]] if question["rule"] else []
    books = _book(question, "first"), _book(question, "second")
    return json.loads(
        diff_json.as_json(rulec.diff(*books, patterns=patterns, on_progress=question["tell"]))
    )


def _book(question: Question, key: str) -> str:
    """A rulebook that ships, by its name, or the source that is being edited."""
    return question[key] or _written(question)


def _written(question: Question) -> str:
    """The file with the source, called as its rulebook is."""
    file = Path(_name_of(question))
    for other in Path().glob("*.rules"):
        other.unlink()
    file.write_text(question["source"], "utf-8")
    return str(file)


def _name_of(question: Question) -> str:
    found = _NAME.search(question["source"])
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
