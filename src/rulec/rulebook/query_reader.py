"""Reads queries: a formula is read as the only rule of a rulebook built around it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from rulec.diagnostics import Diagnostic, RulecError, Source, SourceLocation, Span
from rulec.rulebook.elaborate.time_reach_messages import FIRST_STATE_ONLY
from rulec.rulebook.loader import (
    Trees,
    find,
    load_vocabulary,
    parse_all,
    parse_rulebook,
    resolve_trees,
    with_book,
)
from rulec.rulebook.query_model import FormulaQuery
from rulec.rulebook.rulebook_model import Rulebook
from rulec.syntax.parser import parse_formula

_HEAD = re.compile(r"\s*(\(\s*\w+\s*(?::\s*\w+\s*)(?:,\s*\w+\s*(?::\s*\w+\s*)?)*\))")
"""Variables with their types, as in the head of a rule; no formula begins like this."""

_A_RULE = re.compile(r"\b([Tt]he|[Aa]) rule\b")
_A_FORMULA = r"\1 formula"

_NAME = "what_is_asked"
_QUERY = "the formula"
_NO_WORD = (
    "`rulec list vocabularies` says where words are; those of a rulebook take `--rulebook NAME`"
)
_USUAL = "road"


def read_query(
    text: str,
    *,
    rulebook: str = "",
    vocabulary: str = "",
    search_path: Sequence[str | Path] = (),
    at: str = "",
) -> FormulaQuery:
    """Read a formula, with its variables before it, as in ``(v: vehicle) gap(v) < 5 m``.

    It is in the words of a vocabulary, of a ``rulebook`` with its definitions and parameters, or of
    both; by default of ``road``. Raises RulecError with all mistakes.
    """
    head = _HEAD.match(text)
    begin = head.end() if head else 0
    formula = text[begin:]
    source = Source(_QUERY, text)
    folders = [Path(folder) for folder in search_path]
    program = Source(_QUERY, formula)
    parts: tuple[tuple[int, int, int], ...] = ((0, begin, len(formula)),)
    try:
        # That it is one formula, and nothing else.
        parse_formula(formula, _QUERY)
        trees = parse_all(find(rulebook, folders)) if rulebook else None
        words = vocabulary or ("" if rulebook else _USUAL)
        first = f"rulebook {_NAME}" + (f" use {_word(words, folders)}" if words else "")
        if trees is not None:
            base = trees.books[-1].name
            words = rulebook if base is None else base.text
            first += "" if base is None else f" extends {words}"
        first += "\n"
        first += f"soft rule {_NAME} "
        second = f"{head[1] if head else ''} {{\n  require "
        program = Source(_QUERY, f"{first}{second}{formula}\n}}\n")
        parts = ((len(first + second), begin, len(formula)),)
        if head:
            parts = (*parts, (len(first), head.start(1), len(head[1])))
        resolved = _resolved(program, trees, folders, at)
    except RulecError as error:
        places = QueryPlaces(source, program, parts)
        # A query is evaluated at each moment, not in the first state only.
        wrong = [x for x in error.diagnostics if x.code != FIRST_STATE_ONLY.code]
        raise RulecError([places.relocated(_in_words(x)) for x in wrong]) from None
    own = next(rule for rule in resolved.rules if rule.name == _NAME)
    named = replace(resolved.vocabulary, name=words)
    return FormulaQuery(text.strip(), own, named, resolved.semantics, resolved.traffic)


def _in_words(problem: Diagnostic) -> Diagnostic:
    """The diagnostic in words for a formula, where there is no rule and nothing is declared."""
    way_out = problem.help.replace("after the rule's name", "before the formula")
    way_out = re.sub(r": `use (\w+)`$", r": `--use \1`", way_out)
    way_out = re.sub(r"^declare it, such as .*", _NO_WORD, way_out)
    way_out = re.sub(r": `extends ([\w-]+)`(, or copy it)?$", r": `--rulebook \1`", way_out)
    message = problem.message.replace(f" of `{_NAME}`", "")
    message = message.replace(f"rule `{_NAME}`", "the formula")
    return replace(
        problem,
        message=_A_RULE.sub(_A_FORMULA, message),
        expected=_A_RULE.sub(_A_FORMULA, problem.expected),
        help=_A_RULE.sub(_A_FORMULA, way_out),
        notes=tuple(_A_RULE.sub(_A_FORMULA, note) for note in problem.notes),
    )


def _word(vocabulary: str, folders: Sequence[Path]) -> str:
    """The name of a vocabulary. Raises RulecError R0703 for an impossible name."""
    if re.fullmatch(r"[^\W\d]\w*", vocabulary) is None:
        try:
            load_vocabulary(vocabulary, folders)
        except RulecError as error:
            unplaced = [
                replace(diagnostic, place=None, expected="") for diagnostic in error.diagnostics
            ]
            raise RulecError(unplaced) from None
    return vocabulary


def _resolved(program: Source, trees: Trees | None, folders: Sequence[Path], at: str) -> Rulebook:
    if trees is None:
        return parse_rulebook(program.text, program.name, folders, at)
    return resolve_trees(with_book(trees, program, folders), at).rulebook


@dataclass(frozen=True, slots=True)
class QueryPlaces:
    """The text of a ``query``, and the ``program`` that contains parts of it.

    ``parts`` are the start of each part in the program, its start in the query, and its length, in
    characters. Messages use the same name for both texts.
    """

    query: Source
    program: Source
    parts: tuple[tuple[int, int, int], ...]

    def relocated(self, problem: Diagnostic) -> Diagnostic:
        """The diagnostic with its places in the query.

        Places in the rest of the program are dropped.
        """
        place = problem.place and self._place(problem.place)
        moved = ((label, self._place(label.place)) for label in problem.labels)
        labels = tuple(
            replace(label, place=location) for label, location in moved if location is not None
        )
        expected = problem.expected if place is not None else ""
        return replace(problem, place=place, labels=labels, expected=expected)

    def _place(self, place: SourceLocation) -> SourceLocation | None:
        if place.file != self.program.name or place.line is None or place.column is None:
            return place
        lines = self.program.text.split("\n")
        start = sum(len(line) + 1 for line in lines[: place.line - 1]) + place.column - 1
        for begin, in_query, length in self.parts:
            if begin <= start <= begin + length:
                shift = in_query - begin
                end = start + max((place.end_column or 0) - place.column, 0)
                if place.end_line != place.line:
                    end = begin + length
                return Span(self.query, start + shift, min(end, begin + length) + shift).place
        return None
