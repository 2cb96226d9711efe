"""Help for bounds of time, such as ``[<= 3 s]``."""

from __future__ import annotations

from typing import Final

from rulec.syntax.keywords import OPERATOR_LETTERS, OPERATOR_WORDS
from rulec.syntax.messages.parse_context import ParseContext

_BOOLEAN: Final = frozenset(
    (
        *("not", "and", "or", "implies", "iff", "xor"),
        *("!", "&", "&&", "|", "||", "->", "<->", "^"),
    )
)
OVER_TIME: Final = (OPERATOR_WORDS | OPERATOR_LETTERS | {"[]", "<>"}) - _BOOLEAN
_BETWEEN: Final = ("to", "-", ",", ";", ":", "...", "and", "until")
_OPENINGS: Final = ("<=", ">=", "<", ">", "=", "{", "in", "within")
_FORMS: Final = "a bound is written `[<= 3 s]`, `[>= 1 s]`, `[1 s .. 4 s]` or `[2 steps]`"
_WITHIN: Final = {"within": "eventually", "for": "always", "during": "always", "after": "next"}


def advise_on_bound(scene: ParseContext) -> str:
    """Inside brackets, and where a bound was meant to stand."""
    if scene.opened("[", "]") is not None and not scene.operand:
        return _inside(scene)
    text, before = scene.text, scene.text_before
    if text == "[" and scene.operand and before in _BOOLEAN:
        return "only operators over time take a bound, such as `always[<= 3 s]`"
    if text == "[" and (scene.operand or scene.operator):
        return "a bound stands behind its operator, such as `always[<= 3 s] p`"
    if scene.operand and before in OVER_TIME and text in _OPENINGS:
        return f"a bound stands in brackets, such as `{before}[<= 3 s]`"
    for word, at in ((text, scene.at + 1), (before, scene.at)):
        if word in _WITHIN and scene.operator and scene.is_number(at):
            amount = scene.source.text[scene.tokens[at].start : _end_of_amount(scene, at)]
            sign = "" if word == "after" else "<= "
            return f"write `{_WITHIN[word]}[{sign}{amount}] p`"
    return ""


def _inside(scene: ParseContext) -> str:
    text, before = scene.text, scene.text_before
    if scene.accepted == {"UNIT"}:
        if text == "..":
            return "write the unit at both ends, such as `[3 s .. 4 s]`"
        return f"say what it counts: `{before} s` or `{before} steps`"
    if before == "[" and text in ("<", "=<", ">", "=>"):
        sign = "<=" if "<" in text else ">="
        return f"a bound includes its end: write `[{sign} 3 s]`"
    if before == "[" and text in ("=", "=="):
        return "for exactly that time write `[3 s]`"
    if before == "[" and text == "..":
        return "without a lower end write `[<= 3 s]`"
    if before == ".." and text == "]":
        return "without an upper end write `[>= 3 s]`"
    if text == "-" and "NUMBER" in scene.accepted:
        return "a bound counts forward, or back for `once` and its family: it has no sign"
    if "TO" in scene.accepted and text in _BETWEEN:
        return "write `..` between the two ends, such as `[3 s .. 4 s]`"
    if scene.accepted <= {"RSQB", "TO", "LPAR"} and text not in ("+", "*", "/", "-", ".."):
        return "close the bound with `]`"
    return _FORMS


def _end_of_amount(scene: ParseContext, at: int) -> int:
    unit = scene.token(at + 1)
    return unit.end if unit and unit.kind == "word" and at + 2 > scene.at else scene.tokens[at].end
