"""Formulas that are asked of traces: rules without a rulebook of their own."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from rulec.diagnostics import Diagnostic, RulecError, Source
from rulec.logic.bounds import NotAMultipleError
from rulec.rulebook.asked_formula import FormulaQuery
from rulec.rulebook.elaborate.rule_messages import no_multiple
from rulec.rulebook.loader import find, parse_all, parse_rulebook, resolve_trees
from rulec.syntax import parse
from rulec.syntax.parser import parse_formula

_HEAD = re.compile(r"\s*(\(\s*\w+\s*(?::\s*\w+\s*)(?:,\s*\w+\s*(?::\s*\w+\s*)?)*\))")
"""Variables with their types, as in the head of a rule; no formula begins so."""

_NAME = "what_is_asked"


def bound_between_states(query: FormulaQuery, error: NotAMultipleError) -> RulecError:
    """The error (R0407) that a bound of the formula is no multiple of a trace's step."""
    return RulecError([no_multiple(query.rule, error)])


def read_query(
    text: str,
    *,
    rulebook: str = "",
    vocabulary: str = "road",
    search_path: Sequence[str | Path] = (),
    at: str = "",
) -> FormulaQuery:
    """Read a formula, with its variables before it, as in ``(v: vehicle) gap(v) < 5 m``.

    It is in the words of a vocabulary, or of a ``rulebook`` with its definitions and parameters.
    Raises RulecError with all that is wrong with it.
    """
    head = _HEAD.match(text)
    variables, formula = (head[1], text[head.end() :]) if head else ("", text)
    # That it is one formula, and nothing else.
    parse_formula(formula, "the formula")
    try:
        parts = text.strip(), variables, formula
        return _query(parts, (rulebook, vocabulary), search_path, at)
    except RulecError as error:
        raise RulecError([_said_of_a_formula(one) for one in error.diagnostics]) from None


def _said_of_a_formula(problem: Diagnostic) -> Diagnostic:
    """The diagnostic, with the way out where a formula has its variables."""
    if problem.help is None or "behind the rule's name" not in problem.help:
        return problem
    return replace(problem, help=problem.help.replace("behind the rule's name", _BEFORE))


_BEFORE = "before the formula"


def _query(
    parts: tuple[str, str, str],
    words: tuple[str, str],
    search_path: Sequence[str | Path],
    at: str,
) -> FormulaQuery:
    (text, variables, formula), (rulebook, vocabulary) = parts, words
    rule = f"soft rule {_NAME} {variables} {{\n  require {formula}\n}}\n"
    name = "the formula"
    if not rulebook:
        source = f"rulebook {_NAME} use {vocabulary}\n{rule}"
        found = parse_rulebook(source, name, [Path(one) for one in search_path], at)
    else:
        trees = parse_all(find(rulebook, search_path))
        base = trees.books[-1].name
        extends = "" if base is None else f" extends {base.text}"
        parsed, mistakes = parse(Source(name, f"rulebook {_NAME}{extends}\n{rule}"))
        asked = replace(
            trees,
            name=name,
            books=(*trees.books, parsed),
            mistakes=(*mistakes, *trees.mistakes),
        )
        # The law is that of the rulebook's day.
        law = trees.books[-1].law
        found = resolve_trees(asked, at or (law.as_of if law else "")).rulebook
    own = next(one for one in found.rules if one.name == _NAME)
    return FormulaQuery(text, own, found.vocabulary, found.semantics, found.traffic)
