"""Help with commas and points in numbers, and the edit if only one number can be meant."""

from __future__ import annotations

import re
from typing import Final

from rulec.diagnostics import Fix, Span
from rulec.syntax.messages.parse_context import ParseContext
from rulec.syntax.scanner import Token

_DECIMALS: Final = re.compile(r"(\d+)([A-Za-z%]*)", re.ASCII)
_WHOLE: Final = re.compile(r"\d+|\d{1,3}(\.\d{3})+", re.ASCII)
"""A whole number, whose points part thousands."""

_THOUSANDS: Final = 3
"""The number of digits behind a comma that may part thousands."""


def advise_on_point(ctx: ParseContext) -> str:
    """Advice on a comma or a point beside a number; empty if there is none."""
    if ctx.text == "," and ctx.is_number(ctx.at - 1) and ctx.is_number(ctx.at + 1):
        if ctx.text_at(ctx.at + 2) == ",":
            return "a number's digits are written together, such as `1000000`"
        return _with_a_point(ctx.text_before, ctx.text_behind, touching=_is_one_number(ctx))
    if ctx.text == "." and ctx.is_number(ctx.at - 1) and ctx.touches() and ctx.operator:
        number = ctx.text_before
        return f"a point stands between two digits: write `{number}` or `{number}.0`"
    return ""


def point_fix(ctx: ParseContext) -> Fix | None:
    """The edit of the whole number at an unexpected comma or point; None if it is not certain."""
    first, last = ctx.before, ctx.token(ctx.at + 1)
    if ctx.unexpected is None:
        return None
    if ctx.text == "," and first is not None and last is not None and _is_one_number(ctx):
        whole, rest = first.text.replace(".", ""), _DECIMALS.fullmatch(last.text)
        if _WHOLE.fullmatch(first.text) and rest and not _may_be_thousands(first.text, rest[1]):
            return _fix(ctx, first, last, f"{whole}.{last.text}")
    if ctx.text == "." and ctx.quantity and ctx.is_number(ctx.at + 1) and last is not None:
        beside = first is not None and first.end == ctx.unexpected.start
        is_own = last.text.isdecimal() and last.start == ctx.unexpected.end
        word = first is not None and first.kind != "symbol"
        if is_own and not (beside and word):
            return _fix(ctx, ctx.unexpected, last, f"0.{last.text}")
    return None


def _fix(ctx: ParseContext, first: Token, last: Token, number: str) -> Fix:
    return Fix(Span(ctx.source, first.start, last.end).place, number)


def _is_one_number(ctx: ParseContext) -> bool:
    """Whether a comma has digits right before and behind it, and parts no two ends of a bound."""
    token, behind = ctx.unexpected, ctx.token(ctx.at + 1)
    if token is None or behind is None or not ctx.touches() or token.end != behind.start:
        return False
    return not (ctx.opened("[", "]") == ctx.at - 2 or ctx.text_at(ctx.at + 2) == ",")


def _may_be_thousands(whole: str, rest: str) -> bool:
    return len(rest) == _THOUSANDS and len(whole) <= _THOUSANDS and not whole.startswith("0")


def _with_a_point(whole: str, rest: str, *, touching: bool) -> str:
    digits = whole.replace(".", "")
    thousands, point, parts = rest.partition(".")
    decimals = _DECIMALS.fullmatch(rest)
    rest, unit = (decimals[1], decimals[2]) if decimals else (rest, "")
    if touching and point and _may_be_thousands(whole, thousands):
        return f"a number's digits are written together: `{whole}{thousands}.{parts}`"
    if touching and _may_be_thousands(whole, rest):
        fewer = f"{whole}.{rest}".rstrip("0").rstrip(".")
        return (
            f"say which is meant: `{whole}{rest}{unit}` if the comma parts thousands, "
            f"`{fewer}{unit}` if it parts decimals"
        )
    if _WHOLE.fullmatch(whole):
        return f"write a point: `{digits}.{rest}{unit}`"
    return "a number has digits and one point, such as `1000.5`"
