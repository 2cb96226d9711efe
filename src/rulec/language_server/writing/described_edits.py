"""Edits that a help text describes in words: renaming, moving, deleting, or changing another place.

None of them is certain to be what is meant, so each is tried before it is offered.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from fractions import Fraction
from itertools import count

from rulec.diagnostics import Diagnostic
from rulec.language_server.names.renaming import TextChange

Edit = tuple[str, tuple[TextChange, ...]]
"""The edit's title in the editor, and its changes."""

_CLAUSES = (
    "accept|also|cite|level|note|otherwise|reject|require|says|title|topic|unless|weight|when"
)
_NEXT_CLAUSE = re.compile(rf"[ \t]*(?:\b(?:{_CLAUSES})\b|\bin\s+force\b|\}})|\n")
_NUMBER_WITH_UNIT = re.compile(r"\d[\d.,/]*(?: \w[\w/]*)?")
_TWO_ENDS = re.compile(r"(\d[\w. /-]*?)(?:\s*\.\.\s*|\s+until\s+)(\d[\w. /-]*)")
_CHANGED_BY = re.compile(r"`(?P<head>(?:set|redefine) \w+) = …`")
_SCOPE = re.compile(r"\b(?:throughout|at\s+start|at\s+end|at\s+some\s+point|initially)\b")
_QUANTIFIED = re.compile(r"\b(?:every|some|no)\s+\w+\s*:\s*\w+[^()]*\(\s*$")
_BEFORE_VARIABLE = re.compile(r"\b(?:every|some|no|count|least|most)\s+$")
_DATE = re.compile(r"\d[\d./-]*\d")
_BINDS_LOOSELY = re.compile(
    rf"\b(?:or|xor|implies|iff|then|if|{_CLAUSES})\b|in\s+force|[|^>#]", re.IGNORECASE
)
"""Signs that `and` would part otherwise than a new clause does, and clauses in between."""
_OPERATOR = re.compile(r"\w+(?:\s*\[[^]]*\])?\s+")


def described_edits(
    finding: Diagnostic, text: str, start: int, end: int, stem: str
) -> Iterator[Edit]:
    """The edits for a finding about ``text[start:end]``, the most likely first.

    ``stem`` is the name of the file without its extension.
    """
    help_text, message, own = finding.help, finding.message, text[start:end]
    if "`rulebook NAME`" in help_text and stem.isidentifier():
        yield _edit(f"Begin with `rulebook {stem}`", 0, 0, f"rulebook {stem}\n")
    if "between the `{` and the `}` of their rule" in help_text:
        yield from _into_the_braces(text, start, _end_of_clause(text, start))
    if help_text.startswith("move it before the `}`"):
        yield from _into_the_braces(text, start, len(text.rstrip()))
    if match := re.search(r"looks like `(\w+)`", message):
        yield from _in_other_letters(own, match[1], text)
    if match := re.search(r"`(override rule) \w+`", help_text):
        begin = text.rfind("confirm rule", 0, start)
        if begin >= 0:
            yield _edit("Override the rule", begin, begin + len("confirm rule"), match[1])
    is_law = own in ("require", "when", "unless")  # what of it is law, only the author knows
    if help_text.endswith("or leave this out") or (help_text == "keep one of them" and not is_law):
        behind = _NEXT_CLAUSE.search(text, end)
        last = behind.start() if behind else len(text)
        yield _edit(f"Leave out this `{own}`", len(text[:start].rstrip()), last, "")
    if match := re.search(r"takes its words from it by `(use \w+)`", help_text):
        first = text.rfind("\n", 0, start) + 1
        yield _edit(f"Write `{match[1]}`", first, _line_end(text, start), match[1])
    if match := _CHANGED_BY.search(help_text):
        yield from _changing(match["head"], text, start)
    if match := re.match(r"this state leaves open `([^`(]+)`,", message):
        for words in (f"not {match[1]}", match[1]):
            yield _edit(f"Say `{words}` in this state", end, end, f" and {words}")
    if " can mean " in message:
        for reading in re.findall(r"`([^`]+)`", message)[1:]:
            yield _edit(f"Write `{reading}`", start, end, reading)
    if help_text.startswith("exchange the") and (ends := _TWO_ENDS.search(own)):
        (low, low_end), (high, high_end) = ends.span(1), ends.span(2)
        turned = own[:low] + ends[2] + own[low_end:high] + ends[1] + own[high_end:]
        yield _edit(f"Write `{turned}`", start, end, turned)
    if help_text.startswith("the nearest multiple"):
        was = message.split("`")[1]
        begin = text.find(was, start, end)
        near = [words for words in _NUMBER_WITH_UNIT.findall(help_text) if _is_near(words, was)]
        for number in near if begin >= 0 else ():
            yield _edit(f"Write `{number}`", begin, begin + len(was), number)
    if match := re.match(r"that month has (\d+) days", help_text):
        last_day = re.sub(r"\d+$", match[1], own)
        yield _edit(f"Write `{last_day}`", start, end, last_day)
    if "`initially`" in help_text or "`at some point`" in help_text:
        yield from _another_scope(help_text, text, start, end)
    if help_text.startswith("put the operator around it"):
        yield from _operator_outside(text, start, end)
    if help_text.startswith("leave out `is …`"):
        begin = len(text[:start].rstrip()) - len("is")
        yield _edit(f"Leave out `is {own}`", len(text[:begin].rstrip()), end, "")
    if "give it a weight" in help_text and (match := re.search(r"\b0+(?:\.0*)?\b", own)):
        yield _edit("Write `1`", start + match.start(), start + match.end(), "1")
    if match := re.search(r"^declare it as `([^`…]+)`", help_text):
        yield from _as_declared(match[1], text, start)
    if match := re.search(r"the (?:rule|definition)'s only variable is `(\w+)`$", help_text):
        yield _edit(f"Write `{match[1]}`", start, end, match[1])
    if match := re.search(r"^a date is written year-month-day: `(\d{4}-\d\d-\d\d)`", help_text):
        day = _DATE.match(text, start)
        if day is not None:
            yield _edit(f"Write `{match[1]}`", *day.span(), match[1])
    if help_text.startswith("join them by `and`"):
        yield from _joined(text, start, end)
    if help_text.startswith("keep one of them, or put a `;`"):
        joint = re.search(r"\s*\band\s+$", text[:start])
        if joint is not None:
            yield _edit(f"Leave out `and {own}`", joint.start(), end, "")
            yield _edit(f"Put `;` before `{own}`", joint.start(), start, "; ")


def declares_in_formula(text: str, start: int) -> bool:
    """Whether a quantifier's variable is declared at a place; all its uses belong to it."""
    return _BEFORE_VARIABLE.search(text[:start]) is not None


def _is_near(amount: str, was: str) -> bool:
    """Whether two numbers differ by at most a twentieth, so that the law stays about the same."""
    first, second = (Fraction(number.split()[0].replace(",", "")) for number in (amount, was))
    return abs(first - second) * 20 <= second


def another_name(finding: Diagnostic, text: str, start: int, end: int) -> Iterator[Edit]:
    """An unused name, if the help asks for another one."""
    if "another name" in finding.help or "a name of its own" in finding.help:
        name = _free(text[start:end], text)
        yield _edit(f"Call it `{name}`", start, end, name)


def _edit(title: str, start: int, end: int, text: str) -> Edit:
    return title, (TextChange(start, end, text),)


def _line_end(text: str, offset: int) -> int:
    end = text.find("\n", offset)
    return len(text) if end < 0 else end


def _free(name: str, text: str) -> str:
    """A variant of this name that does not occur in a text."""
    return next(
        f"{name}_{number}" for number in count(2) if not re.search(rf"\b{name}_{number}\b", text)
    )


def _end_of_clause(text: str, start: int) -> int:
    """The end of a clause's braces, or of its line."""
    line = _line_end(text, start)
    if "{" not in text[start:line]:
        return line
    depth = 0
    for offset in range(text.index("{", start), len(text)):
        depth += {"{": 1, "}": -1}.get(text[offset], 0)
        if depth == 0:
            return offset + 1
    return line


def _into_the_braces(text: str, start: int, end: int) -> Iterator[Edit]:
    brace = text.rfind("}", 0, start)
    if brace >= 0:
        inside = f"{text[brace + 1 : end].rstrip()}\n}}"
        yield _edit("Put it inside the braces", brace, end, inside)
        yield _edit("Leave out the `}` before it", brace, brace + 1, "")


def _in_other_letters(own: str, like: str, text: str) -> Iterator[Edit]:
    """The name spelt like the similar one; where both are meant, a name of its own."""
    where = [match.span() for match in re.finditer(rf"\b{re.escape(own)}\b", text)]
    for name in (like, _free(like, text)):
        yield f"Write `{name}`", tuple(TextChange(*span, name) for span in where)


def _changing(head: str, text: str, start: int) -> Iterator[Edit]:
    """Set or redefine an inherited symbol instead of declaring it again."""
    first = text.rfind("\n", 0, start) + 1
    equals = text.find("=", start, _line_end(text, start))
    if equals >= 0:
        yield _edit(f"Write `{head} = …`", first, equals, f"{head} ")


def _another_scope(help_text: str, text: str, start: int, end: int) -> Iterator[Edit]:
    for scope in re.findall(r"`([a-z ]+)`", help_text):
        if not _SCOPE.fullmatch(scope):
            continue
        if match := _SCOPE.search(text, start, end):
            yield _edit(f"Write `{scope}`", *match.span(), scope)
        else:
            yield _edit(f"Put `{scope}` behind it", end, end, f" {scope}")


def _operator_outside(text: str, start: int, end: int) -> Iterator[Edit]:
    quantified = _QUANTIFIED.search(text[:start])
    operator = _OPERATOR.match(text, start, end)
    if quantified and operator:
        word = operator[0].strip()
        moved = f"{word} {quantified[0]}{text[operator.end() : end]}"
        yield _edit(f"Put `{word}` around it", quantified.start(), end, moved)


def _as_declared(words: str, text: str, start: int) -> Iterator[Edit]:
    """A variable's type, as it is declared in the head of its rule."""
    name, _, _ = words.partition(":")
    declared = [*re.finditer(rf"\b{re.escape(name)}\s*:\s*\w+", text[:start])]
    if declared:
        yield _edit(f"Write `{words}`", *declared[-1].span(), words)


def _joined(text: str, start: int, end: int) -> Iterator[Edit]:
    """Two requirements as one, if `and` binds in it as it would between them."""
    first = text.rfind("require", 0, start)
    behind = _NEXT_CLAUSE.search(text, end)
    both = text[first:start] + text[end : behind.start() if behind else len(text)]
    if first >= 0 and not _BINDS_LOOSELY.search(both.removeprefix("require")):
        yield _edit("Write `and`", start, end, "and")
