"""A formula as source text, broken at operators into narrow lines."""

from __future__ import annotations

import re
from collections.abc import Iterator

from rulec.logic.fold import fold_constants
from rulec.logic.formula import Formula
from rulec.logic.printing import formula_text
from rulec.rulebook.rulebook_model import Rule

INDENT = "  "

_BOUND = r"(\[[^]]*\])?"

# From the loosest to the tightest, as in the grammar. `weak until` is one operator.
_OPERATORS = [
    re.compile(rf"(?<!\bweak)(?<!\bstrong) (?={words} )")
    for words in (
        "iff",
        "implies",
        f"then{_BOUND}",
        "xor",
        "or",
        "and",
        f"(weak until|strong release|until|release|since){_BOUND}",
    )
]


def plain_text(formula: Formula) -> str:
    """A formula as source text, without the constants that the options of a rulebook become."""
    return formula_text(fold_constants(formula))


def plain_clauses(rule: Rule) -> list[tuple[str, str]]:
    """The words and texts of a rule's clauses, without exceptions that never hold as set."""
    clauses = [] if rule.condition is None else [("when", plain_text(rule.condition))]
    clauses.append(("require", plain_text(rule.required or rule.formula)))
    exempt = ((plain_text(exemption.formula), exemption.scope) for exemption in rule.exemptions)
    return clauses + [("unless", f"{text} {scope}") for text, scope in exempt if text != "false"]


def formula_lines(text: str, width: int) -> list[str]:
    """The lines of a formula given as one line.

    It is broken before the operators that bind loosest, and after parentheses whose content is too
    long for a line. Only a part without an operator outside of brackets may exceed ``width``.
    """
    return list(_lines(text, width))


def _lines(text: str, width: int) -> Iterator[str]:
    if len(text) <= width:
        yield text
        return
    outside = _outside(text)
    for operator in _OPERATORS:
        cuts = [match_.start() for match_ in operator.finditer(text) if outside[match_.start()]]
        if cuts:
            starts = [0, *(cut + 1 for cut in cuts)]
            for start, end in zip(starts, [*cuts, len(text)], strict=True):
                first, *rest = _lines(text[start:end], width if not start else width - len(INDENT))
                yield first if not start else f"{INDENT}{first}"
                yield from (f"{INDENT}{line}" for line in rest)
            return
    opening = text.find("(")
    if opening >= 0 and text.endswith(")") and not any(outside[opening + 1 : -1]):
        yield text[: opening + 1]
        for line in _lines(text[opening + 1 : -1], width - len(INDENT)):
            yield f"{INDENT}{line}"
        yield ")"
        return
    yield text


def _outside(text: str) -> list[bool]:
    """For every character: whether it is outside of all parentheses and brackets."""
    depth, result = 0, []
    for character in text:
        depth += (character in "([") - (character in ")]")
        result.append(depth == 0)
    return result
