"""Help with numbers, sums and comparisons."""

from __future__ import annotations

import re
import unicodedata
from typing import Final

from rulec.diagnostics.ways_out import Help, offering
from rulec.syntax import keywords
from rulec.syntax.messages.literals import hours_meant, how_hours_are_written
from rulec.syntax.messages.parse_context import COMPARISONS, ParseContext

_SIGNS: Final = {
    **dict.fromkeys(("≤", "=<", "⩽"), "<="),
    **dict.fromkeys(("≥", "⩾", ">=="), ">="),
    **dict.fromkeys(("≠", "<>", "!=="), "!="),
    **dict.fromkeys(("×", "·"), "*"),
    **dict.fromkeys(("−", "–", "—", "‒", "―"), "-"),
    "÷": "/",
}
_IN_WORDS: Final[dict[tuple[str, ...], str]] = {
    ("less", "than"): "<",
    ("more", "than"): ">",
    ("greater", "than"): ">",
    ("at", "least"): ">=",
    ("at", "most"): "<=",
    ("equal", "to"): "=",
    ("below",): "<",
    ("above",): ">",
}
RELATIONS: Final = ("<", "<=", "=", "!=", ">=", ">")


def sign_in_words(before: str, text: str) -> str:
    """The sign for two words, such as `at least`; empty for others."""
    return _IN_WORDS.get((before, text), "")


ABSOLUTE: Final = ("abs", "absolute", "magnitude")
NO_ABSOLUTE_VALUE: Final = (
    "there is no absolute value: say both limits, such as `-3 km/h <= x and x <= 3 km/h`"
)


def advise_on_number(ctx: ParseContext) -> Help:
    """Advice on numbers, their digits and units; empty if there is none."""
    token, text = ctx.unexpected, ctx.text
    if token is None or not (ctx.operator or ctx.quantity):
        return ""
    if text == ":" and ctx.is_number(ctx.at - 1) and ctx.is_number(ctx.at + 1):
        hours = f"{ctx.text_before}:{ctx.text_behind}"
        last = ctx.at + 1 + (ctx.text_at(ctx.at + 2) == "h")
        written = (ctx.write(one, ctx.at - 1, last) for one in hours_meant(hours))
        way_out = how_hours_are_written(hours)
        return offering(way_out, *written) if way_out else ""
    if len(ctx.text_before) == 1 and unicodedata.numeric(ctx.text_before, 0) % 1:
        number = f"{unicodedata.numeric(ctx.text_before):g}"
        return offering(f"write `{number}` for `{ctx.text_before}`", ctx.write(number, ctx.at - 1))
    around = ctx.is_number(ctx.at - 1) and ctx.is_number(ctx.at + 1)
    if text == "of" and ctx.text_before == "%" and ctx.is_number(ctx.at - 2):
        share = f"{ctx.text_at(ctx.at - 2)} %"
        return offering(
            f"for `{share} of` write `{share} *`", ctx.write(f"{share} *", ctx.at - 2, ctx.at)
        )
    if text == "." and ctx.quantity and ctx.is_number(ctx.at + 1):
        return f"write `0.{ctx.text_behind}`"
    grouped = "_" in ctx.text_before or ctx.is_number(ctx.at)
    if (ctx.is_number(ctx.at - 1) and grouped) or (text.startswith("'") and around):
        return "a number's digits are written together, such as `1000`"
    if not ctx.operator:
        return ""
    if ctx.is_number(ctx.at) and (
        ctx.text_before == ")" or ctx.text_before not in keywords.RESERVED
    ):
        return "a quantity is compared by `<`, `<=`, `=`, `!=`, `>=` or `>`"
    factor = ctx.is_word() and text not in keywords.RESERVED
    if factor and ctx.is_number(ctx.at - 2) and ctx.text_before == "%":
        return f"write `{ctx.text_at(ctx.at - 2)} % * {text}` for a product"
    if factor and ctx.is_number(ctx.at - 2) and ctx.before and ctx.before.kind == "word":
        return f"write `{ctx.text_before} * {text}` for a product"
    return ""


def advise_on_comparison(ctx: ParseContext) -> Help:
    """Advice on comparisons and their signs; empty if there is none."""
    text, before = ctx.text, ctx.text_before
    numbers = ctx.is_number(ctx.at + 1) or ctx.is_number(ctx.at - 1)
    if ctx.operator and text == "=>" and numbers:
        return offering("write `>=` for at least; `=>` would be `implies`", ">=")
    if ctx.operator and text == "is":
        words = (ctx.text_behind, ctx.text_at(ctx.at + 2))
        key = words[:1] if words[:1] in _IN_WORDS else words
        if sign := _IN_WORDS.get(key):
            return offering(
                f"for `is {' '.join(key)}` write `{sign}`",
                ctx.write(sign, ctx.at, ctx.at + len(key)),
            )
        no, value = ("not ", words[1]) if words[0] == "not" else ("", words[0])
        if before == ")" and value.isidentifier() and value not in keywords.RESERVED:
            instead = f"{no}{value}{_called(ctx)}"
            return f"a value is written in place of what it is one of: `{instead}`"
        if words[0].isidentifier() and words[0] not in keywords.RESERVED:
            about = f"`{words[0]}({before})`"
            if re.search(rf"\b{re.escape(before)}\s*:", ctx.source.text):
                return f"what is of an object is written {about}"
            return f"a value is written alone, such as `{words[0]}`; of an object it is {about}"
        return "quantities are compared by `<`, `<=`, `=`, `!=`, `>=` or `>`"
    if ctx.operator and ctx.is_number(ctx.at + 1) and (sign := _IN_WORDS.get((before, text))):
        number = ctx.text_behind
        return f"how many follows what is counted: `count x: vehicle (…) {sign} {number}`"
    at_sign = sign_in_words(text, ctx.text_behind) if ctx.operator and text == "at" else ""
    if at_sign and ctx.is_number(ctx.at + 2):
        lasting = f"how long something lasts is a bound, such as `historically[{at_sign} 3 s] p`"
        return offering(
            f"for `at {ctx.text_behind}` write `{at_sign}`; {lasting}",
            ctx.write(at_sign, ctx.at, ctx.at + 1),
        )
    if ctx.operator and text == "==":
        value = ctx.text_behind if ctx.text_behind.isidentifier() else ""
        alone = f"; one of several values is written alone: `{value}`" if value else ""
        return offering(
            f"quantities are compared by `=`, formulas by `iff`{alone}",
            *map(ctx.write_sign, ("=", "iff")),
        )
    if ctx.operator and text == ":=":
        return offering("write `=` for `:=`", "=")
    if text == "·" and before.isalpha() and ctx.text_at(ctx.at + 2) == "⁻":
        power = unicodedata.normalize("NFKC", ctx.text_at(ctx.at + 3))
        unit = f"{before}/{ctx.text_behind}{f'^{power}' if power != '1' else ''}"
        return f"write the unit as `{unit}`"
    if (ctx.operator or ctx.quantity) and text in _SIGNS:
        return offering(f"write `{_SIGNS[text]}`", _SIGNS[text])
    if before == "-" and text == ">":
        return offering("write `->` without a space", ctx.write("->", ctx.at - 1, ctx.at))
    if before in ("<", ">") and text == "=":
        return offering(
            f"write `{before}=` without a space", ctx.write(f"{before}=", ctx.at - 1, ctx.at)
        )
    if before == "=" and text == "!":
        return offering("write `!=`", ctx.write("!=", ctx.at - 1, ctx.at))
    if text == "**" or (before == "^" and ctx.is_number(ctx.at)):
        return "powers cannot be written; arithmetic is linear"
    if ctx.operator and text in RELATIONS and not ctx.accepted & COMPARISONS:
        return _chain(ctx)
    if ctx.operator and text == "in" and ctx.text_behind in ("{", "(", "["):
        return _any_value(ctx)
    ahead = any(ctx.is_number(ctx.at + number) for number in (1, 2))
    if ctx.operator and text in ("between", "in") and ahead:
        return "write `a <= x and x <= b`"
    if ctx.operator and text == "in" and ctx.text_behind.isidentifier():
        case = ctx.text_behind
        if ctx.first in ("unless", "also", "when"):
            return f"for `… in {case}` write `… and {case}`"
        return f"for `… in {case}` write `{case} implies …`, or after `never` `{case} and …`"
    if text == "+" and ctx.quantity:
        return offering("delete the `+`", ctx.leave_out(ctx.at))
    if text in ("|", "||") and ctx.quantity:
        closing = (token for token in ctx.tokens[ctx.at + 1 :] if token.text in ("|", "||"))
        return NO_ABSOLUTE_VALUE if any(closing) else ""
    return ""


def _any_value(ctx: ParseContext) -> str:
    """Advice on ``lateral(v) in {left_of, right_of}``: write an atom for each value."""
    values: list[str] = []
    for token in ctx.tokens[ctx.at + 2 :]:
        if token.kind == "word":
            values.append(token.text)
        elif token.text != ",":
            break
    choice = " or ".join(f"{value}{_called(ctx)}" for value in values[:3])
    return f"each value stands for itself: write `{choice}`" if values else ""


def _called(ctx: ParseContext) -> str:
    """The arguments before the unexpected token: `(v)` behind `lateral(v)`."""
    opened = next((n for n in range(ctx.at - 1, 0, -1) if ctx.text_at(n) == "("), None)
    if ctx.text_before != ")" or opened is None:
        return ""
    return "".join(token.text for token in ctx.tokens[opened : ctx.at])


def _chain(ctx: ParseContext) -> str:
    """Advice on ``a < b < c``: compare two at a time."""
    last = next((at for at in range(ctx.at - 1, -1, -1) if ctx.text_at(at) in RELATIONS), None)
    if last is None:
        return ""

    def part(first: int, behind: int) -> str:
        return ctx.source.text[ctx.tokens[first].start : ctx.tokens[behind - 1].end]

    left, right = _back(ctx, last), _forward(ctx, ctx.at + 1)
    if left == last or last + 1 >= ctx.at or right == ctx.at + 1:
        return "compare two at a time: `a < b and b < c`"
    middle = part(last + 1, ctx.at)
    first, second = part(left, ctx.at), part(ctx.at, right)
    whole = f"{first} and {middle} {second}"
    return "compare two at a time: " + (
        f"write `{whole}`" if len(whole) <= 60 and "\n" not in whole else "`a < b and b < c`"
    )


def _belongs_to_side(ctx: ParseContext, at: int) -> bool:
    token = ctx.token(at)
    if token is None:
        return False
    if token.kind == "word":
        return token.text not in keywords.RESERVED
    return token.kind == "number" or token.text in ("+", "-", "*", "/", ".", ",", "(", ")", "^")


def _back(ctx: ParseContext, at: int) -> int:
    depth = 0
    while _belongs_to_side(ctx, at - 1):
        depth += (ctx.text_at(at - 1) == ")") - (ctx.text_at(at - 1) == "(")
        if depth < 0:
            break
        at -= 1
    return at


def _forward(ctx: ParseContext, at: int) -> int:
    depth = 0
    while _belongs_to_side(ctx, at):
        depth += (ctx.text_at(at) == "(") - (ctx.text_at(at) == ")")
        if depth < 0:
            break
        at += 1
    return at
