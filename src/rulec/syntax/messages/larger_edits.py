"""Edits of lists, lines, clauses and braces, as far as the text around a place shows them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Final

from rulec.diagnostics import Fix, Offer, Span
from rulec.diagnostics.ways_out import (
    end_before,
    left_out,
    line_left_out,
    put,
    short,
    text_before,
    write,
)
from rulec.syntax.keywords import DECLARATION_WORDS, PROVISION_WORDS

_CLAUSES: Final = (
    "accept|also|cite|level|note|otherwise|reject|require|says|title|topic|unless|weight|when"
)
_NEXT_CLAUSE: Final = re.compile(rf"[ \t]*(?:\b(?:{_CLAUSES})\b|\bin\s+force\b|\}})|\n")
_BINDS_LOOSELY: Final = re.compile(
    rf"\b(?:or|xor|implies|iff|then|if|{_CLAUSES})\b|in\s+force|[|^>#]", re.IGNORECASE
)
"""Signs that `and` would part otherwise than a new clause does, and clauses in between."""


def member_left_out(span: Span) -> Iterator[Offer]:
    """One of a list left out with its comma or its parentheses; none if it is no whole member."""
    text = span.source.text
    title = f"Leave out `{short(span.text)}`"
    before = re.search(r"([,(]?)\s*\Z", text_before(span))
    behind = re.compile(r"\s*([,)]?)\s*").match(text, span.end)
    assert before is not None, "it may be empty"
    assert behind is not None, "it may be empty"
    start, end = span.start - len(before[0]), behind.end()
    if before[1] == "," and text[end : end + 1] not in (":", "("):
        yield left_out(Span(span.source, start, span.end), title)
    elif behind[1] == ",":
        yield left_out(Span(span.source, span.start, end), title)
    elif (before[1], behind[1]) == ("(", ")"):
        opened = end_before(Span(span.source, start, start))
        end = text.index(")", span.end) + 1
        yield left_out(Span(span.source, opened, end), f"Leave out `({short(span.text)})`")


def declaration_left_out(span: Span) -> Iterator[Offer]:
    """The line of a declaration, in which there is a span, left out; no law is on it."""
    yield from line_left_out(span, *DECLARATION_WORDS, *PROVISION_WORDS)


def name_left_out(span: Span) -> Iterator[Offer]:
    """A name left out of its list, or else with its line."""
    members = tuple(member_left_out(span))
    yield from members or declaration_left_out(span)


def clause_left_out(span: Span) -> Offer:
    """A clause left out, up to the next one or its line's end."""
    text = span.source.text
    behind = _NEXT_CLAUSE.search(text, span.end)
    last = behind.start() if behind else len(text)
    whole = Span(span.source, end_before(span), last)
    return left_out(whole, f"Leave out this `{span.text}`")


def requirements_joined(again: Span) -> Iterator[Offer]:
    """Two requirements as one, if `and` binds in it as it would between them."""
    text = again.source.text
    first = text.rfind("require", 0, again.start)
    behind = _NEXT_CLAUSE.search(text, again.end)
    both = text[first : again.start] + text[again.end : behind.start() if behind else len(text)]
    if first >= 0 and not _BINDS_LOOSELY.search(both.removeprefix("require")):
        yield write("and", again)


def brace_closed(missing: Span) -> Offer:
    """A closing brace on the line above a place, or behind what is before it on its line."""
    first = missing.source.text.rfind("\n", 0, missing.start) + 1
    if first and not missing.source.text[first : missing.start].strip():
        return put("Put `}` here", "}\n", missing, first)
    return put("Put `}` here", "\n}\n", missing, missing.start)


MOST_MOVED: Final = 2000
"""How many characters are moved at most: each of many mistakes offers them anew."""


def end_of_clause(text: str, start: int) -> int:
    """The end of a clause's braces, or of its line."""
    end = text.find("\n", start)
    line = len(text) if end < 0 else end
    if "{" not in text[start:line]:
        return line
    depth = 0
    for offset in range(text.index("{", start), min(len(text), start + MOST_MOVED)):
        depth += {"{": 1, "}": -1}.get(text[offset], 0)
        if depth == 0:
            return offset + 1
    return line


def exchanged(span: Span, first: str, second: str) -> Iterator[Offer]:
    """Two parts of a span, each in the place of the other."""
    head, found, rest = span.text.partition(first)
    middle, also_found, tail = rest.rpartition(second)
    if found and also_found:
        yield write(f"{head}{second}{middle}{first}{tail}", span)


_QUANTIFIED: Final = re.compile(r"\b(?:every|some|no)\s+\w+\s*:\s*\w+[^()]*\(\s*$")
_OPERATOR: Final = re.compile(r"\w+(?:\s*\[[^]]*\])?\s+")


def operator_outside(span: Span) -> Iterator[Offer]:
    """An operator over time put before the quantifier that it is in."""
    quantified = _QUANTIFIED.search(text_before(span))
    operator = _OPERATOR.match(span.text)
    if quantified and operator:
        word = operator[0].strip()
        moved = f"{word} {quantified[0]}{span.text[operator.end() :]}"
        whole = Span(span.source, span.start - len(quantified[0]), span.end)
        yield Offer(f"Put `{word}` around it", (Fix(whole.place, moved),))


_SCOPE: Final = re.compile(r"\b(?:throughout|at\s+start|at\s+end|at\s+some\s+point|initially)\b")


def with_scope(exception: Span, *scopes: str) -> Iterator[Offer]:
    """An exception with another scope, or with one that it lacks."""
    written = _SCOPE.search(exception.text)
    for scope in scopes:
        if written:
            start = exception.start + written.start()
            yield write(scope, Span(exception.source, start, exception.start + written.end()))
        else:
            yield put(f"Put `{scope}` behind it", f" {scope}", exception, exception.end)
